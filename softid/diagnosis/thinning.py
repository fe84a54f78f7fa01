"""Logs that are sampled far faster than anything moves, averaged over a few samples each.

A linear motion passes an average on unchanged: averaged input in, averaged output out. A diagnosis
refits the logs a few hundred times, and gains nothing from the hundredth sample of a time constant.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.log import Log

Array = npt.NDArray[np.float64]

ENOUGH = 6000
"""No samples are averaged away below this number in all logs together."""

SAMPLES_PER_MOTION = 30.0
"""Samples that stay in a time constant of the motion at least: delays and lags of a few hundredths
of it still count in whole samples."""

REGULAR = 0.2
"""Sampling is regular when no interval differs from the median by more than this share."""


def samples_to_average(logs: Sequence[Log], motion_s: float) -> int:
    """Over how many samples the logs may be averaged; 1 for not at all.

    Parameters
    ----------
    logs
        The logs.
    motion_s
        Time constant of the motion.
    """
    if not all(_is_regular(log) for log in logs):
        return 1
    wanted = sum(len(log) for log in logs) / ENOUGH
    period_s = max(log.period_s for log in logs)
    return max(int(min(np.ceil(wanted), motion_s / SAMPLES_PER_MOTION / period_s)), 1)


def _is_regular(log: Log) -> bool:
    return bool(np.all(np.abs(np.diff(log.time_s) / log.period_s - 1.0) <= REGULAR))


def thinned(log: Log, count: int) -> Log:
    """The log with the mean of every ``count`` samples in their place.

    Parameters
    ----------
    log
        A regular log.
    count
        Samples in a mean; the last ones that fill no mean are left out.

    Examples
    --------
    >>> channels = {"pressure": [1, 3, 5, 7], "angle": [0, 2, 2, 4]}
    >>> log = Log.from_arrays([0.0, 0.1, 0.2, 0.3], channels)
    >>> thinned(log, 2).channels["angle"].values
    array([1., 3.])
    """
    if count == 1:
        return log
    groups = len(log) // count

    def mean(values: Array) -> Array:
        averaged: Array = values[: groups * count].reshape(groups, count).mean(axis=1)
        return averaged

    channels = {
        name: replace(channel, values=mean(channel.values))
        for name, channel in log.channels.items()
    }
    masked = None if log.masked is None else mean(log.masked.astype(np.float64)) > 0.0
    return replace(log, time_s=mean(log.time_s), channels=channels, masked=masked)
