"""What sampling and sensor leave on a single signal: quantisation, zero-order hold, dead band.

A staircase cannot be told from held samples without them.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log2

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
BoolArray = npt.NDArray[np.bool_]

MIN_LEVELS = 4
"""Fewer distinct values say nothing of a grid: any three lie on one in nine of ten cases."""

LATTICE_TOLERANCE = 0.15
"""Distance from the grid, in steps, that rounding in the file may make of a value on it. Values
without a grid lie within it by chance in 30 % of cases."""

LATTICE_SHARE = 0.95
"""Share of the values that must lie on the grid: the others are sentinels and means of two
samples."""

SAME_VALUE = 1e-7
"""Values that differ by less than this share of the largest are one, printed twice."""

NEAR_SMALLEST = 1.2
"""Increments up to so many times the smallest are the same one: rounding may make a tenth of it,
and the next on a grid is twice as large."""

COMMON_BIN = 1.1
"""Ratio of the increments that are counted as one to find the commonest: rounding may make a tenth
of one."""

GRID_REFINEMENTS = (3.5, 10.5, np.inf)
"""Largest increments, in steps, that refine the step in turn: an error of a tenth miscounts those
of five steps and more, so that the short ones must make it smaller before the long ones count."""

MANY_LEVELS = 5
"""Fewer distinct values are switched between, and repeat without any hold."""

MIN_JUMPS = 12
"""Fewer jumps tell no share of repetitions: a quarter of them is three."""

JUMP_STEPS = 2.5
"""Steps of the grid from which a move is a jump: noise on a coarse grid moves by one or two."""

FINE_STEPS = 20.0
"""Usual jump, in steps of the grid, from which the grid is too fine for values to repeat by chance
more often than once in twenty times."""

LEAST_REPEATED = 0.25
"""Share of the jumps that a repetition follows in a held channel on a coarse grid."""

LEAST_REPEATED_FINE = 0.12
"""Share of the jumps that a repetition follows in a held channel on a fine grid, where chance makes
less of them than on a coarse one."""

REPEATED_OVER_ONE_STEP = 3.0
"""Repetitions on a coarse grid per move by one step up, or down: chance makes about as many of
each."""

LONGEST_SINGLE_HOLD = 3.0
"""Runs longer than so many times the usual one are several holds of a value that came again."""

PART_OF_HOLD = 0.25
"""What a run may lack of a whole number of holds: runs of a sensor that does not beat with the log
are one sample shorter or longer, and no longer run may count as one hold fewer."""

MOST_REGULAR_HOLD = 20
"""Longest hold in samples that is sought by its beat; longer ones show in their runs."""

SAME_PHASE = 0.97
"""Share of the changes on the beat of a regular hold; a few samples may be lost."""

REGULAR_CHANGES = 30
"""Fewer changes are on a beat of two or three by chance, or in a staircase with equal holds."""

NOISY_REVERSALS = 0.25
"""Share of the changes that turn round from which a channel is noisy: those of white noise do in
two of three cases, those of a slow ramp never."""

LEAP = 1.5
"""Steps from which a change goes past the next grid point, which a slow ramp never does."""

LEAPS = 0.2
"""Share of changes of `LEAP` steps and more from which the channel is no slow ramp on a coarse
grid."""

EVEN_JUMPS = 0.35
"""Interquartile range of log jumps up to which they are alike; that of a sine sampled at even times
is 0.9."""

UNEVEN_DURATIONS = 4.0
"""Interquartile range of log durations, over that of the jumps, from which the jumps decide when
the channel moves and not a clock."""

DEAD_BAND_STEPS = 5.0
"""Jumps of fewer steps are those of the grid, seen in a slow motion."""

LONGEST_HOLD_SAMPLES = 50
"""A sensor is not read so much faster than it delivers; such holds are levels that somebody set."""

LONGEST_HOLD_SHARE = 0.015
"""Longest hold of a slow sensor as a share of the log: none is so short that a hold is more of it,
one of seventy values."""

DELIBERATE_SAMPLES = 10.0
"""Samples of a hold beyond which it is a level that somebody set, where the usual jump is
`DELIBERATE_JUMP` of the range."""

DELIBERATE_JUMP = 0.1
"""Usual jump between long holds, as a share of the range, beyond which they are levels that
somebody set: no sensor is so slow that what it measures goes through its range in ten of its
samples."""


@dataclass(frozen=True)
class Quantisation:
    """The grid on which the values of a channel lie.

    Attributes
    ----------
    step
        Distance of neighbouring grid points, in the channel's unit.
    levels
        Number of distinct values met.
    bits
        log2 of the number of grid points from the smallest to the largest value.
    """

    step: float
    levels: int
    bits: float


@dataclass(frozen=True)
class SampleHold:
    """A channel that repeats each sample until a slower sensor delivers the next.

    Attributes
    ----------
    factor
        Mean number of samples for which a value is repeated.
    hold_s
        Mean time for which it is repeated.
    rate_hz
        Effective rate, 1/``hold_s``.
    """

    factor: float
    hold_s: float
    rate_hz: float


def run_starts(values: Array) -> IntArray:
    """First index of each run of equal values, shape (number of runs,).

    Examples
    --------
    >>> run_starts(np.array([5.0, 5.0, 6.0, 5.0])).tolist()
    [0, 2, 3]
    """
    changed = np.concatenate([[True], values[1:] != values[:-1]])
    return np.flatnonzero(changed)


def find_quantisation(values: Array) -> Quantisation | None:
    """Find the smallest recurring increment of a channel.

    The distinct values must lie on a grid v0 + k·step, all but 5 % of them within 0.15 steps;
    step and v0 by least squares over the distinct values, so that rounding in the file averages
    out.

    Parameters
    ----------
    values
        Samples, shape (n,); NaN is ignored.

    Returns
    -------
    Quantisation or None
        None for fewer than four distinct values or when there is no common grid.

    Examples
    --------
    >>> round(find_quantisation(np.array([0.0, 0.25, 1.0, 0.5, 1.75, 0.25])).step, 9)
    0.25
    """
    distinct = np.unique(values[np.isfinite(values)])
    if distinct.size < MIN_LEVELS:
        return None
    rounding = SAME_VALUE * float(np.abs(distinct).max())
    distinct = distinct[np.concatenate([[True], np.diff(distinct) > rounding])]
    if distinct.size < MIN_LEVELS:
        return None
    increments = np.diff(distinct)
    for candidate in _candidate_steps(increments):
        step = _fitted_step(distinct, increments, candidate)
        if step is not None:
            points = (distinct[-1] - distinct[0]) / step + 1.0
            return Quantisation(step, int(distinct.size), log2(points))
    return None


def _candidate_steps(increments: Array) -> list[float]:
    """The commonest increment and the smallest one, larger first."""
    smallest = float(increments.min())
    near_smallest = float(np.median(increments[increments <= NEAR_SMALLEST * smallest]))
    octave = np.round(np.log(increments / smallest) / np.log(COMMON_BIN)).astype(np.intp)
    common = float(np.median(increments[octave == np.bincount(octave).argmax()]))
    return sorted({near_smallest, common}, reverse=True)


def _fitted_step(distinct: Array, increments: Array, candidate: float) -> float | None:
    """Least-squares step of the grid that the candidate starts, None when there is no grid."""
    step = candidate
    for limit in GRID_REFINEMENTS:
        short = increments[increments <= limit * step]
        multiples = np.maximum(np.round(short / step), 1.0)
        step = float(short.sum() / multiples.sum())
    index = np.concatenate([[0.0], np.cumsum(np.maximum(np.round(increments / step), 1.0))])
    centred = index - index.mean()
    step = float(centred @ distinct) / float(centred @ centred)
    if step <= 0.0:
        return None
    off_grid = (distinct - distinct.mean()) / step - centred
    off_grid -= np.median(off_grid)
    share = float(np.mean(np.abs(off_grid) <= LATTICE_TOLERANCE))
    return step if share >= LATTICE_SHARE else None


def find_hold(
    time_s: Array, values: Array, step: float | None, *, may_be_set: bool = True
) -> SampleHold | None:
    """Recognise a channel that repeats its samples.

    What follows after a jump tells: a held channel stays exactly where it is. A fine-grained one
    that is not held hardly ever does; a coarsely quantised one may, but then moves of one step are
    about as frequent. So at least 12 % of the jumps of 2.5 steps or more must be followed by a
    repetition, of a coarse channel 25 % and three times as many as by one step up or down. A noisy
    channel that changes at every k-th sample only is held whatever its jumps.

    Parameters
    ----------
    time_s, values
        Samples, shape (n,), without NaN.
    step
        Quantisation step of the channel, or None.
    may_be_set
        Whether somebody may have set the levels, as those of a staircase.

    Returns
    -------
    SampleHold or None
        None also for a channel with few levels, with a dead band, or with holds too long for a
        sensor's clock, which is a staircase.
    """
    regular = _regular_hold(values, step)
    if regular is not None:
        hold_s = regular * float(np.median(np.diff(time_s)))
        return _sensor_hold(time_s, values, float(regular), hold_s, may_be_set=may_be_set)
    found = _find_repetition(time_s, values, step)
    if found is None or found.by_dead_band:
        return None
    kept = found.lengths <= LONGEST_SINGLE_HOLD * np.median(found.lengths)
    factor = float(found.lengths[kept].mean())
    hold_s = float(found.durations_s[kept].mean())
    return _sensor_hold(time_s, values, factor, hold_s, may_be_set=may_be_set)


def _sensor_hold(
    time_s: Array, values: Array, factor: float, hold_s: float, *, may_be_set: bool
) -> SampleHold | None:
    """A hold, unless it is so long that somebody must have wanted it."""
    moves = np.abs(np.diff(values))
    jump = float(np.median(moves[moves > 0.0]))
    is_far = jump > DELIBERATE_JUMP * float(np.ptp(values))
    deliberate = may_be_set and factor > DELIBERATE_SAMPLES and is_far
    too_long = hold_s > LONGEST_HOLD_SHARE * float(time_s[-1] - time_s[0])
    if deliberate or too_long or factor > LONGEST_HOLD_SAMPLES:
        return None
    return SampleHold(factor, hold_s, 1.0 / hold_s)


def _regular_hold(values: Array, step: float | None) -> int | None:
    """The k for which values change at multiples of k samples only, None when there is none.

    A noise-free ramp on a coarse grid does so too, but step by step and without turning.
    """
    changes = run_starts(values)[1:]
    if changes.size < REGULAR_CHANGES:
        return None
    moves = values[changes] - values[changes - 1]
    turning = float(np.mean((moves[1:] > 0) != (moves[:-1] > 0)))
    leaping = float(np.mean(np.abs(moves) >= LEAP * (step or 0.0)))
    if turning < NOISY_REVERSALS and leaping < LEAPS:
        return None
    usual = float(np.median(np.diff(changes)))
    for k in range(MOST_REGULAR_HOLD, 1, -1):
        if usual <= 2 * k and np.bincount(changes % k).max() >= SAME_PHASE * changes.size:
            return k
    return None


def find_dead_band(time_s: Array, values: Array, step: float | None) -> float | None:
    """Size of the jumps of a channel that moves only when its quantity has changed enough.

    Such a channel repeats values like a held one, but its jumps are all alike and its rests are
    not. A bend sensor read through a coarse converter and a calibration curve is one.

    Parameters
    ----------
    time_s, values
        Samples, shape (n,), without NaN.
    step
        Quantisation step of the channel, or None.

    Returns
    -------
    float or None
        Median jump, in the channel's unit; None when it is not clearly larger than the step.
    """
    found = _find_repetition(time_s, values, step)
    if found is None or not found.by_dead_band:
        return None
    size = float(np.median(found.jumps))
    return size if size >= DEAD_BAND_STEPS * (step or 0.0) else None


@dataclass(frozen=True, eq=False)
class _Repetition:
    """Runs of equal values that follow a big jump: their jumps, lengths and durations."""

    jumps: Array
    lengths: IntArray
    durations_s: Array

    @property
    def by_dead_band(self) -> bool:
        """Whether the jumps are alike and the durations are not."""
        jumps, durations = (
            float(np.subtract(*np.quantile(np.log(x), (0.75, 0.25))))
            for x in (self.jumps, self.durations_s)
        )
        return jumps <= EVEN_JUMPS and durations > UNEVEN_DURATIONS * jumps


def _find_repetition(time_s: Array, values: Array, step: float | None) -> _Repetition | None:
    starts = run_starts(values)
    if starts.size < MIN_JUMPS + 2 or np.unique(values).size < MANY_LEVELS:
        return None
    jumps = np.abs(values[starts[1:-1]] - values[starts[1:-1] - 1])
    big = jumps >= JUMP_STEPS * (step or 0.0)
    lengths = np.diff(starts)[1:][big]
    if lengths.size < MIN_JUMPS or not _repeats(values, starts[1:-1][big], lengths, step):
        return None
    durations_s = (time_s[starts[2:]] - time_s[starts[1:-1]])[big]
    return _Repetition(jumps[big], lengths, durations_s)


def _repeats(values: Array, after: IntArray, lengths: IntArray, step: float | None) -> bool:
    """Whether the values that follow big jumps are repeated more often than by chance."""
    repeated = int(np.sum(lengths >= 2))
    share = repeated / after.size
    jumps = np.abs(values[after] - values[after - 1])
    if step is None or float(np.median(jumps)) >= FINE_STEPS * step:
        return share >= LEAST_REPEATED_FINE
    follows = np.round((values[after + 1] - values[after]) / step)
    by_one = max(int(np.sum(follows == 1.0)), int(np.sum(follows == -1.0)), 1)
    return share >= LEAST_REPEATED and repeated >= REPEATED_OVER_ONE_STEP * by_one


def fresh_samples(time_s: Array, values: Array, hold: SampleHold | None) -> IntArray:
    """Indices of the samples that bring news, shape (m,): one per hold of a held channel.

    A run that lasts several holds, as when a quantised value happens to repeat, gives several.
    """
    if hold is None:
        return np.arange(values.size)
    starts = run_starts(values)
    stops = np.append(starts[1:], values.size)
    lasting_s = np.append(time_s[starts[1:]], time_s[-1]) - time_s[starts]
    holds = np.minimum((stops - starts) / hold.factor, lasting_s / hold.hold_s)
    wanted = np.maximum(np.floor(holds + PART_OF_HOLD), 1.0).astype(np.intp)
    wanted = np.minimum(wanted, stops - starts)
    run = np.repeat(np.arange(starts.size), wanted)
    rank = np.arange(run.size) - np.repeat(np.cumsum(wanted) - wanted, wanted)
    index: IntArray = starts[run] + (rank * (stops - starts)[run]) // wanted[run]
    return index
