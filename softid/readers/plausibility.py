"""Numbers that no sensor gives and units that do not fit them, told with the cell to look at."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softid.channels import Channel
from softid.errors import InputError, Issue
from softid.readers.base import Array, Table
from softid.readers.ranges import find_doubt
from softid.readers.times import channel_flag
from softid.units import unit_symbol

LARGEST_NUMBER = 1e100
"""A larger number is an overflow of whatever wrote it, and counts as not recorded."""

FAR = 3.0
"""Least size of a mark for "nothing recorded", in times the largest of all other values."""

LEAST_OTHERS = 10
"""Fewest different values beside a mark for "nothing recorded"."""


def finite(values: Array) -> Array:
    """The same values with NaN in place of infinities and of numbers that are no measurement."""
    return np.where(np.abs(values) <= LARGEST_NUMBER, values, np.nan)


def unit_doubt(table: Table, channel: Channel, index: int) -> InputError | None:
    """The question to ask where a channel's values do not fit its unit; None where they do."""
    doubt = find_doubt(channel)
    if doubt is None:
        return None
    mark = _mark_of_nothing(table, channel, index)
    if mark is not None:
        return mark
    shown = channel.display_unit
    flag = channel_flag(channel.name, table, index, doubt.better)
    if unit_symbol(doubt.better) == shown:  # no other unit would make them plausible
        remedy = f"confirm {shown} with {flag}, or map another column in the same way"
    else:
        remedy = f"state the unit, as in {flag}, or confirm {shown} in the same way"
    return InputError(
        doubt.what,
        where=table.place(index),
        value=doubt.value,
        remedy=remedy,
    )


def not_measured(table: Table, index: int, values: Array) -> list[Issue]:
    """A warning of numbers that no sensor gives; empty cells and NaN are told elsewhere."""
    beyond = np.flatnonzero(np.abs(values) > LARGEST_NUMBER)
    if not beyond.size:
        return []
    first = int(beyond[0])
    many = beyond.size > 1
    return [
        Issue(
            "not-a-measurement",
            "warning",
            f"{table.place(index, first)}: {beyond.size} "
            f"{'numbers are' if many else 'number is'} infinite or beyond {LARGEST_NUMBER:g} "
            f"({'the first ' if many else ''}{values[first]:g}) and "
            f"{'count' if many else 'counts'} as not recorded",
            "find out what wrote it, or leave the cell empty",
        )
    ]


def _mark_of_nothing(table: Table, channel: Channel, index: int) -> InputError | None:
    """What to say where one repeated value, such as -999, is all that makes the rest doubtful."""
    values = channel.values
    worst = int(np.nanargmax(np.abs(values)))
    same = values == values[worst]
    kept = np.where(same, np.nan, values)
    others = kept[np.isfinite(kept)]
    if np.count_nonzero(same) < 2 or np.unique(others).size < LEAST_OTHERS:
        return None  # the level of a step is repeated too
    if abs(float(values[worst])) < FAR * float(np.abs(others).max()):
        return None
    if find_doubt(replace(channel, values=kept)) is not None:
        return None
    first = int(np.flatnonzero(same)[0])
    shown = channel.display_unit
    flag = channel_flag(channel.name, table, index, shown)
    return InputError(
        f"one value stands in {np.count_nonzero(same)} rows, far from all others; does it mean "
        "that nothing was recorded?",
        where=table.place(index, first),
        value=float(f"{table.numbers(index)[first]:.12g}"),
        remedy=f"leave these cells empty if so, or confirm {shown} with {flag}",
    )
