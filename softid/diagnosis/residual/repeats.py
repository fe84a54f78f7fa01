"""Blocks of time in which the motion brings the same: pieces of a rest, or whole cycles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np
import numpy.typing as npt

from softid.diagnosis.residual.noise_floor import (
    DEAD_AFTER,
    LOOK_S,
    STILL_SPAN,
    input_span,
    rest_spans,
)
from softid.diagnosis.residual.structure import ResidualContext
from softid.excitation.motion import turning_points

Array = npt.NDArray[np.float64]

LEAST_REST_S = 30.0
"""Shortest time, the dying out of the motion included, for which the input rests."""

LEAST_SWING = 0.25
"""An input turns where it comes back by this share of its range."""

REPEAT_TOLERANCE = 2.0 * STILL_SPAN
"""One cycle repeats another while the input differs by no more than this share of its range."""

MOST_TURNS = 6
"""A cycle may rise so many times before it repeats."""

FEWEST_CYCLES = 5
"""Equal cycles that show a slow noise: with fewer, a trend over them is as good as any."""

MOST_BLOCKS = 150
"""Blocks of a run are so wide that there are no more: that is enough to see what is slow."""


@dataclass(frozen=True, eq=False)
class Run:
    """A stretch of one segment, cut into blocks in each of which the motion brings the same.

    Attributes
    ----------
    part
        Position of the segment in the list that was given.
    edges_s
        Ends of the blocks, shape (blocks + 1,).
    """

    part: int
    edges_s: Array


def resting_runs(
    parts: Sequence[ResidualContext], motion_s: float, block_s: float
) -> tuple[Run, ...]:
    """Rests after which the motion has died out, in equal blocks.

    Parameters
    ----------
    parts
        Residuals with their input.
    motion_s
        Time constant of the motion.
    block_s
        Shortest block.
    """
    found, u_span = [], input_span(parts)
    for k, part in enumerate(parts):
        for span in rest_spans(part, motion_s, u_span):
            times = part.time_s[span]
            length_s = float(times[-1] - times[0])
            died_out_s = DEAD_AFTER * motion_s if span.start > 0 else 0.0
            if length_s + died_out_s >= LEAST_REST_S and length_s >= block_s:
                count = min(int(length_s / block_s), MOST_BLOCKS)
                found.append(Run(k, np.linspace(times[0], times[-1], count + 1)))
    return tuple(found)


def cycling_runs(
    parts: Sequence[ResidualContext], motion_s: float, block_s: float
) -> tuple[Run, ...]:
    """Stretches in which the input repeats its cycles, in blocks of whole cycles.

    The first cycles, in which the motion still remembers what was before, are left out.

    Parameters
    ----------
    parts, motion_s, block_s
        As in `resting_runs`.
    """
    found = []
    for k, part in enumerate(parts):
        for starts_s in _repeated(part):
            cycle_s = float(np.median(np.diff(starts_s)))
            settled = starts_s[max(ceil(DEAD_AFTER * motion_s / cycle_s), 1) :]
            wide = max(ceil(block_s / cycle_s), ceil(settled.size / MOST_BLOCKS))
            edges_s = settled[::wide]
            if edges_s.size > 1:
                found.append(Run(k, edges_s))
    return tuple(found)


def _repeated(part: ResidualContext) -> list[Array]:
    """Times at which equal cycles begin, for each stretch of them; the last one ends it."""
    rises_s = _rises(part)
    found, first = [], 0
    while first + 1 < rises_s.size:
        for turns in range(1, MOST_TURNS + 1):
            starts_s = rises_s[first::turns]
            alike = _number_alike(part, starts_s) if starts_s.size > FEWEST_CYCLES else 0
            if alike >= FEWEST_CYCLES:
                found.append(starts_s[: alike + 1])
                first += turns * alike
                break
        else:
            first += 1
    return found


def _rises(part: ResidualContext) -> Array:
    """Times at which the input passes upward through the middle between two turns."""
    span = float(np.ptp(part.u))
    if span <= 0.0:
        return np.empty(0)
    turns = [0, *turning_points(part.u, LEAST_SWING * span).tolist(), part.u.size - 1]
    found = []
    for low, high in pairwise(turns):
        rise = part.u[low : high + 1]
        if rise[-1] - rise[0] > LEAST_SWING * span:
            after = int(np.argmax(rise > 0.5 * (rise[0] + rise[-1])))
            beside = slice(low + after - 1, low + after + 1)
            middle = 0.5 * (rise[0] + rise[-1])
            found.append(float(np.interp(middle, part.u[beside], part.time_s[beside])))
    return np.array(found)


def _number_alike(part: ResidualContext, starts_s: Array) -> int:
    """How many cycles in a row are like the first, at the same phase and in length."""
    tolerance = REPEAT_TOLERANCE * float(np.ptp(part.u))
    begin_s, end_s = starts_s[:2]
    inside = slice(*np.searchsorted(part.time_s, (begin_s, end_s)))
    since_s, first = part.time_s[inside] - begin_s, part.u[inside]
    looks = np.searchsorted(since_s, np.arange(LOOK_S, end_s - begin_s, LOOK_S))
    for k, (start_s, stop_s) in enumerate(pairwise(starts_s[1:].tolist()), start=1):
        stretch = (stop_s - start_s) / (end_s - begin_s)
        if since_s.size < 2 or abs(stretch - 1.0) > REPEAT_TOLERANCE:
            return k
        apart = np.abs(np.interp(start_s + stretch * since_s, part.time_s, part.u) - first)
        if any(piece.size and np.median(piece) > tolerance for piece in np.split(apart, looks)):
            return k
    return int(starts_s.size) - 1
