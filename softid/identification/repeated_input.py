"""An input that a slower sensor delivers: each value is repeated until the next one arrives.

Two clocks in one file: what is logged at 120 Hz holds a pressure that is read 25 times a second.
The repeats are no measurements. Taken as they stand, the input is a staircase that lags behind the
pressure by half a step on average, which looks like a lag of the actuator and follows no law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.channels import is_command
from softid.errors import Issue
from softid.excitation import SampleHold, run_starts
from softid.identification.repeated_output import rows_without_news
from softid.identification.repeated_values import has_new_values, hold_of, new_readings
from softid.identification.sensor_clock import find_clock
from softid.intersample import course_at
from softid.log import Log

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

RARELY = 0.02
"""Share of the rows without news of the outputs in which the input may change at most, where
`EXPECTED_CHANGES` would be expected in them."""

EXPECTED_CHANGES = 20.0
"""Changes of the input that rows without news of the outputs must be expected to hold, as often as
it changes elsewhere, to show that it repeats there."""

REPEATED_INPUT = "repeated-input"
"""Code of the remark that repeats of the input were bridged."""


def without_repeats(log: Log) -> Log:
    """The log with a measured input that is smooth between the samples that brought news.

    A cubic spline passes through them, but where the input changes abruptly it goes straight: what
    a spline swings beside a jump is not on record. Nor is when it jumped, between two readings.

    A command holds its values itself, and stays as it is; so does an input of which it is declared
    what it does between its samples.

    Parameters
    ----------
    log
        A log; its outputs are not touched.
    """
    if is_command(log.input) or log.intersample is not None:
        return log
    values = log.channels[log.input].values
    hold = hold_of(log.time_s, values)
    if hold is not None:
        told = (
            f"repeats each value for about {hold.factor:.2g} samples (new values at "
            f"{hold.rate_hz:.3g} Hz)"
        )
        return _bridged(log, lambda span: readings_of(log.time_s[span], values[span], hold), told)
    lost = _lost_rows(log)
    if lost is not None:
        told = f"repeats its last value in {int(lost.sum())} rows, as all else does"

        def others(span: slice) -> tuple[Array, Array]:
            known = ~lost[span]
            return log.time_s[span][known], values[span][known]

        return _bridged(log, others, told)
    return log


def _bridged(log: Log, readings: Callable[[slice], tuple[Array, Array]], told: str) -> Log:
    """The log with an input that goes on between its readings, and what is told of them."""
    channel = log.channels[log.input]
    values = channel.values.copy()
    every_s = []
    for segment in log.segments():
        span = slice(segment.start, segment.stop)
        read_s, read = readings(span)
        values[span] = course_at(log.time_s[span], read_s, read)
        every_s.append(read_s)
    issue = Issue(
        REPEATED_INPUT,
        "info",
        f"{log.name}: {log.input} {told}; it is taken as smooth between the new ones, "
        "and as straight where it jumps",
        "record all channels at one rate; if it is a command, map it as pressure_command",
    )
    channels = dict(log.channels) | {log.input: replace(channel, values=values)}
    return replace(
        log,
        channels=channels,
        issues=(*log.issues, issue),
        input_read_s=np.concatenate(every_s),
        input_read_range=(float(channel.values.min()), float(channel.values.max())),
    )


def _lost_rows(log: Log) -> BoolArray | None:
    """Rows that repeat the one before as a whole, shape (n,); None where there are no such rows.

    The outputs say which: what they repeat is repeated by the input, too, which elsewhere changes.
    """
    stale = rows_without_news(log)
    if not stale.any():
        return None
    changes = np.diff(log.channels[log.input].values, prepend=np.nan) != 0.0
    expected = float(np.mean(changes[~stale])) * int(stale.sum())
    if expected < EXPECTED_CHANGES or float(np.mean(changes[stale])) > RARELY:
        return None
    return stale


def readings_of(time_s: Array, values: Array, hold: SampleHold) -> tuple[Array, Array]:
    """When the sensor was read, and what it said.

    A value that is first seen in one sample was read since the one before. Where all first sights
    allow readings at regular times, these are the latest such times; else it was read when it is
    first seen.

    Parameters
    ----------
    time_s, values
        Samples of a stretch, each of shape (n,).
    hold
        How the sensor repeats its readings.
    """
    clock = find_clock(time_s, run_starts(values)[1:])
    fresh = new_readings(time_s, values, hold)
    if clock is None:
        return time_s[fresh], values[fresh]
    if has_new_values(values):
        return clock.taken_s(time_s, fresh), values[fresh]
    read_s = clock.readings_s(time_s[0], time_s[-1])
    return read_s, values[np.searchsorted(time_s, read_s - clock.allowance_s)]
