"""How well many parameters explain a motion whose gain and zero are free.

Many sets of parameters run side by side over the samples, so that none has to wait for the end of
its own arithmetic, by one step of the two-stage Radau rule for each sampling interval with the
coefficients held at its middle: stable for any stiffness, of second order, and a quarter of the
work of the rule that fits use. It ranks starts, for which 1e-2 of the motion is enough.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels import exponential as exponentials
from softid.kernels.cache_invalidation import follow_sources
from softid.kernels.decorators import kernel
from softid.kernels.exponential import NO_REORDERING, exponential

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

LANES = 32
"""Sets of parameters side by side: four of the widest vectors, so that one is worked on while
another waits for its result."""

MASS, A1, B1, C1, A2, B2, C2 = (k * LANES for k in range(7))
"""Where the parameters of the lanes stand in the workspace."""

X, V, BEGAN = 7 * LANES, 8 * LANES, 9 * LANES
"""Position, velocity and the position at the first sample."""

SUM, CROSS, POWER = 10 * LANES, 11 * LANES, 12 * LANES
"""Σ(x − x₀), Σ(x − x₀)·y and Σ(x − x₀)² over the used samples."""

DAMPING, FORCE = 13 * LANES, 14 * LANES
SIZE = 15 * LANES
"""Damping and force at the middle of a step, and the length of the workspace."""

LEAST_INERTIA = 1e-3
LEAST_PERIOD = 1e-3
"""A motion without inertia, or without damping too, follows within a thousandth of a step."""

_TINY = 1e-70
"""Inertia where damping and stiffness are zero as well: its square can still be divided by."""


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _begin(w: Array, thetas: Array, first: int, u: float) -> None:
    for k in range(7):
        for lane in range(LANES):
            w[k * LANES + lane] = thetas[min(first + lane, thetas.shape[0] - 1), k]
    for lane in range(LANES):
        force = exponential(w[B1 + lane] * u)
        w[X + lane] = w[BEGAN + lane] = force / (w[A1 + lane] * force + w[C1 + lane])
        w[V + lane] = w[SUM + lane] = w[CROSS + lane] = w[POWER + lane] = 0.0
        w[DAMPING + lane] = w[C2 + lane]


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _coefficients(w: Array, u: float, varying: bool) -> None:
    for lane in range(LANES):
        w[FORCE + lane] = exponential(w[B1 + lane] * u)
    if varying:
        for lane in range(LANES):
            w[DAMPING + lane] = w[A2 + lane] * exponential(w[B2 + lane] * u) + w[C2 + lane]


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _step(w: Array, h: float) -> None:
    """(1 − ⅔B + ⅙B²) y⁺ = (1 + ⅓B) y for y = (x − x∞, h·v) and B = [[0, 1], [−k/m, −d/m]].

    Both sides are multiplied by powers of m, and the one division is shared: divisions take longer
    than all the rest.
    """
    over = 1.0 / h
    for lane in range(LANES):
        stiffness = w[A1 + lane] * w[FORCE + lane] + w[C1 + lane]
        d, k = h * w[DAMPING + lane], h * h * stiffness
        least = max(LEAST_INERTIA * d, LEAST_PERIOD * LEAST_PERIOD * k)
        m = max(max(w[MASS + lane], least), _TINY)
        slow, four = m * (6.0 * m + 4.0 * d - k) + d * d, 4.0 * m + d
        quick = 6.0 * m - k
        whole = quick * slow + k * four * four
        inverse = 1.0 / (whole * stiffness)
        rest = w[FORCE + lane] * whole * inverse
        scale = 2.0 * m * stiffness * inverse
        away, speed = w[X + lane] - rest, h * w[V + lane]
        r1 = 3.0 * away + speed
        r2 = 3.0 * m * speed - k * away - d * speed
        w[X + lane] = rest + scale * (slow * r1 + four * r2)
        w[V + lane] = scale * over * (quick * r2 - k * four * r1)


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _add(w: Array, y: float) -> None:
    for lane in range(LANES):
        x = w[X + lane] - w[BEGAN + lane]
        w[SUM + lane] += x
        w[CROSS + lane] += x * y
        w[POWER + lane] += x * x


@njit(nogil=True, error_model="numpy")
def _moments(y: Array, used: BoolArray) -> tuple[int, float, float]:
    """Number of used samples, their mean and their squares about it."""
    n, mean, power = 0, 0.0, 0.0
    for i in range(y.size):
        if used[i]:
            n += 1
            mean += y[i]
    mean /= max(n, 1)
    for i in range(y.size):
        if used[i]:
            power += (y[i] - mean) ** 2
    return n, mean, power


@kernel
def add_products(
    thetas: Array, time_s: Array, u: Array, y: Array, used: BoolArray, sums: Array
) -> None:
    """Products of simulated and measured motion about their means, for muscles that start at rest.

    Parameters
    ----------
    thetas
        m, a1, b1, c1, a2, b2, c2, one row each, shape (G, 7).
    time_s, u
        Sample times and input, each of shape (n,).
    y, used
        Measured motion and whether it counts, each of shape (n,).
    sums
        Σxy, Σxx and Σyy are added, shape (G, 3); where a motion is not finite nothing is.
    """
    n, y_mean, y_power = _moments(y, used)
    w = np.empty(SIZE)
    for first in range(0, thetas.shape[0] if n else 0, LANES):
        _begin(w, thetas, first, u[0])
        varying = False
        for lane in range(LANES):
            varying = varying or w[A2 + lane] != 0.0
        if used[0]:
            _add(w, y[0] - y_mean)
        for i in range(1, u.size):
            _coefficients(w, 0.5 * (u[i - 1] + u[i]), varying)
            _step(w, time_s[i] - time_s[i - 1])
            if used[i]:
                _add(w, y[i] - y_mean)
        for lane in range(min(LANES, thetas.shape[0] - first)):
            power = w[POWER + lane] - w[SUM + lane] * w[SUM + lane] / n
            if np.isfinite(power):
                sums[first + lane, 0] += w[CROSS + lane]
                sums[first + lane, 1] += max(power, 0.0)
                sums[first + lane, 2] += y_power


follow_sources(add_products, (exponentials,))
