"""An input reduced to what its motion is judged by: levels, turning points, ranges within noise."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.excitation.noise import noise_std
from softid.excitation.texture import find_hold, find_quantisation, fresh_samples

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

MOST_SAMPLES = 20_000
"""Of a longer input only every so many-th sample is kept: turning points and tubes are found one
sample after the other, in less than a tenth of a second for so many."""

SMALLEST_MOTION = 0.015
"""Share of the range within which an input stands still however quiet it is: a pressure regulator
settles to a level and wanders about it by a per cent or so."""

NOISE_SIGMAS = 2.2
"""Noise on either side of a level, in its standard deviations. The median of five leaves 0.54 of
white noise, so that these are four of its own, which one sample in 25,000 exceeds."""

NOISE_STEPS = 0.5
"""What rounding to a grid adds to the noise on either side of a level, in steps of the grid: half a
step."""

STILL_RANGE = 4.5
"""Range of an input, in spreads of its noise, up to which all of it is one level. White noise of
`MOST_SAMPLES` samples ranges over two of them; the noise of real sensors wanders, too."""

ROUNDING_RANGE = 1e-12
"""Range, as a share of the values, that is no more than their rounding."""

LEAST_TURN = 0.1
"""Share of the range that an input must move for the ends of the move to be turning points: less
is a ripple upon a move."""

TOGGLING = 0.05
"""Reversals per sample from which a grid of steps is one that the input toggles on. A staircase
has one per several holds at most, and its steps are motion, not a spread."""

MIN_HOLD_SAMPLES = 8
"""Fewer samples have thirds of two, whose means say nothing about a trend."""

MOST_UNEVEN = 0.23
"""Unevenness, in heights of the tube, up to which one may be a hold (`thirds_apart`). It is 1/3 on
a ramp and 0.44 on a sine's extreme; noise about a level stays below 0.1."""

CLEAR_JUMP = 3.0
"""Distance of two levels, in the widths of either, from which they are two. The halves of a ramp
are 1.25 of their widths apart."""


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
    still = span <= STILL_RANGE * spread or span <= ROUNDING_RANGE * float(np.abs(values).max())
    tolerance = max(spread, SMALLEST_MOTION * span)
    height = 2.0 * tolerance
    turns = turning_points(values, max(LEAST_TURN * span, height))
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
    if count < 2 * MIN_HOLD_SAMPLES or min(thirds_apart(held)) <= MOST_UNEVEN * height:
        return [tube]
    cuts = np.arange(MIN_HOLD_SAMPLES, count - MIN_HOLD_SAMPLES + 1)
    sums = np.cumsum(held - held.mean())
    best = int(cuts[np.argmax(sums[cuts - 1] ** 2 / (cuts * (count - cuts)))])
    one, other = held[:best], held[best:]
    jump = abs(float(np.median(one)) - float(np.median(other)))
    if jump <= CLEAR_JUMP * max(wander(one), wander(other), step):
        return [tube]
    cut = tube[0] + best
    parts = (tube[0], cut), (cut, tube[1])
    return [span for part in parts for span in _cut_at_jumps(values, part, height, step)]


def thirds_apart(held: Array) -> tuple[float, float]:
    """Difference of the means of the first and the middle third, and of the middle and the last."""
    first, middle, last = (float(third.mean()) for third in np.array_split(held, 3))
    return abs(first - middle), abs(middle - last)


def wander(held: Array) -> float:
    """Width of the middle 80 % of the values of a hold."""
    ordered = np.sort(held)
    tenth = ordered.size // 10
    return float(ordered[-1 - tenth] - ordered[tenth])
