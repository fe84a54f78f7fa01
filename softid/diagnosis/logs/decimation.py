"""Logs that are sampled far faster than anything moves, averaged over a few samples each.

A linear motion passes an average on unchanged: averaged input in, averaged output out. A diagnosis
refits the logs a few hundred times, and gains nothing from the hundredth sample of a time constant.

What bends within a mean is not lost: between means the input counts as straight, whatever it did
between the old samples, and its new samples are those whose straight lines have the means of what
it did; an output's are its means without what its bend adds to them. A sine of f Hz under means
over T s then errs by (π f T)⁴ and no longer by (π f T)², which is more than the noise of many
samples.

A jump is no such course: a law that bends takes another force from its mean than from what is
before and after it. So it stays where it was, between knots of its own, and the means of the
outputs that hold it are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from softid.identification.slow_outputs import SlowOutputLog
from softid.intersample import BEFORE, HELD, Intersample, is_abrupt, jumps
from softid.log import Log
from softid.log_kinds import KnottedLog, fields_of
from softid.segment import absent_times

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

MOST_KEPT_SAMPLES = 6000
"""Up to so many samples in all logs together nothing is averaged."""

SAMPLES_PER_MOTION = 30.0
"""Samples that stay in a time constant of the motion at least: delays and lags of a few hundredths
of it still count in whole samples."""

LEAST_MEANS = 3
"""A slope is taken from the neighbours on both sides, so fewer means have none."""

MOST_JUMPS = 0.05
"""Jumps stay where they were up to this share of the means: a train of pulses is averaged."""

SAME_KNOT = 1e-6
"""Share of a sampling interval within which a knot is a sample."""

REGULAR = 0.2
"""Sampling is regular when no interval differs from the median by more than this share."""


def samples_to_average(
    logs: Sequence[Log],
    motion_s: float,
    *,
    enough: int = MOST_KEPT_SAMPLES,
    per_motion: float = SAMPLES_PER_MOTION,
) -> int:
    """Over how many samples the logs may be averaged; 1 for not at all.

    An input that was recorded between slow readings of the outputs would be lost in averages.

    Parameters
    ----------
    logs
        The logs.
    motion_s
        Time constant of the motion.
    enough
        Up to so many samples in all logs together nothing is averaged; of more, about so many
        averages are left, and of a few more half as many.
    per_motion
        So many averages are left in a time constant of the motion at least.
    """
    if not all(is_regular(log) and not isinstance(log, SlowOutputLog) for log in logs):
        return 1
    wanted = sum(len(log) for log in logs) / enough
    period_s = max(log.period_s for log in logs)
    return max(int(min(np.ceil(wanted), motion_s / per_motion / period_s)), 1)


def is_regular(log: Log) -> bool:
    """Whether a log is sampled at even times.

    Parameters
    ----------
    log
        A log.
    """
    return bool(np.all(np.abs(np.diff(log.time_s) / log.period_s - 1.0) <= REGULAR))


@dataclass(frozen=True, eq=False)
class AveragedLog(KnottedLog):
    """A log with a value from every few samples of another one in their place.

    Its input goes straight between its samples; ``intersample`` is that of ``recorded``.

    Attributes
    ----------
    recorded
        The log whose samples were averaged.
    count
        Samples in a value.
    knots
        When jumps of the input begin and end, and the input there; see `KnottedLog`.
    """

    recorded: Log = field(kw_only=True)
    count: int = field(kw_only=True)

    @property
    def between_samples(self) -> Intersample:
        """Straight: the samples of the input were made for that."""
        return "straight"

    @property
    def as_recorded(self) -> Log:
        """The log before averaging: the nodes of the averaged input overshoot its extremes.

        So ranges are read there.
        """
        return self.recorded

    def at_samples(self) -> Log:
        """The log before averaging with this intersample behaviour, its samples masked alike."""
        masked = self.marks_of_samples(self.masked, rest=True)
        return self.recorded.with_masked(masked).with_intersample(self.intersample)

    def marks_of_samples(self, marks: BoolArray, *, rest: bool) -> BoolArray:
        """Marks of values as those of the samples in them; ``rest`` for samples in none."""
        found = np.full(len(self.recorded), rest)
        found[: marks.size * self.count] = np.repeat(marks, self.count)
        return found


def decimated(log: Log, count: int) -> Log:
    """The log with a value from every ``count`` samples in their place.

    Jumps of the input stay where they were, and means of the outputs that hold one are left out.

    Parameters
    ----------
    log
        A regular log.
    count
        Samples in a value; the last ones that fill none are left out.

    Examples
    --------
    >>> channels = {"pressure": [1, 3, 5, 7], "angle": [0, 2, 2, 4]}
    >>> log = Log.from_arrays([0.0, 0.1, 0.2, 0.3], channels)
    >>> decimated(log, 2).channels["angle"].values
    array([1., 3.])
    """
    if count == 1:
        return log
    groups = len(log) // count

    def mean(values: Array) -> Array:
        averaged: Array = values[: groups * count].reshape(groups, count).mean(axis=1)
        return averaged

    time_s = mean(log.time_s)
    jumping = _Jumps.of(log, most=MOST_JUMPS * groups)
    masked = mean(jumping.is_in_one(log.time_s)) > 0.0
    masked |= mean(log.masked.astype(np.float64)) > 0.0
    channels = {}
    for name, channel in log.channels.items():
        if name == log.input:
            rest = channel.values - jumping.until(log.time_s)
            nodes = _straight(mean(_about_samples(rest, log.between_samples)))
            values = nodes + jumping.until(time_s)
        else:
            values = _at_centres(mean(channel.values), masked)
        channels[name] = replace(channel, values=values)
    knot_s = jumping.knots_beside(time_s)
    return AveragedLog(
        **fields_of(log) | {"time_s": time_s, "channels": channels, "masked": masked},
        recorded=log,
        count=count,
        knots=(knot_s, np.interp(knot_s, time_s, nodes) + jumping.until(knot_s)),
    )


@dataclass(frozen=True, eq=False)
class _Jumps:
    """Jumps of an input, each a straight line from ``begin_s`` to ``end_s``.

    ``heights`` holds how far they go; all are of shape (J,).
    """

    begin_s: Array
    end_s: Array
    heights: Array

    @classmethod
    def of(cls, log: Log, *, most: float) -> _Jumps:
        """Jumps of a log's input, none if there are more than ``most``; held ones are instant."""
        values, intersample = log.channels[log.input].values, log.between_samples
        read_s, read = log.time_s, values
        if log.input_read_s is not None:
            read_s, read = log.input_read_s, np.interp(log.input_read_s, log.time_s, values)
        at = np.flatnonzero(is_abrupt(read))
        at = at if at.size <= most else at[:0]
        begin_s, end_s = read_s[at], read_s[at + 1]
        if log.input_read_s is None:
            is_held = np.isin(at, jumps(values)) & (intersample == "held") | (intersample == "zoh")
            begin_s = np.where(is_held, end_s - BEFORE * (end_s - begin_s), begin_s)
        return cls(begin_s, end_s, np.diff(read)[at])

    def is_in_one(self, time_s: Array) -> Array:
        """1 from the last sample before each jump to the first one after it, else 0."""
        first = np.searchsorted(time_s, self.begin_s, side="right") - 1
        last = np.searchsorted(time_s, self.end_s)
        inside = np.zeros(time_s.size + 1)
        np.add.at(inside, first, 1.0)
        np.add.at(inside, last + 1, -1.0)
        inside_any: Array = np.minimum(np.cumsum(inside[:-1]), 1.0)
        return inside_any

    def until(self, time_s: Array) -> Array:
        """Sum of the heights of all jumps up to some times, in part for one under way there."""
        if self.heights.size == 0:
            return np.zeros(time_s.size)
        risen = np.cumsum(self.heights)
        ends = np.column_stack((self.begin_s, self.end_s)).ravel()
        return np.interp(time_s, ends, np.column_stack((risen - self.heights, risen)).ravel())

    def knots_beside(self, time_s: Array) -> Array:
        """Times at which jumps begin and end, in order, without those at given times."""
        knot_s = np.concatenate((self.begin_s, self.end_s))
        return absent_times(time_s, knot_s, SAME_KNOT * float(np.median(np.diff(time_s))))


