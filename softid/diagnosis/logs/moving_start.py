"""Samples that depend on what the input did before the log began.

Every effect that remembers takes the input before the first sample as constant, and itself as
settled. Where a log begins in mid-motion, or just after it, that is wrong: what a delayed or a
lagged input does at first follows from samples that nobody recorded, and a cause that is true is
refuted by them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.errors import Issue
from softid.excitation.motion import turning_points
from softid.excitation.noise import noise_std
from softid.fitters.rest import REST_FRACTION, spans_of
from softid.log import Log
from softid.segment import Segment

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
Places = npt.NDArray[np.intp]

LONGEST_S, LONGEST_SHARE = 1.0, 0.1
"""A delay is no longer than this, and than this share of a log."""

AT_ENDS = 5
"""Samples that are averaged for where an output is."""

PARTS = 5
"""Parts of the beginning whose means tell whether the input moves."""

LEAST_MOVE = 5.0
"""Standard errors by which an output has moved at least, to count as moving when the log begins."""

DIES_AWAY = 2.0
"""In the first half of the beginning a motion that dies away goes so many times as far as in the
second."""

MOST_TRAVEL = 0.2
"""Where the input travels more than this share of its way in a beginning, that is kept: a log of
few steps would lose one of them."""


def without_moving_start(log: Log, motion_s: float, *, states: int) -> Log:
    """Leave out, and say so, the beginning of every stretch that does not begin at rest.

    That is as long as the longest delay that is looked for, or as the actuator's own motion, but no
    more than a tenth of the stretch; and a rest is as long as that, or what was before it still
    acts, as it does where the input stays and the output moves. As many samples as there are
    initial states stay at the very start: they determine these states, which could be anything
    else, and nothing besides.

    Parameters
    ----------
    log
        A log.
    motion_s
        Time that the actuator's motion takes [s].
    states
        Number of initial states of the model.
    """
    unknown, first_s = np.zeros(len(log), bool), []
    spans = spans_of(log)
    least = REST_FRACTION * spans["input"]
    for segment in log.segments():
        begins = _beginning(segment, max(LONGEST_S, motion_s))
        moves = _range_of_means(segment.input[begins]) > least
        moves = moves or _dies_away(segment, begins, spans)
        if moves and _is_small_part(segment, begins, least):
            left_out = segment.samples_of(begins)
            left_out[_first_seen(segment, states)] = False
            unknown[segment.start : segment.stop] = left_out
            first_s.append(float(segment.time_s[0]))
    if not first_s:
        return log
    others = f" and of {len(first_s) - 1} more stretches" if len(first_s) > 1 else ""
    issue = Issue(
        "moving-start",
        "info",
        f"{log.name}: at the beginning, {first_s[0]:.4g} s{others}, there is no rest of "
        f"{max(LONGEST_S, motion_s):.2g} s; what {log.input} did before is not known, and "
        f"{unknown.sum()} samples that may depend on it are left out of the residuals",
        "begin to record a few seconds before the motion",
    )
    return replace(log.with_masked(unknown), issues=(*log.issues, issue))


def _beginning(segment: Segment, longest_s: float) -> BoolArray:
    """Which rows lie in the first of a stretch."""
    since_s = segment.time_s - segment.time_s[0]
    found: BoolArray = since_s <= min(longest_s, LONGEST_SHARE * float(since_s[-1]))
    return found


def _range_of_means(u: Array) -> float:
    """Between the means of a few equal parts: what is left of noise in them is no motion."""
    return float(np.ptp([part.mean() for part in np.array_split(u, min(PARTS, u.size))]))


def _dies_away(segment: Segment, begins: BoolArray, spans: Mapping[str, float]) -> bool:
    """Whether an output moves in the first half of the beginning, and less in the second.

    A drift goes on as it began.
    """
    for name, values in segment.outputs.items():
        counts = begins & segment.used[name]
        seen = values[counts]
        if seen.size < 2 * AT_ENDS:
            continue
        middle = (seen.size - AT_ENDS) // 2
        first, second, last = (
            float(seen[k : k + AT_ENDS].mean()) for k in (0, middle, seen.size - AT_ENDS)
        )
        sigma = noise_std(segment.time_s[counts], seen) or 0.0
        least = max(REST_FRACTION * spans[name], LEAST_MOVE * sigma * (2.0 / AT_ENDS) ** 0.5)
        if abs(second - first) > max(least, DIES_AWAY * abs(last - second)):
            return True
    return False


def _is_small_part(segment: Segment, begins: BoolArray, least: float) -> bool:
    """Whether the input travels little in the beginning, beside a way that is more than noise."""
    whole = _travel(segment.input, least)
    return least < whole and _travel(segment.input[begins], least) <= MOST_TRAVEL * whole


def _travel(u: Array, least: float) -> float:
    """Way from each turning point to the next, where turns of less are none."""
    at = np.unique(np.concatenate(([0], turning_points(u, least), [u.size - 1])))
    return float(np.abs(np.diff(u[at])).sum())


def _first_seen(segment: Segment, count: int) -> Places:
    """The first samples of a stretch that have an output."""
    seen = np.any([segment.samples_of(used) for used in segment.used.values()], axis=0)
    found: Places = np.flatnonzero(seen)[:count]
    return found
