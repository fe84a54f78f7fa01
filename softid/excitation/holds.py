"""Where an input stands still: the settled windows of steps and staircases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.excitation.motion import MOST_UNEVEN, Motion, thirds_apart, wander

Array = npt.NDArray[np.float64]

UNSETTLED = 0.12
"""Unevenness beyond which a hold still settles or leaves its level, as one that is cut out of a
slow move does; that of noise about a level stays below 0.1."""

RAMPING = 0.5
"""Unevenness beyond which a hold that was joined from several is a slow ramp; it may be more uneven
than each of them, for it is wider."""

SHORTEST_HOLD = 0.3
"""Least length of a hold, as a share of the longer of the moves beside it."""

SHORTEST_HOLD_AT_TURN = 0.5
"""Least length of a hold where the input turns round, as a share of the longer of the moves beside
it: a sine is within a tube for 0.2 to 0.3 of its moves."""

SHORTEST_HOLD_AT_END = 0.15
"""Least length of a hold at an end of the log, which may have cut off half of it, as a share of the
move beside it."""

SHORTEST_UNEVEN_HOLD = 1.0
"""Least length of a hold that is still settling, as a share of the longer of the moves beside it:
one that takes less time than the move to it, and has not arrived, is a part of the move."""

LIKE_HOLD = 0.25
"""A move ends at the next hold of this share of the hold's length; a shorter one is part of it."""

PAUSE = 5.0
"""A hold between two that last so many times as long may be a pause of one slow change, unless
holds take up `MOST_PAUSED` of that."""

MOST_PAUSED = 0.65
"""Share of a change of level taken up by holds from which they are no pauses of it: those of a
staircase take up nearly all."""

LEVEL_SPREAD = 2.0
"""Tolerances about its median within which a hold's samples make its level; others are glitches."""

WANDER = 2.0
"""Distance of two levels, in the widths of either, up to which they are one that wanders."""

WIDEST_WANDER = 4.0
"""Distance of two levels, in tolerances, up to which they may be one that wanders, whatever their
widths: beyond, the input was moved."""

GREATEST_EXCURSION = 3.0
"""Tolerances beyond both levels that the input may go between two parts of one hold: more is a move
there and back."""


@dataclass(frozen=True)
class SettledWindow:
    """A range of samples on which the input stands still.

    Attributes
    ----------
    start, stop
        Half-open range of the samples.
    level
        Mean input over its second half, glitches left out, in the input's unit.
    """

    start: int
    stop: int
    level: float


def find_holds(motion: Motion, *, strict: bool = False) -> list[tuple[int, int]]:
    """Half-open ranges of ``motion.values`` on which the input stands still, in order.

    Strict ones hold their level from the first to the last sample, without a tail of settling.
    """
    if motion.still:
        return [(0, motion.values.size)]
    even = [s for s in motion.tubes if _unevenness(motion, s, strict=strict) <= MOST_UNEVEN]
    candidates = _merged(motion, even)
    long = [span for span in candidates if _long_enough(motion, candidates, span)]
    holds = _merged(motion, _without_pauses(motion, _merged(motion, long)))
    return [_trimmed(motion, s) for s in holds if _unevenness(motion, s, strict=False) <= RAMPING]


