"""What the law of a block of steps takes from the input: E₁, E₂ and their slopes at all places.

See `softid.kernels.affine_blocks` for the law, the block and its workspace ``w``.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.affine_blocks import (
    D1,
    D2,
    E1,
    E2,
    INNER,
    INPUT,
    LANES,
    OSCILLATOR,
    OUTER,
    POINTS,
    RK4,
    START,
    STEPS,
)
from softid.kernels.affine_steps import FIRST_STAGE, SECOND_STAGE, Places, inlined
from softid.kernels.exponential import NO_REORDERING, exponential

Array = npt.NDArray[np.float64]


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def fill_coefficients(w: Array, law: int, rule: int, theta: Array) -> None:
    """E₁, E₂ and their slopes at all places of a block's steps."""
    if law == OSCILLATOR:
        _fill_oscillator(w, rule, theta)
        return
    b1, b2 = theta[2], theta[5]
    _fill_starts(w, b1, b2)
    if rule == RK4:
        _fill_middles(w, b1, b2)
    else:
        _fill_stages(w, b1, b2)


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _fill_starts(w: Array, b1: float, b2: float) -> None:
    for i in range(POINTS):
        u = w[INPUT + i]
        e1, e2 = exponential(b1 * u), exponential(b2 * u)
        w[START + E1 + i], w[START + D1 + i] = e1, u * e1
        w[START + E2 + i], w[START + D2 + i] = e2, u * e2


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _fill_middles(w: Array, b1: float, b2: float) -> None:
    for i in range(STEPS):
        u = 0.5 * (w[INPUT + i] + w[INPUT + i + LANES])
        e1, e2 = exponential(b1 * u), exponential(b2 * u)
        w[INNER + E1 + i], w[INNER + D1 + i] = e1, u * e1
        w[INNER + E2 + i], w[INNER + D2 + i] = e2, u * e2


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _fill_stages(w: Array, b1: float, b2: float) -> None:
    for i in range(STEPS):
        u = w[INPUT + i] + FIRST_STAGE * (w[INPUT + i + LANES] - w[INPUT + i])
        e1, e2 = exponential(b1 * u), exponential(b2 * u)
        w[INNER + E1 + i], w[INNER + D1 + i] = e1, u * e1
        w[INNER + E2 + i], w[INNER + D2 + i] = e2, u * e2
    for i in range(STEPS):
        u = w[INPUT + i] + SECOND_STAGE * (w[INPUT + i + LANES] - w[INPUT + i])
        e1, e2 = exponential(b1 * u), exponential(b2 * u)
        w[OUTER + E1 + i], w[OUTER + D1 + i] = e1, u * e1
        w[OUTER + E2 + i], w[OUTER + D2 + i] = e2, u * e2


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _fill_oscillator(w: Array, rule: int, theta: Array) -> None:
    offset, gain = theta[2], theta[7]
    inner = 0.5 if rule == RK4 else FIRST_STAGE
    for i in range(POINTS):
        w[START + E1 + i] = gain * (w[INPUT + i] - offset)
        w[START + D1 + i] = w[INNER + D1 + i] = w[OUTER + D1 + i] = -gain
        w[START + E2 + i] = w[INNER + E2 + i] = w[OUTER + E2 + i] = 0.0
        w[START + D2 + i] = w[INNER + D2 + i] = w[OUTER + D2 + i] = 0.0
    for i in range(STEPS):
        start = w[START + E1 + i]
        rise = w[START + E1 + i + LANES] - start
        w[INNER + E1 + i] = start + inner * rise
        w[OUTER + E1 + i] = start + SECOND_STAGE * rise


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def fill_from_stages(w: Array, law: int, theta: Array) -> None:
    """The same where the input is known at the stages alone, and stands at `GIVEN`."""
    b1, b2 = theta[2], theta[5]
    for at in (INNER, OUTER, START + LANES):
        if law == OSCILLATOR:
            for i in range(STEPS):
                w[at + E1 + i] = theta[7] * (w[at + D1 + i] - b1)
                w[at + D1 + i] = -theta[7]
                w[at + E2 + i], w[at + D2 + i] = 0.0, 0.0
        else:
            for i in range(STEPS):
                u = w[at + D1 + i]
                e1, e2 = exponential(b1 * u), exponential(b2 * u)
                w[at + E1 + i], w[at + D1 + i] = e1, u * e1
                w[at + E2 + i], w[at + D2 + i] = e2, u * e2


@inlined
def rk4_places(w, what, i):  # type: ignore[no-untyped-def]
    """E₁, E₂ or a slope at the start, the middle and the end of step ``i``."""
    return Places(w[START + what + i], w[INNER + what + i], w[START + what + i + LANES])


@inlined
def radau_places(w, what, i):  # type: ignore[no-untyped-def]
    """E₁, E₂ or a slope at the three stages of step ``i``."""
    return Places(w[INNER + what + i], w[OUTER + what + i], w[START + what + i + LANES])
