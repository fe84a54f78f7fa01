"""Numbers that begin again at the end of their range, put one behind the other.

A microcontroller counts its milliseconds in 16 or 32 bits, and an angle that is told within one
turn goes from its upper end to its lower one while the actuator bends on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from softid.channels import Channel
from softid.errors import Issue
from softid.readers.base import Array, IntArray
from softid.readers.samples import Samples

COUNTER_BITS = (16, 32)
"""Widths of the counters that programs keep times in."""

LONGEST_STEP = 10.0
"""Over the end of its range a counter moves by so many usual steps at most: a log that was begun
anew rather stops anywhere."""

TURN_RAD = 2.0 * np.pi

NEARLY_A_TURN = 0.9
"""Share of a turn that an angle jumps at least where it begins again."""

SMOOTH = 0.1
"""Share of a turn that a wrapped angle moves at most from sample to sample elsewhere: what jumps so
far by itself is no motion."""


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
            return _shifted(counts, known, at, np.full(at.size, 2.0**bits))
    return unchanged


def turned_on(angle_rad: Array) -> Unwrapped:
    """Angles that go on where they passed the end of a turn.

    Parameters
    ----------
    angle_rad
        Angles in order of time, shape (n,); NaN where nothing was recorded.
    """
    known = np.flatnonzero(np.isfinite(angle_rad))
    steps = np.diff(angle_rad[known])
    at = np.flatnonzero(np.abs(steps) > NEARLY_A_TURN * TURN_RAD)
    unchanged = Unwrapped(angle_rad, np.empty(0, np.int64))
    if at.size == 0 or np.ptp(angle_rad[known]) > TURN_RAD:
        return unchanged
    found = _shifted(angle_rad, known, at, -np.sign(steps[at]) * TURN_RAD)
    moves = np.abs(np.diff(found.values[known]))
    return found if moves.max() <= SMOOTH * TURN_RAD else unchanged


def with_angles_turned_on(samples: Samples) -> Samples:
    """The samples with angles that go on where they passed the end of a turn, and say so.

    Parameters
    ----------
    samples
        Samples in order of time.
    """
    channels: dict[str, Channel] = {}
    issues = []
    for name, channel in samples.channels.items():
        found = turned_on(channel.values) if channel.unit == "rad" else None
        if found is None or found.at.size == 0:
            continue
        channels[name] = replace(channel, values=found.values)
        turn = TURN_RAD * channel.display_factor
        issues.append(
            Issue(
                "wrapped-angle",
                "info",
                f"{samples.column(name)}: the {name} jumps by a turn, {turn:.4g} "
                f"{channel.display_unit}, {found.how_often}, the first in "
                f"{samples.row(int(found.at[0]))}; it is taken to go on",
                "choose the zero of the sensor so that no motion passes the end of its range",
            )
        )
    joined: Mapping[str, Channel] = {**samples.channels, **channels}
    return replace(samples, channels=joined, issues=(*samples.issues, *issues))


def _shifted(values: Array, known: IntArray, at: IntArray, by: Array) -> Unwrapped:
    """The values with all behind each place moved by so much more."""
    first = known[at + 1]
    steps = np.zeros(values.size)
    steps[first] = by
    return Unwrapped(values + np.cumsum(steps), first)
