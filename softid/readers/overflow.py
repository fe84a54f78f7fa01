"""Counts of a clock that begin again at the end of their range, put one behind the other.

A microcontroller counts its milliseconds in 16 or 32 bits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from softid.readers.base import Array, IntArray

COUNTER_BITS = (16, 32)
"""Widths of the counters that programs keep times in."""

LONGEST_STEP = 10.0
"""Over the end of its range a counter moves by so many usual steps at most: a log that was begun
anew rather stops anywhere."""


@dataclass(frozen=True, eq=False)
class Unwrapped:
    """Numbers that go on where they began again.

    Attributes
    ----------
    values
        Shape (n,); NaN where they were.
    at
        Which of them were the first behind the end of the range, shape (m,).
    """

    values: Array
    at: IntArray

    @property
    def how_often(self) -> str:
        """In words."""
        return "once" if self.at.size == 1 else f"{self.at.size} times"


def counted_on(counts: Array) -> Unwrapped:
    """Counts of a clock that go on where its counter overflowed.

    Parameters
    ----------
    counts
        Whole numbers in order of time, shape (n,); NaN where a cell is empty.

    Examples
    --------
    >>> counted_on(np.array([65480.0, 65500.0, 65520.0, 4.0, 24.0])).values.tolist()
    [65480.0, 65500.0, 65520.0, 65540.0, 65560.0]
    """
    known = np.flatnonzero(np.isfinite(counts))
    steps = np.diff(counts[known])
    at = np.flatnonzero(steps < 0.0)
    unchanged = Unwrapped(counts, np.empty(0, np.int64))
    if at.size == 0 or counts[known].min() < 0.0 or np.any(counts[known] % 1.0 != 0.0):
        return unchanged
    usual = float(np.median(steps))
    for bits in COUNTER_BITS:
        over = steps[at] + 2.0**bits
        is_counter = counts[known].max() < 2.0**bits and np.all(over > 0.0)
        if is_counter and np.all(over <= LONGEST_STEP * usual):
            return shifted(counts, known, at, np.full(at.size, 2.0**bits))
    return unchanged


def shifted(values: Array, known: IntArray, at: IntArray, by: Array) -> Unwrapped:
    """The values with all behind each place moved by so much more.

    Parameters
    ----------
    values
        Shape (n,).
    known
        Which of them are no NaN, shape (k,).
    at
        Places in ``known`` before which the range ends, shape (m,).
    by
        By how much what comes behind moves, shape (m,).
    """
    first = known[at + 1]
    steps = np.zeros(values.size)
    steps[first] = by
    return Unwrapped(values + np.cumsum(steps), first)
