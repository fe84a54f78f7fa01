"""When a sensor with a clock of its own was read, from the rows of a log that first show it.

A camera of 30 frames a second in a log of 100 rows a second is seen late by nothing to a whole row,
in turn. That a row shows a reading says that it was taken since the row before; regular times are
known much better than that from all of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

SINGLE = 1.5
"""Intervals between readings up to so many times the usual one have no lost reading in them."""

EXCEPTIONS = 0.01
"""Share of the rows that may show a reading late: a logger is blocked now and then, and where a
reading equals the one before, its row is a guess."""

OWN_ROWS = 0.25
"""Median distance of the intervals before such rows from the log's own, as a share of it, from
which a sensor has rows of its own with the times of its readings, as merged files have them."""

CLOCK_TOLERANCE = 0.1
"""Share of a sampling interval by which the rounding of a log's times may contradict the clock."""


@dataclass(frozen=True)
class SensorClock:
    """Regular times of readings: ``first_s`` and whole periods after it, and before.

    Attributes
    ----------
    first_s
        Time of one reading.
    period_s
        Time between two readings.
    allowance_s
        How much earlier than its reading a row may be by the rounding of a log's times.
    """

    first_s: float
    period_s: float
    allowance_s: float

    def taken_s(self, time_s: Array, seen: IntArray) -> Array:
        """When the readings were taken that are first seen at some rows, shape (R,).

        Parameters
        ----------
        time_s
            Times of the log's rows, shape (n,).
        seen
            The rows, shape (R,), rising. What the clock contradicts is taken when it is seen.
        """
        seen_s = time_s[seen]
        number = np.floor((seen_s + self.allowance_s - self.first_s) / self.period_s)
        taken_s = np.minimum(self.first_s + self.period_s * number, seen_s)
        before_s = np.where(seen > 0, time_s[seen - 1], time_s[0] - self.period_s)
        return np.where(taken_s > before_s, taken_s, seen_s)

    def readings_s(self, start_s: float, stop_s: float) -> Array:
        """All times of readings that are not before ``start_s``, and before ``stop_s``."""
        before = np.floor((self.first_s - start_s) / self.period_s)
        return np.arange(self.first_s - before * self.period_s, stop_s, self.period_s)


def find_clock(time_s: Array, seen: IntArray) -> SensorClock | None:
    """The clock whose readings are first seen at these rows; None where no clock explains them.

    Of the times that do, it has the latest. What has rows of its own needs no clock.

    Parameters
    ----------
    time_s
        Times of the log's rows, shape (n,).
    seen
        Rows at which a reading is seen first, rising, none of them 0; readings may be lost.

    Examples
    --------
    A sensor that is read every 2.5 rows:

    >>> rows = np.ceil(2.5 * np.arange(1, 15)).astype(int)
    >>> find_clock(np.arange(40.0), rows).taken_s(np.arange(40.0), rows[:3]).round(1).tolist()
    [2.5, 5.0, 7.5]
    """
    if seen.size < 3:
        return None
    seen_s, before_s = time_s[seen], time_s[seen - 1]
    row_s = float(np.median(np.diff(time_s)))
    if float(np.median(np.abs(seen_s - before_s - row_s))) > OWN_ROWS * row_s:
        return None
    interval_s = np.diff(seen_s)
    single = interval_s <= SINGLE * np.median(interval_s)
    number = np.concatenate(([0.0], np.cumsum(np.round(interval_s / interval_s[single].mean()))))
    period_s = float(np.polyfit(number, 0.5 * (seen_s + before_s), 1)[0])
    latest_s = np.quantile(seen_s - period_s * number, EXCEPTIONS, method="lower")
    earliest_s = np.quantile(before_s - period_s * number, 1.0 - EXCEPTIONS, method="higher")
    allowance_s = CLOCK_TOLERANCE * row_s
    if earliest_s - latest_s > allowance_s:
        return None
    return SensorClock(float(latest_s), period_s, allowance_s)
