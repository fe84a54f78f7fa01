"""The recorded input without its noise.

A sensor's noise on the input makes the simulated actuator tremble. Laws that go by the path, like
hysteresis and softening, or by the sign of the speed, like friction, take the trembling for motion:
a hysteresis forgets during a hold what the real one keeps.

What takes the noise away must not bend the course: a mean over neighbours rounds it off where it
turns, on average by more than the noise moves a parameter, and inertia and damping make up for
that. A parabola through them does not. Where the input is held it goes through many more of them:
the trembling that is left there is the longest path of a log with pauses.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.excitation.noise import noise_std
from softid.log import Log

Array = npt.NDArray[np.float64]

FURTHEST_NEIGHBOUR = 10
"""Samples to either side through which a parabola goes at most where the input moves."""

PASSES = 2
"""Times that an input is smoothed; the second tells edges from an input that has less noise."""

SIGMAS = 5.0
"""Pairs count as far as both samples lie within so many standard deviations of the one between
them, so that edges stay. Of white noise one difference in 2500 is larger."""

LONGER_REACHES = (14, 20, 28, 40, 56, 80)
"""Samples to either side through which a parabola goes where the input is held, tried in turn."""

SAME_LEVEL = 3.0
"""The input is held as far as the samples that a longer reach adds lie, on the average, within so
many standard errors of the level between them: it may slope there, but hardly bend."""

PARABOLA = 9.0 / 4.0
"""Variance of a parabola's value in the middle of many samples, in units of their mean's."""

FEWEST_NEIGHBOURS = 5
"""Samples that show how a course bends; a parabola through three takes no noise away."""


def without_input_noise(log: Log) -> Log:
    """The log with the noise of its input smoothed away; edges, slopes and bends stay.

    Parameters
    ----------
    log
        A log; its outputs are not touched.
    """
    channel = log.channels[log.input]
    values = channel.values.copy()
    sigma = input_noise_sd(log)
    if not sigma > 0.0:
        return log
    for segment in log.segments():
        span = slice(segment.start, segment.stop)
        values[span] = _without_noise(values[span], sigma)
    channels = dict(log.channels) | {log.input: replace(channel, values=values)}
    return replace(log, channels=channels)


def input_noise_sd(log: Log) -> float:
    """Standard deviation of the noise of the input, in its unit; 0 where it shows none.

    Parameters
    ----------
    log
        A log as it was recorded.
    """
    return noise_std(log.time_s, log.channels[log.input].values) or 0.0


def _without_noise(recorded: Array, sigma: float) -> Array:
    """The course of one stretch without its noise."""
    course = recorded
    for _ in range(PASSES):
        course = _smoothed(course, SIGMAS * sigma)
    return _smoothed_where_held(recorded, course, sigma)


def _smoothed_where_held(recorded: Array, course: Array, sigma: float) -> Array:
    """The course, and where the input is held the parabola through as many samples as it is.

    A reach is taken while all of the course within it stays within the limit of pairs, and while
    the mean of what the reach before left out is that of the level inside.
    """
    from scipy.ndimage import maximum_filter1d, minimum_filter1d  # slow to import

    found, inside = course, FURTHEST_NEIGHBOUR
    held = np.ones(recorded.size, bool)
    for reach in LONGER_REACHES:
        width, count = 2 * reach + 1, 2 * (reach - inside)
        if width > recorded.size:
            break
        highest, lowest = maximum_filter1d(course, width), minimum_filter1d(course, width)
        held &= np.maximum(highest - course, course - lowest) <= SIGMAS * sigma
        added = _sums(recorded, reach) - _sums(recorded, inside)
        error = sigma * (1.0 / count + PARABOLA / (2 * inside + 1)) ** 0.5
        held &= np.abs(added / count - found) <= SAME_LEVEL * error
        held[:reach] = held[-reach:] = False
        found = np.where(held, np.convolve(recorded, _parabola(reach), mode="same"), found)
        inside = reach
    smooth: Array = np.where(found != course, _smoothed(found, SIGMAS * sigma), found)
    return smooth


def _sums(values: Array, reach: int) -> Array:
    """Sums of the samples up to a reach to either side of each; those at the ends mean nothing."""
    return np.convolve(values, np.ones(2 * reach + 1), mode="same")


def _parabola(reach: int) -> Array:
    """Weights of the samples about one in the parabola's value there, as in `_smoothed`."""
    k = np.arange(-reach, reach + 1.0)
    s2, s4 = np.sum(k**2), np.sum(k**4)
    weights: Array = (s4 - s2 * k**2) / (k.size * s4 - s2**2)
    return weights


def _smoothed(values: Array, limit: float) -> Array:
    r"""At every sample the parabola through the pairs about it that belong to the same course.

    With the samples y₊ₖ and y₋ₖ of k = 1 … K beside y₀ the even part of the parabola at 0 is
    (S₄ Y₀ − S₂ Y₂)/(S₀ S₄ − S₂²), where S and Y with index j are sums of kʲ and of kʲ y over all of
    them (Savitzky and Golay 1964). The first pair that lies apart ends the course.
    """
    s0, s2, s4 = np.ones(values.size), np.zeros(values.size), np.zeros(values.size)
    y0, y2 = values.copy(), np.zeros(values.size)
    goes_on = np.ones(values.size, bool)
    for k in range(1, min(FURTHEST_NEIGHBOUR, (values.size - 1) // 2) + 1):
        middle, before, after = values[k:-k], values[: -2 * k], values[2 * k :]
        alike = (np.abs(before - middle) <= limit) & (np.abs(after - middle) <= limit)
        goes_on[:k] = goes_on[-k:] = False
        goes_on[k:-k] &= alike
        pair = np.where(goes_on[k:-k], before + after, 0.0)
        count = 2.0 * goes_on
        s0, s2, s4 = s0 + count, s2 + count * k**2, s4 + count * k**4
        y0[k:-k] += pair
        y2[k:-k] += pair * k**2
    bends = s0 >= FEWEST_NEIGHBOURS
    spread = np.where(bends, s0 * s4 - s2**2, 1.0)
    smooth: Array = np.where(bends, (s4 * y0 - s2 * y2) / spread, values)
    return smooth
