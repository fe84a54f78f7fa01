"""Where an input stands still: the settled windows of steps and staircases."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.excitation.noise import noise_std
from softid.excitation.texture import find_hold, find_quantisation, fresh_samples

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

MOST_SAMPLES = 20_000
SMALLEST_MOTION = 0.015
NOISE_SIGMAS = 2.2
NOISE_STEPS = 0.5
MIN_HOLD_SAMPLES = 8
EVEN = 0.12
UNEVEN = 0.23
RAMPING = 0.5
SHORTEST_UNEVEN_HOLD = 1.0
SHORTEST_HOLD = 0.3
SHORTEST_HOLD_AT_TURN = 0.5
SHORTEST_HOLD_AT_END = 0.15
LIKE_HOLD = 0.25
PAUSE = 5.0
MOST_PAUSED = 0.65
LEVEL_SPREAD = 2.0
CLEAR_JUMP = 3.0
WANDER = 2.0
WIDEST_WANDER = 4.0
GREATEST_EXCURSION = 3.0
TURN = 0.1
TOGGLING = 0.05


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


@dataclass(frozen=True, eq=False)
class Motion:
    """An input reduced to what its motion is judged by.

    Attributes
    ----------
    index
        Samples kept, as indices of the input, shape (m,): one per hold of a held input.
    time_s, values
        Their times and the input there, freed of single-sample glitches, shape (m,).
    tolerance
        Half the width within which the input counts as standing still.
    still
        Whether the whole input is no more than noise about one level.
    turns
        Positions in ``values`` of the turning points of its larger moves, ends not included.
    tubes
        Half-open ranges of ``values`` that stay within twice the tolerance, cut greedily; those
        of fewer than 8 samples are left out.
    thinning
        Of how many samples of a long log one is kept.
    fresh, full
        What ``index`` and ``values`` were before it was thinned, shape (k,).
    """

    index: IntArray
    time_s: Array
    values: Array
    tolerance: float
    still: bool
    turns: IntArray
    tubes: tuple[tuple[int, int], ...]
    thinning: int
    fresh: IntArray
    full: Array


def describe_motion(time_s: Array, input_values: Array) -> Motion:
    """Reduce an input to its motion.

    Parameters
    ----------
    time_s, input_values
        Samples, shape (n,), finite.
    """
    grid = find_quantisation(input_values)
    step = grid.step if grid else None
    hold = find_hold(time_s, input_values, step)
    sigma = noise_std(time_s, input_values, step=step, hold=hold)
    index = fresh_samples(time_s, input_values, hold)
    spread = _spread(input_values[index], sigma, step)
    fresh, full = index, median_of_five(input_values[index])
    thinning = -(-index.size // MOST_SAMPLES)
    index, values = fresh[::thinning], full[::thinning]
    span = float(values.max() - values.min())
    still = span <= 4.5 * spread or span <= 1e-12 * float(np.abs(values).max())
    tolerance = max(spread, SMALLEST_MOTION * span)
    turns = turning_points(values, max(TURN * span, 2.0 * tolerance))
    height = 2.0 * tolerance
    tubes = tuple(
        part
        for tube in _tubes(values, height)
        for part in _cut_at_jumps(values, tube, height, step or 0.0)
    )
    return Motion(
        index, time_s[index], values, tolerance, still, turns, tubes, thinning, fresh, full
    )


def _spread(values: Array, sigma: float | None, step: float | None) -> float:
    """How far noise and quantisation carry the input from its level.

    A grid as coarse as the steps of a noise-free staircase counts only if the input toggles on it.
    """
    quantum = step or 0.0
    if sigma is not None:
        return NOISE_SIGMAS * sigma + NOISE_STEPS * quantum
    moves = np.sign(np.diff(values))
    moves = moves[moves != 0.0]
    reversals = int(np.count_nonzero(moves[1:] != moves[:-1]))
    return quantum if reversals >= TOGGLING * values.size else 0.0


def median_of_five(values: Array) -> Array:
    """Running median over five samples, shorter at the ends: removes glitches, keeps edges."""
    if values.size < 5:
        return values.copy()
    padded = np.concatenate([values[:1], values[:1], values, values[-1:], values[-1:]])
    smooth: Array = np.median(np.lib.stride_tricks.sliding_window_view(padded, 5), axis=1)
    return smooth


def turning_points(values: Array, threshold: float) -> IntArray:
    """Positions of the extremes between moves larger than a threshold, ends not included."""
    turns: list[int] = []
    low = high = 0
    lowest = highest = float(values[0])
    direction = 0
    for k, v in enumerate(values.tolist()):
        if v > highest:
            high, highest = k, v
        if v < lowest:
            low, lowest = k, v
        if direction >= 0 and highest - v > threshold:
            turns.append(high)
            direction = -1
            low = high = k
            lowest = highest = v
        elif direction <= 0 and v - lowest > threshold:
            turns.append(low)
            direction = 1
            low = high = k
            lowest = highest = v
    return np.array([k for k in turns if k > 0], dtype=np.intp)


def find_holds(motion: Motion, *, strict: bool = False) -> list[tuple[int, int]]:
    """Half-open ranges of ``motion.values`` on which the input stands still, in order.

    Strict ones hold their level from the first to the last sample, without a tail of settling.
    """
    if motion.still:
        return [(0, motion.values.size)]
    even = [s for s in motion.tubes if _unevenness(motion, s, strict=strict) <= UNEVEN]
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
        level, allowed = float(np.median(held)), max(motion.tolerance, _wander(held))
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


def _tubes(values: Array, height: float) -> list[tuple[int, int]]:
    """Cut a signal greedily into ranges whose values differ by no more than a height."""
    numbers = values.tolist()
    falling: deque[int] = deque()
    rising: deque[int] = deque()
    spans, start = [], 0
    for k, v in enumerate(numbers):
        while falling and numbers[falling[-1]] <= v:
            falling.pop()
        falling.append(k)
        while rising and numbers[rising[-1]] >= v:
            rising.pop()
        rising.append(k)
        if numbers[falling[0]] - numbers[rising[0]] > height:
            if k - start >= MIN_HOLD_SAMPLES:
                spans.append((start, k))
            start = k
            falling, rising = deque([k]), deque([k])
    if len(numbers) - start >= MIN_HOLD_SAMPLES:
        spans.append((start, len(numbers)))
    return spans


def _cut_at_jumps(
    values: Array, tube: tuple[int, int], height: float, step: float
) -> list[tuple[int, int]]:
    """The levels of a staircase whose steps are so small that one range holds several.

    A range too uneven for a hold is cut where its two sides differ most, if each side is far
    narrower than their distance, which on a ramp or at the extreme of a wave it is not. One step
    of a coarse grid is no jump, for a slow motion takes it too.
    """
    held = values[slice(*tube)]
    count = held.size
    if count < 2 * MIN_HOLD_SAMPLES or min(_thirds_apart(held)) <= UNEVEN * height:
        return [tube]
    cuts = np.arange(MIN_HOLD_SAMPLES, count - MIN_HOLD_SAMPLES + 1)
    sums = np.cumsum(held - held.mean())
    best = int(cuts[np.argmax(sums[cuts - 1] ** 2 / (cuts * (count - cuts)))])
    one, other = held[:best], held[best:]
    jump = abs(float(np.median(one)) - float(np.median(other)))
    if jump <= CLEAR_JUMP * max(_wander(one), _wander(other), step):
        return [tube]
    cut = tube[0] + best
    parts = (tube[0], cut), (cut, tube[1])
    return [span for part in parts for span in _cut_at_jumps(values, part, height, step)]


def _unevenness(motion: Motion, span: tuple[int, int], *, strict: bool) -> float:
    """Difference of neighbouring thirds of a range, in tube heights; the larger one if strict.

    It is 1/3 on a ramp and 0.44 on a sine's extreme, both ways. A hold has one small difference
    even where it still settles or already leaves its level.
    """
    differences = _thirds_apart(motion.values[slice(*span)])
    return (max if strict else min)(differences) / (2.0 * motion.tolerance)


def _thirds_apart(held: Array) -> tuple[float, float]:
    first, middle, last = (float(third.mean()) for third in np.array_split(held, 3))
    return abs(first - middle), abs(middle - last)


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
    close = np.flatnonzero(off <= max(motion.tolerance, _wander(held)))
    return span[0] + int(close[0]), span[0] + int(close[-1]) + 1


def _same_hold(motion: Motion, before: tuple[int, int], after: tuple[int, int]) -> bool:
    """Whether two ranges are one hold whose level wanders as much within each as between them."""
    one, other = motion.values[slice(*before)], motion.values[slice(*after)]
    levels = float(np.median(one)), float(np.median(other))
    allowed = WANDER * max(_wander(one), _wander(other))
    allowed = min(max(motion.tolerance, allowed), WIDEST_WANDER * motion.tolerance)
    if abs(levels[0] - levels[1]) > allowed:
        return False
    between = motion.values[before[1] : after[0]]
    margin = GREATEST_EXCURSION * motion.tolerance
    return bool(np.all((between >= min(levels) - margin) & (between <= max(levels) + margin)))


def _wander(held: Array) -> float:
    """Width of the middle 80 % of the values of a hold."""
    ordered = np.sort(held)
    tenth = ordered.size // 10
    return float(ordered[-1 - tenth] - ordered[tenth])


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
        if _unevenness(motion, span, strict=False) > EVEN:
            share = SHORTEST_UNEVEN_HOLD
    return held_s >= share * max(before_s, after_s)
