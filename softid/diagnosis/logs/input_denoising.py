"""The recorded input without its noise.

A sensor's noise on the input makes the simulated actuator tremble. Laws that go by the path, like
hysteresis and softening, or by the sign of the speed, like friction, take the trembling for motion:
a hysteresis forgets during a hold what the real one keeps.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.excitation.noise import noise_std
from softid.log import Log

Array = npt.NDArray[np.float64]

REACH = 10
"""Samples to either side over which the input is averaged."""

PASSES = 2
"""Times that the mean is taken; the second tells edges from an input that has less noise."""

SIGMAS = 3.0
"""A pair of samples counts where both lie within so many standard deviations of the one between
them, so that edges stay and slopes are not bent."""


def without_input_noise(log: Log) -> Log:
    """The log with the noise of its input averaged away, edges and slopes kept.

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
        for _ in range(PASSES):
            values[span] = _averaged(values[span], SIGMAS * sigma)
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


def _averaged(values: Array, limit: float) -> Array:
    """Mean over the pairs of neighbours that belong to the same course, and the sample itself."""
    total, count = values.copy(), np.ones(values.size)
    for offset in range(1, min(REACH, (values.size - 1) // 2) + 1):
        middle = values[offset:-offset]
        before, after = values[: -2 * offset], values[2 * offset :]
        alike = (np.abs(before - middle) <= limit) & (np.abs(after - middle) <= limit)
        total[offset:-offset] += np.where(alike, before + after, 0.0)
        count[offset:-offset] += 2.0 * alike
    mean: Array = total / count
    return mean
