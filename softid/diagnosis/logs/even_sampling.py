"""A log whose samples lie unevenly, read at even times, for rounds that only choose who goes on.

Nothing that is told or judged comes from it: between two samples a line stands for the motion, and
takes a part of the noise away.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.logs.decimation import is_regular
from softid.even_times import even_interval_s
from softid.identification.slow_outputs import SlowOutputLog
from softid.intersample import HELD
from softid.log import Log

Array = npt.NDArray[np.float64]

WIDEST_GAP = 2.5
"""Periods between two samples up to which a line stands for the output: over one that was lost."""


def evenly_sampled(log: Log) -> Log | None:
    """The log at even times, a median interval apart; itself where it is even already.

    None for a log that stalls or is sampled in bursts, and for an input that is held between its
    samples: where it changes would move. Of one whose outputs are slow, what the input does between
    them is left out.

    Parameters
    ----------
    log
        A log.

    Examples
    --------
    >>> ramp = [0.0, 1.0, 2.6, 3.0, 4.0]
    >>> log = Log.from_arrays(ramp, {"pressure": ramp, "angle": ramp})
    >>> even = evenly_sampled(log)
    >>> even.time_s.tolist(), even.channels["angle"].values.tolist()
    ([0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 2.0, 3.0, 4.0])
    """
    if isinstance(log, SlowOutputLog):
        if log.between_samples in HELD:
            return None
        log = log.at_samples_alone()
    if is_regular(log):
        return log
    if len(log.segments()) > 1 or log.between_samples in HELD:
        return None
    if even_interval_s(log.time_s) > log.period_s:
        return None
    count = int((log.time_s[-1] - log.time_s[0]) / log.period_s) + 1
    time_s = log.time_s[0] + log.period_s * np.arange(count)
    after = np.clip(np.searchsorted(log.time_s, time_s), 1, len(log) - 1)
    is_wide = log.time_s[after] - log.time_s[after - 1] > WIDEST_GAP * log.period_s
    channels = {
        name: replace(channel, values=np.interp(time_s, log.time_s, channel.values))
        for name, channel in log.channels.items()
    }
    masked = log.masked[after] | log.masked[after - 1] | is_wide
    return replace(log, time_s=time_s, channels=channels, masked=masked)
