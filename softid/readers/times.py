"""The time axis: seconds from numbers in any unit, epochs, dates or times of day."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, field

import numpy as np

from softid.errors import InputError
from softid.readers.base import Array, Table
from softid.units import factor_to_canonical

PLAUSIBLE_PERIOD_S = (1e-4, 10.0)
"""A time without unit is in seconds if its median step lies in this range; else softid asks."""

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
    """

    seconds: Array
    metadata: dict[str, str] = field(default_factory=dict)


def read_times(table: Table, index: int, unit: str | None, *, scale: float = 1.0) -> TimeAxis:
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

    Raises
    ------
    InputError
        A cell is neither a number nor a time, or the unit is not stated and seconds would be
        implausible.
    """
    stamps = table.timestamps(index)
    if stamps is not None:
        return TimeAxis(stamps.seconds, {"start": stamps.start})
    counts = table.numbers(index)
    where = table.place(index)
    factor = scale * (factor_to_canonical(unit, "time", where=where) if unit else 1.0)
    if unit is None:
        _require_plausible(counts, table, index)
    with np.errstate(over="ignore", invalid="ignore"):
        seconds = np.where(np.isfinite(counts), counts * factor, np.nan)
    valid = seconds[np.isfinite(seconds)]
    if valid.size and np.max(np.abs(valid)) > LATEST_S:
        raise InputError(
            f"in {unit or 's'} the time would be more than {LATEST_S:g} s from its zero",
            where=where,
            value=float(counts[np.nanargmax(np.abs(seconds))]),
            remedy=f"state the unit with {_time_flag(table, index)}",
        )
    if valid.size and valid[0] > EPOCH_MIN_S:
        return TimeAxis(_since_first(counts, factor), {"start_epoch_s": repr(float(valid[0]))})
    return TimeAxis(seconds)


def _since_first(counts: Array, factor: float) -> Array:
    finite = counts[np.isfinite(counts)]
    return np.where(np.isfinite(counts), (counts - finite[0]) * factor, np.nan)


def _require_plausible(counts: Array, table: Table, index: int) -> None:
    finite = counts[np.isfinite(counts)]
    with np.errstate(over="ignore"):
        steps = np.diff(finite)
    steps = steps[steps > 0]
    if not steps.size:
        return
    period = float(np.median(steps))
    shortest, longest = PLAUSIBLE_PERIOD_S
    if not shortest <= period <= longest:
        raise InputError(
            "the time has no unit, and as seconds its median step would be implausible",
            where=table.place(index),
            value=period,
            remedy=f"state the unit with {_time_flag(table, index)}",
        )


def _time_flag(table: Table, index: int) -> str:
    return channel_flag("time", table, index, "ms")


def channel_flag(channel: str, table: Table, index: int, unit: str | None) -> str:
    """The option that maps a column to a channel, as one would type it."""
    names = table.head.names
    name = names[index]
    plain = table.head.headed and name and names.count(name) == 1
    column = name if plain else str(index + 1)
    return f"--channel {shlex.quote(f'{channel}={column}' + (f':{unit}' if unit else ''))}"
