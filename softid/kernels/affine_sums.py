"""Normal equations of a law that is affine in its state, summed along its motion in one pass.

See `softid.kernels.affine_blocks` for the law and for how a block of steps is laid out.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels import affine_products, affine_simulation
from softid.kernels.affine_blocks import (
    BY,
    LANES,
    N_COLUMNS,
    N_PADDED,
    N_PARAMETERS,
    N_STATES,
    ONE,
    POINTS,
    RESIDUAL,
    SIZE,
)
from softid.kernels.affine_products import add_gram, select_ends
from softid.kernels.affine_simulation import differentiate, load, run
from softid.kernels.cache_invalidation import follow_sources
from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]
Counts = npt.NDArray[np.int16]
Ends = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]


@njit(nogil=True, error_model="numpy")
def _add(w: Array, ends: Ends, stretch: int, apart: int, columns: Array) -> None:
    """Add to the means over the stretches in which the samples lie; ``ends`` is used up."""
    share = 1.0 / stretch
    if stretch > 1:
        for i in range(LANES, POINTS):
            if ends[i] >= 0:
                k = int((ends[i] + 0.5) * share)  # quicker than a division, and never between
                ends[i] = k if k != apart else columns.shape[1] - 1
    for p in range(N_COLUMNS):
        for lane in range(LANES):
            for i in range(LANES + lane, POINTS, LANES):
                if ends[i] >= 0:
                    columns[p, ends[i]] += share * w[BY + p * POINTS + i]


@njit(nogil=True, error_model="numpy")
def _begin(
    left: float, tangent: Array, stretch: int, kept: Array, residual: Array, first: Array
) -> None:
    """The columns at the first sample, at which no step ends, and what is kept of them."""
    for p in range(N_PARAMETERS + N_STATES):
        first[p] = tangent[0, p]
    first[N_COLUMNS - 2], first[N_COLUMNS - 1] = 1.0, left
    if residual.size:
        residual[0] = left
    if kept.shape[1]:
        for a in range(N_COLUMNS):
            kept[a, 0] += first[a] / stretch


@njit(nogil=True, error_model="numpy")
def _enter(counts: Counts, at: Ends) -> None:
    """Move on to the interval in which a step lies that is counted from an earlier one."""
    interval, within = at[0], at[1]
    while interval < counts.size and within >= counts[interval]:
        within -= counts[interval]
        interval += 1
    at[0], at[1] = interval, within


@njit(nogil=True, error_model="numpy")
def _take_outputs(w: Array, ends: Ends, y: Array, used: BoolArray) -> None:
    """Which steps end on a sample that counts, and what was measured there."""
    for i in range(LANES, POINTS):
        k = ends[i]
        counted = k >= 0 and used[k]
        w[ONE + i] = 1.0 if counted else 0.0
        w[RESIDUAL + i] = y[k] if counted else 0.0


@kernel
def sum_products(
    law: int,
    rule: int,
    theta: Array,
    time_s: Array,
    u: Array,
    counts: Counts,
    y: Array,
    used: BoolArray,
    gain: float,
    level: float,
    at: Ends,
    blocks: int,
    state: Array,
    tangent: Array,
    stretch: int,
    kept: Array,
    apart: int,
    residual: Array,
    gram: Array,
) -> None:
    """All products of two columns summed over the used samples, without keeping the columns.

    Parameters
    ----------
    law, rule, theta, time_s, u, counts
        As in `move_with_derivatives`.
    y, used
        Measured output and whether it counts, each of shape (n,).
    gain, level
        The simulated output is gain·x + level.
    at
        Interval and step, counted from its beginning, that the run begins with; receives the
        interval and the step within it that it would go on with, shape (2,).
    blocks
        Blocks of steps that are run through at most.
    state, tangent
        Those at the first step, as in `move_with_derivatives`; receive those behind the last.
    stretch
        Number of samples that the columns which are kept are means of.
    kept
        Means of ∂x by the parameters and the initial state, 1 and the residual over stretches of
        samples, which are added to, shape (11, ⌈n/stretch⌉) or more; (11, 0) to keep nothing. All
        are zero at a sample that does not count, and where the last stretch goes on.
    apart
        The stretch of which another run sums a part at the same time, so that it is added to the
        last column; −1 for none.
    residual
        Receives the residual at every sample, zero where it does not count, shape (n,); (0,) to
        keep nothing.
    gram
        Receives Σ cᵢcⱼ for all these columns in its first 11 rows, shape (12, 12).
    """
    w = np.zeros(SIZE)
    ends = np.empty(POINTS, np.int64)
    now, now_by = state.copy(), tangent.copy()  # which nothing else can overlap
    first = np.zeros(N_PADDED)
    if used[0] and at[0] == 0 and at[1] == 0:
        _begin(y[0] - level - gain * state[0], tangent, stretch, kept, residual, first)
    for a in range(N_PADDED):
        for b in range(N_PADDED):
            gram[a, b] = first[a] * first[b]
    _enter(counts, at)
    while blocks > 0 and at[0] < time_s.size - 1:
        blocks -= 1
        load(w, ends, time_s, u, counts, at)
        run(w, law, rule, theta, now)
        differentiate(w, rule, theta, now_by)
        _take_outputs(w, ends, y, used)
        select_ends(w, gain, level)
        add_gram(w, gram)
        for i in range(LANES, POINTS if residual.size else 0):
            if ends[i] >= 0:
                residual[ends[i]] = w[RESIDUAL + i]
        if kept.shape[1]:
            _add(w, ends, stretch, apart, kept)
    for k in range(N_STATES):
        state[k] = now[k]
        for p in range(N_PARAMETERS + N_STATES):
            tangent[k, p] = now_by[k, p]
    for a in range(N_COLUMNS):
        for b in range(a):
            gram[b, a] = gram[a, b]


SOURCES = (*affine_simulation.SOURCES, affine_simulation, affine_products)
"""All that the kernels are compiled from, beside this file."""

follow_sources(sum_products, SOURCES)
