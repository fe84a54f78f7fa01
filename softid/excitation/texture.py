"""What sampling and sensor leave on a single signal: quantisation step, zero-order hold, noise.

Excitation cannot be told from noise, nor a staircase from a held sample, without these three.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log2, sqrt

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
BoolArray = npt.NDArray[np.bool_]

MIN_LEVELS = 4
LATTICE_TOLERANCE = 0.15
LATTICE_SHARE = 0.95
GRID_REFINEMENTS = (3.5, 10.5, np.inf)
MANY_LEVELS = 5
MIN_JUMPS = 12
JUMP_STEPS = 2.5
FINE_STEPS = 20.0
CHANCE_OF_REPEAT = 0.15
CHANCE_OF_REPEAT_FINE = 0.02
LEAST_EXCESS = 0.1
LONGEST_HOLD_SAMPLES = 50
LONGEST_HOLD_SHARE = 0.015
ONE_SIGMA = 0.6826894921370859
UNRESOLVED_STEPS = 0.4
GOLDEN = 0.6180339887498949
MIN_NOISE_SAMPLES = 20


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
    >>> find_quantisation(np.array([0.0, 0.25, 1.0, 0.5, 1.75, 0.25])).step
    0.25
    """
    distinct = np.unique(values[np.isfinite(values)])
    if distinct.size < MIN_LEVELS:
        return None
    rounding = 1e-7 * float(np.abs(distinct).max())
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
    near_smallest = float(np.median(increments[increments <= 1.2 * smallest]))
    octave = np.round(np.log(increments / smallest) / np.log(1.1)).astype(np.intp)
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


def find_hold(time_s: Array, values: Array, step: float | None) -> SampleHold | None:
    """Recognise a channel that repeats its samples.

    A quantised channel repeats values by chance, but seldom after a jump of several steps: among
    white noise of any size it does so after at most 15 % of the jumps of 2.5 steps or more, and a
    fine-grained channel hardly ever. One that does so clearly more often is held.

    Parameters
    ----------
    time_s, values
        Samples, shape (n,), without NaN.
    step
        Quantisation step of the channel, or None.

    Returns
    -------
    SampleHold or None
        None also for a channel with few levels or with holds too long for a sensor's clock,
        which is a staircase.
    """
    starts = run_starts(values)
    if starts.size < MIN_JUMPS + 2 or np.unique(values).size < MANY_LEVELS:
        return None
    jumps = np.abs(values[starts[1:-1]] - values[starts[1:-1] - 1])
    lengths = np.diff(starts)[1:]
    big = jumps >= JUMP_STEPS * step if step else jumps > 0.0
    count = int(big.sum())
    if count < MIN_JUMPS:
        return None
    share = float(np.mean(lengths[big] >= 2))
    coarse = step is not None and float(np.median(jumps[big])) < FINE_STEPS * step
    chance = CHANCE_OF_REPEAT if coarse else CHANCE_OF_REPEAT_FINE
    if share - chance < max(LEAST_EXCESS, 4.0 * sqrt(chance * (1.0 - chance) / count)):
        return None
    durations = time_s[starts[2:]] - time_s[starts[1:-1]]
    kept = big & (lengths <= 3.0 * np.median(lengths[big]))
    factor, hold_s = float(lengths[kept].mean()), float(durations[kept].mean())
    span = float(values.max() - values.min())
    deliberate = factor > 10.0 and float(np.median(jumps[big])) > 0.1 * span
    too_long = hold_s > LONGEST_HOLD_SHARE * float(time_s[-1] - time_s[0])
    if deliberate or too_long or factor > LONGEST_HOLD_SAMPLES:
        return None
    return SampleHold(factor, hold_s, 1.0 / hold_s)


def fresh_samples(time_s: Array, values: Array, hold: SampleHold | None) -> IntArray:
    """Indices of the samples that bring news, shape (m,): one per hold of a held channel.

    A run that lasts several holds, as when a quantised value happens to repeat, gives several.
    """
    if hold is None:
        return np.arange(values.size)
    starts = run_starts(values)
    stops = np.append(starts[1:], values.size)
    ends_s = np.append(time_s[starts[1:]], time_s[-1])
    wanted = np.maximum(np.round((ends_s - time_s[starts]) / hold.hold_s), 1.0).astype(np.intp)
    wanted = np.minimum(wanted, stops - starts)
    run = np.repeat(np.arange(starts.size), wanted)
    rank = np.arange(run.size) - np.repeat(np.cumsum(wanted) - wanted, wanted)
    index: IntArray = starts[run] + (rank * (stops - starts)[run]) // wanted[run]
    return index


def noise_std(
    time_s: Array,
    values: Array,
    *,
    step: float | None = None,
    hold: SampleHold | None = None,
    where: BoolArray | None = None,
) -> float | None:
    """Standard deviation of the white part of a channel's noise.

    Divided differences Σ w_j v_j over 3, 4 and 5 neighbouring samples, with Σ w_j t_j^m = 0 for
    m = 0 … 1, 2, 3 and Σ w_j² = 1, remove smooth motion on any sampling; their 68 % quantile is
    the noise, and the smallest of the three is taken. The steps of a quantised channel are
    smeared by a known dither, whose variance is subtracted with that of the quantisation,
    σ² = s² − step²/6.

    Parameters
    ----------
    time_s, values
        Samples, shape (n,), without NaN.
    step
        Quantisation step, or None.
    hold
        Zero-order hold, or None.
    where
        Samples to look at, such as rests, shape (n,); None looks at all.

    Returns
    -------
    float or None
        None when there are fewer than 20 fresh samples, or when the noise is below 0.4 steps and
        so hidden by the quantisation.
    """
    fresh = fresh_samples(time_s, values, hold)
    if fresh.size < MIN_NOISE_SAMPLES:
        return None
    times, picked = time_s[fresh], values[fresh]
    allowed = np.ones(fresh.size, bool) if where is None else where[fresh]
    quantum = step or 0.0
    dither = quantum * ((np.arange(fresh.size) * GOLDEN) % 1.0 - 0.5)
    spreads = []
    for neighbours in (3, 4, 5):
        differences = _divided_differences(times, picked + dither, allowed, neighbours)
        if differences.size >= MIN_NOISE_SAMPLES:
            spreads.append(float(np.quantile(np.abs(differences), ONE_SIGMA)))
    if not spreads:
        return None
    variance = min(spreads) ** 2 - quantum**2 / 6.0
    if variance <= (UNRESOLVED_STEPS * quantum) ** 2:
        return 0.0 if quantum == 0.0 else None
    return sqrt(variance)


def _divided_differences(
    time_s: Array, values: Array, allowed: BoolArray, neighbours: int
) -> Array:
    """Normalised divided differences of the windows that are allowed and span no gap."""
    windows = np.lib.stride_tricks.sliding_window_view
    longest = 4.0 * neighbours * float(np.median(np.diff(time_s)))
    usable = windows(allowed, neighbours).all(axis=1)
    usable &= time_s[neighbours - 1 :] - time_s[: 1 - neighbours] <= longest
    local = windows(time_s, neighbours)[usable]
    weights = np.ones(local.shape)
    for j in range(neighbours):
        for k in range(neighbours):
            if k != j:
                weights[:, j] *= local[:, j] - local[:, k]
    # Scaled by the window's length so that products of short intervals cannot underflow.
    weights = (local[:, -1:] - local[:, :1]) ** (neighbours - 1) / weights
    weights /= np.sqrt((weights**2).sum(axis=1, keepdims=True))
    differences: Array = (weights * windows(values, neighbours)[usable]).sum(axis=1)
    return differences
