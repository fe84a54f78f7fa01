"""Blocks of steps filled from a log, run and differentiated: what all affine kernels share."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inner
from softid.kernels.lanes import (
    BY,
    INPUT,
    LANES,
    N_COLUMNS,
    N_PADDED,
    N_PARAMETERS,
    N_STATES,
    ONE,
    POINTS,
    RESIDUAL,
    RK4,
    ROWS,
    STEP,
    STEPS,
    X,
    add_gram,
    differentiate_radau,
    differentiate_rk4,
    fill_coefficients,
    join_derivatives,
    join_states,
    reset,
    run_radau,
    run_rk4,
    select_ends,
)

Array = npt.NDArray[np.float64]
Counts = npt.NDArray[np.int16]
Ends = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]


@inner
def load_steps(w: Array, ends: Ends, time_s: Array, u: Array, counts: Counts, at: Ends) -> None:
    """The next steps of a log.

    ``at`` is the interval and the step within it, which move on, and the last sample; ``ends``
    receives the sample that every step ends on, −1 for none. Behind the last sample the
    input stays and no step ends on a sample.
    """
    interval, within, last = at[0], at[1], at[2]
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


@inner
def run_steps(w: Array, law: int, rule: int, theta: Array, state: Array) -> None:
    """Positions and velocities over the block; ``state`` goes on to its end."""
    fill_coefficients(w, law, rule, theta)
    reset(w)
    if rule == RK4:
        run_rk4(w, theta)
    else:
        run_radau(w, theta)
    join_states(w, state)


@inner
def differentiate_steps(w: Array, rule: int, theta: Array, tangent: Array) -> None:
    """Derivatives over the block, behind `run_steps`; ``tangent`` goes on to its end."""
    if rule == RK4:
        differentiate_rk4(w, theta)
    else:
        differentiate_radau(w, theta)
    join_derivatives(w, tangent)


@inner
def store_ends(w: Array, ends: Ends, columns: Array, row: int, count: int) -> None:
    """Columns at the samples, into so many rows from ``row`` on."""
    for p in range(count):
        for i in range(LANES, POINTS):
            if ends[i] >= 0:
                columns[row + p, ends[i]] = w[BY + p * POINTS + i]


@inner
def run_positions(
    law: int, rule: int, theta: Array, time_s: Array, u: Array, counts: Counts, state: Array,
    w: Array, ends: Ends, at: Ends, x: Array,
) -> None:  # fmt: skip
    """Positions at the samples that ``at`` tells; ``state`` goes on to the end."""
    w[:] = 0.0
    x[at[0]] = state[0]
    while at[0] < at[2]:
        load_steps(w, ends, time_s, u, counts, at)
        run_steps(w, law, rule, theta, state)
        for i in range(LANES, POINTS):
            if ends[i] >= 0:
                x[ends[i]] = w[X + i]


@inner
def sum_columns(
    law: int, rule: int, theta: Array, time_s: Array, u: Array, counts: Counts, y: Array,
    used: BoolArray, shift: int, gain: float, level: float, state: Array, tangent: Array, w: Array,
    ends: Ends, at: Ends, kept: Array, row: int, grams: Array, place: int,
) -> None:  # fmt: skip
    """`softid.kernels.affine.sum_products` for the samples that ``at`` tells.

    ``shift`` leads from a sample to its measurement; ``w`` and ``ends`` are the block; ``state``
    and ``tangent`` go on to the end; ``kept`` receives the columns in 11 rows from ``row`` on and
    ``grams`` the products in 12 rows from ``place`` on.
    """
    w[:] = 0.0
    _sum_first(w, at[0], y, used, shift, gain, level, state, tangent, kept, row, grams, place)
    while at[0] < at[2]:
        load_steps(w, ends, time_s, u, counts, at)
        run_steps(w, law, rule, theta, state)
        differentiate_steps(w, rule, theta, tangent)
        for i in range(LANES, POINTS):
            k = ends[i] + shift
            counted = ends[i] >= 0 and used[k]
            w[ONE + i] = 1.0 if counted else 0.0
            w[RESIDUAL + i] = y[k] if counted else 0.0
        select_ends(w, gain, level)
        add_gram(w, grams, place)
        if kept.shape[1]:
            store_ends(w, ends, kept, row, np.int64(N_COLUMNS))
    for a in range(N_COLUMNS):
        for b in range(a):
            grams[place + b, a] = grams[place + a, b]


@inner
def _sum_first(
    first: Array, sample: int, y: Array, used: BoolArray, shift: int, gain: float, level: float,
    state: Array, tangent: Array, kept: Array, row: int, grams: Array, place: int,
) -> None:  # fmt: skip
    """The first sample, which no step ends on; ``first`` is a block that may be overwritten."""
    for p in range(N_PADDED):
        first[p] = 0.0
    if used[shift + sample]:
        for p in range(N_PARAMETERS + N_STATES):
            first[p] = tangent[0, p]
        first[N_COLUMNS - 2] = 1.0
        first[N_COLUMNS - 1] = y[shift + sample] - level - gain * state[0]
    for a in range(N_PADDED):
        for b in range(N_PADDED):
            grams[place + a, b] = first[a] * first[b]
    if kept.shape[1]:
        for a in range(N_COLUMNS):
            kept[row + a, sample] = first[a]
