"""Logs whose outputs are read more slowly than their input, such as a camera beside a gauge.

Most of their rows hold no reading of an output. What looks at residuals in turn, noise and averages
alike, would find single ones with gaps between them; so the readings are the samples here, and the
input goes on between them as it was recorded. A reading is seen in a row after it was taken; where
the sensor has a clock of its own, it counts from when it was taken.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from softid.channels import Channel
from softid.identification.interpolated_output import RECOVERED, recovered_readings
from softid.identification.sensor_clock import find_clock
from softid.log import Log
from softid.log_kinds import fields_of
from softid.readers.merging import MERGED_ROWS
from softid.segment import Segment, absent_times, with_knots, with_rows

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.intp]

SAME_ROW = 1e-6
"""Share of a sampling interval within which two rows are one."""

SLOW_SHARE = 0.5
"""An output is slow where more than this share of its readings follow each other with rows between
them; where samples were lost most readings have none."""


@dataclass(frozen=True, eq=False)
class SlowOutputLog(Log):
    """The readings that another log has of its outputs, where these are slower than its rows.

    Attributes
    ----------
    recorded
        The other one, whose input is the course at the samples and between them.
    """

    recorded: Log = field(kw_only=True)

    @property
    def as_recorded(self) -> Log:
        """The log with all its rows: the input has extremes between the output samples."""
        return self.recorded

    def at_samples_alone(self) -> Log:
        """The samples as a plain log, between which the input is straight."""
        return Log(**fields_of(self) | {"input_read_s": None})

    def _segment(self, index: int, start: int, stop: int) -> Segment:
        samples = self._rows(index, start, stop)
        first_s, last_s = samples.time_s[0], samples.time_s[-1]
        rows_s = self.recorded.time_s
        first = max(int(np.searchsorted(rows_s, first_s, "right")) - 1, 0)
        whole = with_knots(
            self.recorded._rows(index, first, int(np.searchsorted(rows_s, last_s)) + 1),
            self.between_samples,
        )
        at_samples = np.interp(samples.time_s, whole.time_s, whole.input)
        within_s = whole.time_s[(whole.time_s > first_s) & (whole.time_s < last_s)]
        between_s = absent_times(samples.time_s, within_s, SAME_ROW * self.recorded.period_s)
        return with_rows(
            replace(samples, input=at_samples),
            between_s,
            np.interp(between_s, whole.time_s, whole.input),
        )


def at_readings(log: Log) -> Log:
    """The log at the times at which an output was read; itself where that is at nearly all rows.

    Parameters
    ----------
    log
        A log; what is masked counts as not read.

    Examples
    --------
    >>> angle = [0.0, np.nan, 2.0, np.nan, 4.0, np.nan, 6.0]
    >>> log = Log.from_arrays(range(7), {"pressure": [0, 1, 2, 3, 9, 3, 2], "angle": angle})
    >>> slow = at_readings(log)
    >>> slow.time_s.tolist(), slow.segments()[0].input.tolist()
    ([0.0, 2.0, 4.0, 6.0], [0.0, 1.0, 2.0, 3.0, 9.0, 3.0, 2.0])
    """
    if any(issue.code == RECOVERED for issue in log.issues):
        readings = recovered_readings(log)
        if readings is not None:
            return _before_interpolation(log, *readings)
    read = _is_read(log)
    count = int(np.count_nonzero(read))
    if count < 2 or len(log) - count <= SLOW_SHARE * (count - 1):
        return log  # there are no more gaps than rows at which nothing was read
    rows = np.flatnonzero(read)
    if float(np.mean(np.diff(rows) > 1)) <= SLOW_SHARE:
        return log
    rows, time_s = _taken(log, rows)
    channels = {k: replace(c, values=c.values[rows]) for k, c in log.channels.items()}
    return _with_readings(log, time_s, channels, log.masked[rows])


def _before_interpolation(log: Log, taken_s: Array, readings: Mapping[str, Array]) -> Log:
    """The readings that the log was interpolated from; none where it counts no sample nearby."""
    channels = {
        name: replace(
            channel,
            values=readings[name]
            if name in readings
            else np.interp(taken_s, log.time_s, channel.values),
        )
        for name, channel in log.channels.items()
    }
    counts = log.time_s[~log.masked]
    after = np.searchsorted(counts, taken_s).clip(1, counts.size - 1)
    apart_s = np.minimum(np.abs(taken_s - counts[after - 1]), np.abs(counts[after] - taken_s))
    return _with_readings(log, taken_s, channels, apart_s > float(np.median(np.diff(taken_s))))


def _with_readings(
    log: Log, taken_s: Array, channels: Mapping[str, Channel], masked: BoolArray
) -> SlowOutputLog:
    """Channels at the times of readings, with the course of the input at and between them."""
    course = np.interp(taken_s, log.time_s, log.channels[log.input].values)
    changed = {
        "time_s": taken_s,
        "channels": {**channels, log.input: replace(channels[log.input], values=course)},
        "masked": masked,
        "input_read_s": log.time_s if log.input_read_s is None else log.input_read_s,
    }
    return SlowOutputLog(**fields_of(log) | changed, recorded=log)


def _is_read(log: Log) -> BoolArray:
    """At which rows an output counts, shape (n,)."""
    finite = [np.isfinite(log.channels[name].values) for name in log.outputs]
    read: BoolArray = ~log.masked & np.any(finite, axis=0)
    return read


def _taken(log: Log, rows: IntArray) -> tuple[IntArray, Array]:
    """The rows whose readings were taken within the log, and when.

    Rows of a recorder of its own have the times of its readings, to the digit that the file has.
    """
    time_s = log.time_s
    seen_s = time_s[rows]
    has_own_rows = any(issue.code == MERGED_ROWS for issue in log.issues)
    clock = None if has_own_rows else find_clock(time_s, rows[1:] if rows[0] == 0 else rows)
    if clock is None:
        return rows, seen_s
    taken_s = clock.taken_s(time_s, rows)
    if float(np.max(seen_s - taken_s)) <= clock.allowance_s:
        return rows, seen_s
    within = taken_s >= time_s[0]
    return rows[within], taken_s[within]
