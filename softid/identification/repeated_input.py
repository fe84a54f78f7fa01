"""An input that a slower sensor delivers: each value is repeated until the next one arrives.

Two clocks in one file: what is logged at 120 Hz holds a pressure that is read 25 times a second.
The repeats are no measurements. Taken as they stand, the input is a staircase that lags behind the
pressure by half a step on average, which looks like a lag of the actuator and follows no law.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from softid.errors import Issue
from softid.excitation import (
    SampleHold,
    find_hold,
    find_quantisation,
    fresh_samples,
    run_starts,
)
from softid.identification.intersample_choice import COMMAND
from softid.identification.sensor_clock import find_clock
from softid.intersample import is_abrupt
from softid.log import Log

Array = npt.NDArray[np.float64]

LEAST_FACTOR = 1.5
"""Samples for which a value is repeated at least: steps that somebody wanted, beside a course that
brings news at every sample, repeat as many values, but not each."""

MUCH_LONGER = 4.0
"""Runs of equal values so many times as long as the commonest are holds that somebody wanted."""

LEAST_READINGS = 4
"""So many readings between two jumps make a cubic."""

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
    channel = log.channels[log.input]
    if log.input == COMMAND or log.intersample is not None:
        return log
    hold = hold_of(log.time_s, channel.values)
    if hold is None:
        return log
    values = channel.values.copy()
    every_s = []
    for segment in log.segments():
        span = slice(segment.start, segment.stop)
        time_s = log.time_s[span]
        read_s, read = _readings(time_s, values[span], hold)
        values[span] = _course(time_s, read_s, read)
        every_s.append(read_s)
    issue = Issue(
        REPEATED_INPUT,
        "info",
        f"{log.name}: {log.input} repeats each value for about {hold.factor:.2g} samples (new "
        f"values at {hold.rate_hz:.3g} Hz); it is taken as smooth between the new ones, "
        "and as straight where it jumps",
        "record all channels at one rate; if it is a command, map it as pressure_command",
    )
    channels = dict(log.channels) | {log.input: replace(channel, values=values)}
    return replace(
        log,
        channels=channels,
        issues=(*log.issues, issue),
        input_read_s=np.concatenate(every_s),
    )


def _course(time_s: Array, read_s: Array, read: Array) -> Array:
    """The input at the samples of a log, from readings between which it moves on."""
    from scipy.interpolate import CubicSpline

    course: Array = np.interp(time_s, read_s, read)
    ends = np.flatnonzero(is_abrupt(read)) + 1
    for first, stop in pairwise((0, *ends.tolist(), read.size)):
        if stop - first >= LEAST_READINGS:
            smooth = CubicSpline(read_s[first:stop], read[first:stop])
            inside = (time_s >= read_s[first]) & (time_s <= read_s[stop - 1])
            course[inside] = smooth(time_s[inside])
    return course


def hold_of(time_s: Array, values: Array) -> SampleHold | None:
    """How a channel repeats what a slower sensor says; None for one that does not.

    Parameters
    ----------
    time_s, values
        Samples of the channel, each of shape (n,), none of them missing.
    """
    if not _repeats(values):
        return None
    grid = find_quantisation(values)
    hold = find_hold(time_s, values, grid.step if grid else None)
    return hold if hold is not None and hold.factor >= LEAST_FACTOR else None


def _repeats(values: Array) -> bool:
    """Whether runs of equal values are so long that a slower sensor may make them; soon told."""
    lengths = np.diff(run_starts(values))
    if lengths.size == 0:
        return False
    usual = int(np.argmax(np.bincount(lengths)))
    return float(np.mean(lengths[lengths <= MUCH_LONGER * usual])) >= LEAST_FACTOR


def _readings(time_s: Array, values: Array, hold: SampleHold) -> tuple[Array, Array]:
    """When the sensor was read, and what it said.

    A value that is first seen in one sample was read since the one before. Where all first sights
    allow readings at regular times, these are the latest such times; else it was read when it is
    first seen.
    """
    clock = find_clock(time_s, run_starts(values)[1:])
    if clock is not None:
        read_s = clock.readings_s(time_s[0], time_s[-1])
        at = np.searchsorted(time_s, read_s - clock.allowance_s)
        return read_s, values[at]
    fresh = fresh_samples(time_s, values, hold)
    return time_s[fresh], values[fresh]
