"""The time axis: seconds from numbers in any unit, epochs, dates or times of day."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, field

import numpy as np

from softid.errors import InputError, Issue
from softid.readers.base import Array, Table
from softid.readers.overflow import Unwrapped, counted_on
from softid.units import factor_to_canonical

PLAUSIBLE_PERIOD_S = (1e-4, 2.0)
"""Seconds with a median step outside this range are doubted: 5 "s" is more often 5 ms.

A log sampled once a second passes. A time without unit is refused, since nobody vouched for it. A
unit that the file states is only questioned, for slow logs of creep exist.
"""

LONG_LOG_S = 4 * 3600.0
"""A log with a step of a second or more is doubted beyond this length: 1 kHz counted in ms."""

SHORTEST_PERIOD_S = 1e-7
"""No actuator is sampled quicker than at 10 MHz, whoever vouches for the unit."""

TIME_UNITS = ("ms", "us", "ns", "s", "h", "min")
"""Units to propose, the first one in which the median step is plausible."""

EPOCH_MIN_S = 1e8
"""Seconds above this count from 1970; they are shifted to the first sample to keep precision."""

LATEST_S = 1e11
"""No log lies further from its clock's zero than that, some 3000 years."""


@dataclass(frozen=True, eq=False)
class TimeAxis:
    """Sample times before any cleaning.

    Attributes
    ----------
    seconds
        Times, shape (n,); NaN where a cell is empty.
    metadata
        Start of the recording, where the file tells it.
    issues
        Doubt about the unit, and what was repaired.
    """

    seconds: Array
    metadata: dict[str, str] = field(default_factory=dict)
    issues: tuple[Issue, ...] = ()


def read_times(
    table: Table,
    index: int,
    unit: str | None,
    *,
    scale: float = 1.0,
    confirmed: bool = False,
) -> TimeAxis:
    """Turn the time column into seconds.

    Parameters
    ----------
    table
        The file's table.
    index
        Its time column.
    unit
        Unit of the numbers as stated by the user, the header or a unit row; None when nobody says.
    scale
        Number of units of one count.
    confirmed
        Whether the user vouches for the unit, so that it is not questioned.

    Raises
    ------
    InputError
        A cell is neither a number nor a time, the unit is not stated and seconds would be
        implausible, or no recorder is as quick as the unit makes it.
    """
    stamps = table.timestamps(index)
    if stamps is not None:
        return TimeAxis(stamps.seconds, {"start": stamps.start})
    counted = counted_on(table.numbers(index))
    counts = counted.values
    where = table.place(index)
    factor = scale * (factor_to_canonical(unit, "time", where=where) if unit else 1.0)
    with np.errstate(over="ignore", invalid="ignore"):
        seconds = np.where(np.isfinite(counts), counts * factor, np.nan)
    valid = seconds[np.isfinite(seconds)]
    if valid.size and np.max(np.abs(valid)) > LATEST_S:
        raise InputError(
            f"in {unit or 's'} the time would be more than {LATEST_S:g} s from its zero",
            where=where,
            value=float(counts[np.nanargmax(np.abs(seconds))]),
            remedy=f"state the unit with {_time_flag(table, index, counts)}",
        )
    if unit is None:
        _require_plausible(counts, table, index)
    else:
        _require_possible(seconds, counts, table, index, unit)
    issues = () if confirmed else _unit_questioned(valid, counts, table, index, unit)
    issues = (*_overflows(counted, table, index), *issues)
    if valid.size and valid[0] > EPOCH_MIN_S:
        start = {"start_epoch_s": repr(float(valid[0]))}
        return TimeAxis(_since_first(counts, factor), start, issues)
    return TimeAxis(seconds, issues=issues)


def _overflows(counted: Unwrapped, table: Table, index: int) -> tuple[Issue, ...]:
    if counted.at.size == 0:
        return ()
    first = int(counted.at[0])
    return (
        Issue(
            "counter-overflow",
            "info",
            f"{table.place(index, first)}: the counter of the time began again at the end of its "
            f"range, {counted.how_often}; the time is taken to go on",
            "keep the time in a wider number",
        ),
    )


def _since_first(counts: Array, factor: float) -> Array:
    finite = counts[np.isfinite(counts)]
    return np.where(np.isfinite(counts), (counts - finite[0]) * factor, np.nan)


def _median_step(values: Array) -> float | None:
    with np.errstate(over="ignore"):
        steps = np.diff(values[np.isfinite(values)])
    steps = steps[steps > 0]
    return float(np.median(steps)) if steps.size else None


def _require_plausible(counts: Array, table: Table, index: int) -> None:
    period = _median_step(counts)
    shortest, longest = PLAUSIBLE_PERIOD_S
    if period is not None and not shortest <= period <= longest:
        raise InputError(
            "the time has no unit, and as seconds its median step would be implausible",
            where=table.place(index),
            value=float(f"{period:.6g}"),
            remedy=f"state the unit with {_time_flag(table, index, counts)}",
        )


def _require_possible(seconds: Array, counts: Array, table: Table, index: int, unit: str) -> None:
    period = _median_step(seconds)
    if period is not None and period < SHORTEST_PERIOD_S:
        raise InputError(
            f"in {unit} the median step of the time would be {period:.3g} s, which no recorder of "
            "an actuator reaches",
            where=table.place(index),
            value=float(f"{_median_step(counts) or 0.0:.6g}"),
            remedy=f"state the unit with {_time_flag(table, index, counts)}",
        )


def _unit_questioned(
    seconds: Array, counts: Array, table: Table, index: int, unit: str | None
) -> tuple[Issue, ...]:
    """A warning where the sampling would be odd for an actuator's log."""
    period = _median_step(seconds)
    if period is None:
        return ()
    shortest, longest = PLAUSIBLE_PERIOD_S
    length_s = float(seconds.max() - seconds.min())
    slow = period > longest or (period >= 1.0 and length_s > LONG_LOG_S)
    if not slow and period >= shortest:
        return ()
    stated = unit or "s"
    lasting = f", the log {length_s / 3600.0:.3g} hours long" if length_s > 3600.0 else ""
    better = _plausible_unit(counts) or ("ms" if slow else "s")
    return (
        Issue(
            "time-unit-doubtful",
            "warning",
            f"{table.place(index)}: in {stated} the median step of the time is {period:.4g} s"
            f"{lasting}; is {stated} its unit?",
            f"state the unit, as in {channel_flag('time', table, index, better)}, or confirm "
            f"{stated} in the same way",
        ),
    )


def _time_flag(table: Table, index: int, counts: Array) -> str:
    return channel_flag("time", table, index, _plausible_unit(counts) or "ms")


def _plausible_unit(counts: Array) -> str | None:
    """A unit in which the steps of a clock are those of an actuator's log."""
    period = _median_step(counts)
    if period is None:
        return None
    shortest, longest = PLAUSIBLE_PERIOD_S
    for unit in TIME_UNITS:
        if shortest <= period * factor_to_canonical(unit, "time") <= longest:
            return unit
    return None


def channel_flag(channel: str, table: Table, index: int, unit: str | None) -> str:
    """The option that maps a column to a channel, as one would type it."""
    names = table.head.names
    name = names[index]
    plain = table.head.headed and name and names.count(name) == 1
    column = name if plain else str(index + 1)
    return f"--channel {shlex.quote(f'{channel}={column}' + (f':{unit}' if unit else ''))}"
