"""Standard deviation of the white noise of one signal, whatever its sampling."""

from __future__ import annotations

from math import comb, sqrt

import numpy as np
import numpy.typing as npt

from softid.excitation.texture import SampleHold, fresh_samples

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

NORMAL_QUARTILE = 0.6745
"""Median of the size of a normal number, in its standard deviations."""

SECOND_DIFFERENCE = 6.0
"""Variance of a second difference of white noise in its own, 1² + 2² + 1²."""

ONE_SIGMA = 0.6826894921370859
"""Share of a normal law within one standard deviation; a few jumps hardly move this quantile."""

UNRESOLVED_STEPS = 0.4
"""Noise, in steps of the grid, whose variance is that of quantisation and dither together, step²/6:
less is lost in the difference of the two."""

GOLDEN = 0.6180339887498949
"""The golden ratio's fraction; its multiples, taken modulo one, fill the step most evenly."""

MIN_NOISE_SAMPLES = 20
"""Fewer differences tell their spread to no better than a fifth or so."""

DIFFERENCE_SAMPLES = (3, 4, 5, 6, 7)
"""Samples in a difference. Fewer do not remove a bend; more remove faster motion but span so long a
window that jumps are in nearly all of them."""

LONGEST_WINDOW = 4.0
"""A window that lasts so many times what it should spans a gap."""

ROUNDING_NOISE = 1e-9
"""Noise as a share of the range that is no more than the rounding of the file."""

NO_NOISE = 1e-12
"""Noise as a share of the values that is no more than the rounding of their arithmetic."""

EVEN_SPREAD = 1e-6
"""Relative spread of the sampling intervals up to which all windows share one set of weights."""


def noise_std(
    time_s: Array,
    values: Array,
    *,
    step: float | None = None,
    hold: SampleHold | None = None,
    where: BoolArray | None = None,
) -> float | None:
    """Standard deviation of the white part of a channel's noise.

    Divided differences Σ w_j v_j over 3 to 7 neighbouring samples, with Σ w_j t_j^m = 0 up to
    m = 1 … 5 and Σ w_j² = 1, remove smooth motion on any sampling; their 68 % quantile is the
    noise, and the smallest of the five is taken. The steps of a quantised channel are
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
    for neighbours in DIFFERENCE_SAMPLES:
        differences = _divided_differences(times, picked + dither, allowed, neighbours)
        if differences.size >= MIN_NOISE_SAMPLES:
            spreads.append(float(np.quantile(np.abs(differences), ONE_SIGMA)))
    if not spreads:
        return None
    largest = float(np.abs(picked).max())
    if min(spreads) <= ROUNDING_NOISE * float(np.ptp(picked)) + NO_NOISE * largest:
        return 0.0
    variance = min(spreads) ** 2 - quantum**2 / 6.0
    if variance <= (UNRESOLVED_STEPS * quantum) ** 2:
        return None
    return sqrt(variance)


def second_difference_noise(values: Array) -> float:
    """Standard deviation of the white noise of even samples, σ = med|v″|/(0.6745 √6).

    The median leaves out what jumps; v″ is v_{k−1} − 2 v_k + v_{k+1}.

    Parameters
    ----------
    values
        Samples that follow each other, shape (n,), without NaN.

    Returns
    -------
    float
        Zero for fewer than three samples.

    Examples
    --------
    >>> noise = np.random.default_rng(1).normal(scale=0.5, size=10_000)
    >>> round(second_difference_noise(noise), 2)
    0.5
    """
    if values.size < 3:
        return 0.0
    size = float(np.median(np.abs(np.diff(values, 2))))
    return size / (NORMAL_QUARTILE * sqrt(SECOND_DIFFERENCE))


def _divided_differences(
    time_s: Array, values: Array, allowed: BoolArray, neighbours: int
) -> Array:
    """Normalised divided differences of the windows that are allowed and span no gap."""
    intervals = np.diff(time_s)
    if allowed.all() and intervals.size and np.ptp(intervals) <= EVEN_SPREAD * intervals.min():
        return _even_differences(values, neighbours)
    windows = np.lib.stride_tricks.sliding_window_view
    longest = LONGEST_WINDOW * neighbours * float(np.median(intervals))
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


def _even_differences(values: Array, neighbours: int) -> Array:
    """The same on even sampling, where the weights are binomials of alternating sign."""
    weights = np.array([(-1.0) ** j * comb(neighbours - 1, j) for j in range(neighbours)])
    differences: Array = np.convolve(values, weights / np.linalg.norm(weights), "valid")
    return differences
