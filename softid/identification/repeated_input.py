"""An input that a slower sensor delivers: each value is repeated until the next one arrives.

Two clocks in one file: what is logged at 120 Hz holds a pressure that is read 25 times a second.
The repeats are no measurements. Taken as they stand, the input is a staircase that lags behind the
pressure by half a step on average, which looks like a lag of the actuator and follows no law.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softid.errors import Issue
from softid.excitation import find_hold, find_quantisation, fresh_samples
from softid.identification.intersample_choice import COMMAND
from softid.intersample import HELD
from softid.log import Log

REPEATED_INPUT = "repeated-input"
"""Code of the remark that repeats of the input were bridged."""


def without_repeats(log: Log) -> Log:
    """The log with a measured input that is straight between the samples that brought news.

    A command, and an input of which it is declared that it is held, stay as they are: it is they
    that hold their values.

    Parameters
    ----------
    log
        A log; its outputs are not touched.
    """
    if log.input == COMMAND or log.intersample in HELD:
        return log
    channel = log.channels[log.input]
    grid = find_quantisation(channel.values)
    hold = find_hold(log.time_s, channel.values, grid.step if grid else None)
    if hold is None:
        return log
    values = channel.values.copy()
    for segment in log.segments():
        span = slice(segment.start, segment.stop)
        time_s = log.time_s[span]
        fresh = fresh_samples(time_s, values[span], hold)
        values[span] = np.interp(time_s, time_s[fresh], values[span][fresh])
    issue = Issue(
        REPEATED_INPUT,
        "info",
        f"{log.name}: {log.input} repeats each value for about {hold.factor:.2g} samples, until "
        f"{hold.rate_hz:.3g} times a second a new one arrives; it is taken as straight between "
        "the new ones",
        "record all channels at one rate; if it is a command, map it as pressure_command",
    )
    channels = dict(log.channels) | {log.input: replace(channel, values=values)}
    return replace(log, channels=channels, issues=(*log.issues, issue))
