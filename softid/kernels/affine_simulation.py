"""Motion and derivatives of a law that is affine in its state, in one pass.

See `softid.kernels.affine_blocks` for the law and for how a block of steps is laid out.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels import (
    affine_blocks,
    affine_coefficients,
    affine_derivatives,
    affine_motion,
    affine_steps,
    exponential,
)
from softid.kernels.affine_blocks import (
    BY,
    GIVEN,
    INPUT,
    LANES,
    POINTS,
    RK4,
    ROWS,
    SIZE,
    STEP,
    STEPS,
    V,
    X,
)
from softid.kernels.affine_coefficients import fill_coefficients, fill_from_stages
from softid.kernels.affine_derivatives import (
    differentiate_radau,
    differentiate_rk4,
    join_derivatives,
)
from softid.kernels.affine_motion import join_states, reset, run_radau, run_rk4
from softid.kernels.cache_invalidation import follow_sources
from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]
Counts = npt.NDArray[np.int16]
Ends = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]


@njit(nogil=True, error_model="numpy")
def load(w: Array, ends: Ends, time_s: Array, u: Array, counts: Counts, at: Ends) -> None:
    """The next steps of a log; ``at`` is the interval and the step within it, and moves on.

    ``ends`` receives the sample that every step ends on, −1 for none. Behind the last sample the
    input stays and no step ends on a sample.
    """
    interval, within = at[0], at[1]
    last = time_s.size - 1
    h = 1.0
    p = u[last]
    for lane in range(LANES):
        for j in range(ROWS):
            i = j * LANES + lane
            ends[i + LANES] = -1
            if interval < last:
                count = counts[interval]
                h = time_s[interval + 1] - time_s[interval]
                p = u[interval]
                if count > 1:
                    p += (u[interval + 1] - p) * (within / count)
                    h /= count
                within += 1
                if within == count:
                    within = 0
                    interval += 1
                    ends[i + LANES] = interval
            else:
                p = u[last]
            w[STEP + i] = h
            w[INPUT + i] = p
    for lane in range(LANES - 1):
        w[INPUT + STEPS + lane] = w[INPUT + lane + 1]
    p = u[interval]
    if within:
        p += (u[interval + 1] - p) * (within / counts[interval])
    w[INPUT + POINTS - 1] = p
    at[0], at[1] = interval, within


@njit(nogil=True, error_model="numpy")
def run(w: Array, law: int, rule: int, theta: Array, state: Array) -> None:
    """States along a block of steps; ``state`` goes on to the block's end."""
    fill_coefficients(w, law, rule, theta)
    reset(w)
    if rule == RK4:
        run_rk4(w, theta)
    else:
        run_radau(w, theta)
    join_states(w, state)


@njit(nogil=True, error_model="numpy")
def differentiate(w: Array, rule: int, theta: Array, tangent: Array) -> None:
    """Derivatives along a block of steps; ``tangent`` goes on to the block's end."""
    if rule == RK4:
        differentiate_rk4(w, theta)
    else:
        differentiate_radau(w, theta)
    join_derivatives(w, tangent)


@njit(nogil=True, error_model="numpy")
def _store(w: Array, ends: Ends, columns: Array) -> None:
    for p in range(columns.shape[0]):
        for i in range(LANES, POINTS):
            if ends[i] >= 0:
                columns[p, ends[i]] = w[BY + p * POINTS + i]


@kernel
def move(
    law: int,
    rule: int,
    theta: Array,
    time_s: Array,
    u: Array,
    counts: Counts,
    state: Array,
    x: Array,
    v: Array,
) -> None:
    """Motion at the samples.

    Parameters
    ----------
    law, rule
        MUSCLE or OSCILLATOR; RK4 or RADAU.
    theta
        m, a1, b1, c1, a2, b2, c2 and the oscillator's gain, shape (8,).
    time_s, u
        Sample times and input, each of shape (n,).
    counts
        Steps per sampling interval, shape (n − 1,).
    state
        (x, v) at the first sample, shape (2,).
    x, v
        Receive position and velocity, each of shape (n,).
    """
    w = np.zeros(SIZE)
    ends = np.empty(POINTS, np.int64)
    at = np.zeros(2, np.int64)
    now = state.copy()
    x[0], v[0] = state[0], state[1]
    while at[0] < time_s.size - 1:
        load(w, ends, time_s, u, counts, at)
        run(w, law, rule, theta, now)
        for i in range(LANES, POINTS):
            if ends[i] >= 0:
                x[ends[i]] = w[X + i]
                v[ends[i]] = w[V + i]