def with_other_intersample(log: Log, intersample: Intersample) -> Log:
    """The log with another intersample behaviour of its input; one of averages is averaged anew.

    Parameters
    ----------
    log
        The log.
    intersample
        What the input does between its samples as they were recorded.
    """
    if not isinstance(log, AveragedLog):
        return replace(log, intersample=intersample)
    whole = replace(log.recorded, intersample=intersample)
    again = decimated(whole, log.count)
    assert isinstance(again, AveragedLog)
    channels = {**log.channels, log.input: again.channels[log.input]}
    return replace(log, channels=channels, intersample=intersample, knots=again.knots)


def _about_samples(values: Array, intersample: Intersample) -> Array:
    """Means of the input from half an interval before every sample to half an interval behind it.

    A held input has the value before until the sample. What goes straight or bends has the value of
    the sample but for what bends within an interval, which is far less than what does within all
    that are averaged; and so has a jump, since it takes from one sample what it gives to the next.
    """
    if intersample not in HELD:
        return values
    changes = jumps(values) if intersample == "held" else np.arange(values.size - 1)
    about = values.copy()
    about[changes + 1] = 0.5 * (values[changes] + values[changes + 1])
    return about


def _straight(means: Array) -> Array:
    """Nodes of a line whose mean about each, half way to its neighbours, is given.

    Solves (u₋ + 6 u + u₊)/8 = mean, with the line going straight on at both ends.
    """
    from scipy.linalg import solve_banded

    if means.size < LEAST_MEANS or not np.isfinite(means).all():
        return means
    bands = np.tile([[0.125], [0.75], [0.125]], means.size)
    bands[0, 1] = bands[2, -2] = 0.0
    bands[1, [0, -1]] = 1.0
    nodes: Array = solve_banded((1, 1), bands, means)
    return nodes


def _at_centres(means: Array, masked: BoolArray) -> Array:
    """Values at the centres of means: mean − T² ÿ/24, with ÿ from the means beside."""
    known = np.where(masked, np.nan, means)
    bend = np.zeros(means.size)
    bend[1:-1] = np.diff(known, 2)
    return means - np.where(np.isfinite(bend), bend, 0.0) / 24.0