def windows_of(
    motion: Motion, spans: Sequence[tuple[int, int]], input_values: Array, *, tail: float = 1.0
) -> tuple[SettledWindow, ...]:
    """The holds as ranges of the original samples with their levels."""
    windows: list[SettledWindow] = []
    reached = 0
    for span in spans:
        begin, stop = bounds_of(motion, span, input_values.size)
        begin, reached = max(begin, reached), stop
        start = stop - max(round(tail * (stop - begin)), 1)
        held = input_values[(start + stop) // 2 : stop]
        usual = np.abs(held - np.median(held)) <= LEVEL_SPREAD * motion.tolerance
        level = held[usual].mean() if usual.any() else np.median(held)
        windows.append(SettledWindow(start, stop, float(level)))
    return tuple(windows)


def bounds_of(motion: Motion, span: tuple[int, int], size: int) -> tuple[int, int]:
    """Half-open range of the original samples of a hold, exact to the sample in a thinned log too.

    Between the last sample kept of a hold and the first one kept after it, a long log has others,
    and the change of level lies anywhere among them.
    """
    thinning, full = motion.thinning, motion.full
    begin, end = span[0] * thinning, min(span[1] * thinning, full.size)
    if thinning > 1:
        held = motion.values[slice(*span)]
        level, allowed = float(np.median(held)), max(motion.tolerance, wander(held))
        earliest, known = max(begin - thinning + 1, 0), (span[1] - 1) * thinning + 1
        before = np.flatnonzero(np.abs(full[earliest:begin] - level) > allowed)
        after = np.flatnonzero(np.abs(full[known:end] - level) > allowed)
        begin = earliest + int(before[-1]) + 1 if before.size else earliest
        end = known + int(after[0]) if after.size else end
    return int(motion.fresh[begin]), int(motion.fresh[end]) if end < full.size else size


def distinct_levels(levels: Sequence[float], tolerance: float) -> tuple[float, ...]:
    """Levels that differ by more than a tolerance, each the mean of those closer, rising.

    Examples
    --------
    >>> distinct_levels([10.0, 60.2, 10.2, 59.8], 1.0)
    (10.1, 60.0)
    """
    groups: list[list[float]] = []
    for level in sorted(levels):
        if groups and level - groups[-1][0] <= tolerance:
            groups[-1].append(level)
        else:
            groups.append([level])
    return tuple(float(np.mean(group)) for group in groups)


def _unevenness(motion: Motion, span: tuple[int, int], *, strict: bool) -> float:
    """Difference of neighbouring thirds of a range, in tube heights; the larger one if strict.

    It is 1/3 on a ramp and 0.44 on a sine's extreme, both ways. A hold has one small difference
    even where it still settles or already leaves its level.
    """
    differences = thirds_apart(motion.values[slice(*span)])
    return (max if strict else min)(differences) / (2.0 * motion.tolerance)


def _merged(motion: Motion, spans: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Join neighbouring holds at one level between which the input hardly moves."""
    joined: list[tuple[int, int]] = []
    for span in spans:
        if joined and _same_hold(motion, joined[-1], span):
            joined[-1] = (joined[-1][0], span[1])
        else:
            joined.append(span)
    return joined


def _without_pauses(motion: Motion, spans: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Holds without the brief pauses of a slow change from one long hold to the next."""
    times = motion.time_s
    held_s = [float(times[stop - 1] - times[start]) for start, stop in spans]
    kept = []
    for k, span in enumerate(spans):
        long = [j for j, held in enumerate(held_s) if held >= PAUSE * held_s[k] and j != k]
        left = max((j for j in long if j < k), default=None)
        right = min((j for j in long if j > k), default=None)
        if left is not None and right is not None:
            change_s = float(times[spans[right][0]] - times[spans[left][1] - 1])
            quick = change_s <= min(held_s[left], held_s[right])
            if quick and sum(held_s[left + 1 : right]) < MOST_PAUSED * change_s:
                continue
        kept.append(span)
    return kept


def _trimmed(motion: Motion, span: tuple[int, int]) -> tuple[int, int]:
    """A hold without the samples at its ends that are still off its level."""
    held = motion.values[slice(*span)]
    off = np.abs(held - np.median(held))
    close = np.flatnonzero(off <= max(motion.tolerance, wander(held)))
    return span[0] + int(close[0]), span[0] + int(close[-1]) + 1


def _same_hold(motion: Motion, before: tuple[int, int], after: tuple[int, int]) -> bool:
    """Whether two ranges are one hold whose level wanders as much within each as between them."""
    one, other = motion.values[slice(*before)], motion.values[slice(*after)]
    levels = float(np.median(one)), float(np.median(other))
    allowed = WANDER * max(wander(one), wander(other))
    allowed = min(max(motion.tolerance, allowed), WIDEST_WANDER * motion.tolerance)
    if abs(levels[0] - levels[1]) > allowed:
        return False
    between = motion.values[before[1] : after[0]]
    margin = GREATEST_EXCURSION * motion.tolerance
    return bool(np.all((between >= min(levels) - margin) & (between <= max(levels) + margin)))


def _long_enough(motion: Motion, spans: list[tuple[int, int]], span: tuple[int, int]) -> bool:
    """Whether a hold lasts long against the moves beside it, which a sine's extreme does not.

    A move reaches from the hold to the next hold of at least a quarter of its length, to the next
    turning point or to the end of the log.
    """
    start, stop = span
    times, turns = motion.time_s, motion.turns
    held_s = float(times[stop - 1] - times[start])
    like = [s for s in spans if times[s[1] - 1] - times[s[0]] >= LIKE_HOLD * held_s]
    stops_after = [s for s, _ in like if s >= stop] + turns[turns >= stop].tolist()
    stops_before = [e - 1 for _, e in like if e <= start] + turns[turns < start].tolist()
    after_s = float(times[min(stops_after, default=times.size - 1)] - times[stop - 1])
    before_s = float(times[start] - times[max(stops_before, default=0)])
    if start == 0 or stop == times.size:
        share = SHORTEST_HOLD_AT_END
    else:
        turning = bool(np.any((turns >= start) & (turns < stop)))
        share = SHORTEST_HOLD_AT_TURN if turning else SHORTEST_HOLD
        if _unevenness(motion, span, strict=False) > UNSETTLED:
            share = SHORTEST_UNEVEN_HOLD
    return held_s >= share * max(before_s, after_s)