@kernel
def move_with_derivatives(
    law: int,
    rule: int,
    theta: Array,
    time_s: Array,
    u: Array,
    counts: Counts,
    state: Array,
    tangent: Array,
    x: Array,
    v: Array,
    by: Array,
) -> None:
    """Motion and its derivatives at the samples.

    Parameters
    ----------
    law, rule, theta, time_s, u, counts, state, x, v
        As in `move`.
    tangent
        ∂(x, v)/∂(m, a1, b1, c1, a2, b2, c2, x₀, v₀) at the first sample, shape (2, 9).
    by
        Receives ∂x by the same, shape (9, n).
    """
    w = np.zeros(SIZE)
    ends = np.empty(POINTS, np.int64)
    at = np.zeros(2, np.int64)
    now, now_by = state.copy(), tangent.copy()
    x[0], v[0] = state[0], state[1]
    for p in range(by.shape[0]):
        by[p, 0] = tangent[0, p]
    while at[0] < time_s.size - 1:
        load(w, ends, time_s, u, counts, at)
        run(w, law, rule, theta, now)
        differentiate(w, rule, theta, now_by)
        for i in range(LANES, POINTS):
            if ends[i] >= 0:
                x[ends[i]] = w[X + i]
                v[ends[i]] = w[V + i]
        _store(w, ends, by)


@njit(nogil=True, error_model="numpy")
def _load_stages(
    w: Array, ends: Ends, time_s: Array, stage_u: Array, counts: Counts, at: Ends
) -> None:
    """`load` for an input that is known at the stages of every step; ``at`` counts the steps too.

    Behind the last sample the last step is repeated.
    """
    interval, within, step = at[0], at[1], at[2]
    last = time_s.size - 1
    h = 1.0
    for lane in range(LANES):
        for j in range(ROWS):
            i = j * LANES + lane
            ends[i + LANES] = -1
            if interval < last:
                h = (time_s[interval + 1] - time_s[interval]) / counts[interval]
                step += 1
                within += 1
                if within == counts[interval]:
                    within = 0
                    interval += 1
                    ends[i + LANES] = interval
            w[STEP + i] = h
            for c in range(3):
                w[GIVEN[c] + i] = stage_u[step - 1, c]
    at[0], at[1], at[2] = interval, within, step


@kernel
def move_through(
    law: int,
    theta: Array,
    time_s: Array,
    stage_u: Array,
    counts: Counts,
    state: Array,
    tangent: Array,
    x: Array,
    v: Array,
    by: Array,
) -> None:
    """Motion under an input that is given at the stages of the Radau rule, and its derivatives.

    Parameters
    ----------
    law, theta, time_s, counts, state, tangent, x, v
        As in `move_with_derivatives`.
    stage_u
        Input at the stages of every step, shape (L, 3).
    by
        As there; of shape (9, 0) when no derivatives are wanted.
    """
    w = np.zeros(SIZE)
    ends = np.empty(POINTS, np.int64)
    at = np.zeros(3, np.int64)
    now, now_by = state.copy(), tangent.copy()
    x[0], v[0] = state[0], state[1]
    if by.shape[1]:
        for p in range(by.shape[0]):
            by[p, 0] = tangent[0, p]
    while at[0] < time_s.size - 1:
        _load_stages(w, ends, time_s, stage_u, counts, at)
        fill_from_stages(w, law, theta)
        reset(w)
        run_radau(w, theta)
        join_states(w, now)
        for i in range(LANES, POINTS):
            if ends[i] >= 0:
                x[ends[i]] = w[X + i]
                v[ends[i]] = w[V + i]
        if by.shape[1]:
            differentiate_radau(w, theta)
            join_derivatives(w, now_by)
            _store(w, ends, by)


SOURCES = (
    affine_blocks,
    affine_coefficients,
    affine_derivatives,
    affine_motion,
    affine_steps,
    exponential,
)
"""All that the kernels are compiled from, beside this file."""

for _kernel in (move, move_with_derivatives, move_through):
    follow_sources(_kernel, SOURCES)
