"""From columns to channels: by the user's word, by the sidecar, by name."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from softid.channels import Channel, make_channel
from softid.errors import InputError, Issue
from softid.readers.base import Table, first_names
from softid.readers.columns import (
    best_matches,
    bracketed_text,
    is_index_name,
    read_name,
    signal_unit,
)
from softid.readers.plausibility import finite, not_measured, unit_doubt
from softid.readers.sidecar import Sidecar
from softid.readers.signals import of_signal, require_unit_of, unit_example
from softid.readers.times import TimeAxis, channel_flag, read_times
from softid.readers.wishes import Wish, asked_channels
from softid.units import (
    CHANNEL_QUANTITY,
    lookup_unit,
    unit_symbol,
)


@dataclass(frozen=True, eq=False)
class Found:
    """What the columns turned out to be.

    Attributes
    ----------
    times
        The time axis.
    channels
        Channel name → channel, known and raw.
    problems
        Known channels that could not be settled, with the error to raise if one is needed.
    columns
        Column name → channel name.
    issues
        What was left out and why.
    """

    times: TimeAxis
    channels: Mapping[str, Channel]
    problems: Mapping[str, InputError]
    columns: Mapping[str, str]
    issues: tuple[Issue, ...]


def find_channels(
    table: Table,
    *,
    flags: Mapping[str, str],
    sidecar: Sidecar,
    time_unit: str | None,
    needed: Collection[str],
) -> Found:
    """Settle which column is which channel: flags beat the sidecar, the sidecar beats names.

    Parameters
    ----------
    table
        The file's table.
    flags
        Channel name → ``"COLUMN[:UNIT]"``.
    sidecar
        What the sidecar says.
    time_unit
        Unit of the time column, or None.
    needed
        Channel or column names that a role asks for.

    Raises
    ------
    UsageError
        A flag names a column that is not there, a unit that is none or a misspelt channel.
    InputError
        The sidecar names such, the time cannot be settled, or a channel that was asked for by flag
        or sidecar cannot be read.
    """
    wishes = asked_channels(table, flags, sidecar, needed)
    asked = {wish.index for wish in wishes.values()}
    free = [k for k in range(len(table.head.names)) if k not in asked and not _is_index(table, k)]
    matches = best_matches(table.head.names, free) if table.head.headed else {}
    problems = {k: v for k, v in _unaligned(table).items() if k not in wishes and k not in matches}
    if "time" in problems:
        raise problems["time"]
    time = wishes.pop("time", None) or Wish(_time_column(table, matches, free), None)
    free = [k for k in free if k != time.index]
    told: list[Issue] = []
    channels = {name: _wished_channel(table, name, wish, told) for name, wish in wishes.items()}
    for name, columns in matches.items():
        if name in channels or name == "time":
            continue
        named = _named_channel(table, name, columns, told)
        if isinstance(named, InputError):
            problems[name] = named
        else:
            channels[name] = named
            free.remove(columns[0])
    issues = [*told, *(_left_raw(name, problem, table) for name, problem in problems.items())]
    if table.only_on_request:
        free = [k for k in free if table.head.names[k] in needed]
    _add_raw(table, free, channels, issues)
    columns_of = {c.column: name for name, c in channels.items() if c.column is not None}
    times = _times(table, time, time_unit)
    return Found(times, channels, problems, columns_of, (*issues, *times.issues))


def _unaligned(table: Table) -> dict[str, InputError]:
    """Channels whose arrays could not be lined up with the others."""
    names = list(table.head.unaligned)
    return {
        channel: table.head.unaligned[names[indices[0]]]
        for channel, indices in best_matches(names, range(len(names))).items()
    }


def _is_index(table: Table, index: int) -> bool:
    """Whether a column only counts the rows."""
    if index > 0 or not table.head.headed or not is_index_name(table.head.names[index]):
        return False
    try:
        values = table.numbers(index)
    except InputError:
        return False
    return values.size > 1 and bool(np.all(np.diff(values) == 1.0))


def _time_column(table: Table, matches: Mapping[str, tuple[int, ...]], free: Iterable[int]) -> int:
    candidates = matches.get("time", ())
    if not candidates:
        candidates = tuple(k for k in free if _holds_times(table, k))
    if len(candidates) == 1:
        return candidates[0]
    head = table.head
    if candidates:
        raise _ambiguous(table, "time", candidates)
    for unclear in map(table.unclear_date, free):
        if unclear is not None:
            raise unclear
    named = f" ({first_names(head.names)})" if head.headed else f" among the {len(head.names)}"
    raise InputError(
        f"no time column is recognised{named}" + ("" if head.headed else ", which have no names"),
        where=head.path,
        remedy="name it with --channel time=COLUMN:s, COLUMN being a name or a number from 1",
    )


def _holds_times(table: Table, index: int) -> bool:
    try:
        return table.timestamps(index) is not None
    except InputError:
        return False


def _times(table: Table, wish: Wish, time_unit: str | None) -> TimeAxis:
    confirmed = time_unit or wish.unit
    unit = confirmed or stated_unit(table, wish.index)
    is_sure = bool(confirmed) or table.is_timed_in_s
    return read_times(table, wish.index, unit, scale=wish.scale, confirmed=is_sure)


def stated_unit(table: Table, index: int) -> str | None:
    """The unit that a unit row or the column's name states.

    Raises
    ------
    InputError
        They state different units.
    """
    in_row = table.head.units[index]
    in_name = read_name(table.head.names[index]).unit if table.head.headed else None
    if in_row and in_name and unit_symbol(in_row) != unit_symbol(in_name):
        raise InputError(
            f"the name says {in_name}, but the row of units says {in_row}",
            where=table.place(index),
            remedy="correct one of them, or state the unit with --channel",
        )
    return in_row or in_name


def _wished_channel(table: Table, name: str, wish: Wish, told: list[Issue]) -> Channel:
    quantity = CHANNEL_QUANTITY.get(name)
    unit = wish.unit or stated_unit(table, wish.index)
    if quantity is not None and unit is None:
        raise _unitless(table, name, wish.index)
    channel = _channel(table, name, wish.index, unit, wish.scale, told)
    if wish.unit is None and quantity is not None:
        doubt = unit_doubt(table, channel, wish.index)
        if doubt is not None:
            raise doubt
    told += _contradictions(table, name, wish)
    return channel


def _contradictions(table: Table, name: str, wish: Wish) -> list[Issue]:
    """That the unit somebody gave is not the one that the file states for the column."""
    try:
        stated = stated_unit(table, wish.index)
    except InputError:  # the file contradicts itself, and the user decides
        return []
    in_file, given = lookup_unit(stated or ""), lookup_unit(wish.unit or "")
    if in_file is None or given is None or abs(wish.scale) != 1.0:
        return []
    if in_file.quantity != given.quantity or in_file.factor == given.factor:
        return []
    return [
        Issue(
            "unit-contradiction",
            "warning",
            f"{table.place(wish.index)}: the {name} is taken in {unit_symbol(given.text)}, as "
            f"given, while the file says {unit_symbol(in_file.text)}",
            "leave the unit out if the file is right",
        )
    ]


def _named_channel(
    table: Table, name: str, columns: tuple[int, ...], told: list[Issue]
) -> Channel | InputError:
    if len(columns) > 1:
        return _ambiguous(table, name, columns)
    index = columns[0]
    try:
        unit = stated_unit(table, index)
        if unit is None:
            return _unitless(table, name, index)
        channel = _channel(table, name, index, unit, 1.0, told)
    except InputError as error:
        return error
    return unit_doubt(table, channel, index) or channel


def _channel(
    table: Table, name: str, index: int, unit: str | None, scale: float, told: list[Issue]
) -> Channel:
    quantity = CHANNEL_QUANTITY.get(name, "raw")
    symbol = unit_symbol(unit) if unit else None
    if symbol and quantity != "raw":
        require_unit_of(name, symbol, table, index, where=table.place(index))
    numbers = table.numbers(index)
    told += not_measured(table, index, numbers)
    values = finite(numbers) * scale
    return make_channel(name, values, symbol, column=table.head.names[index] or str(index + 1))


def _add_raw(
    table: Table, free: Iterable[int], channels: dict[str, Channel], issues: list[Issue]
) -> None:
    for index in free:
        name = table.head.names[index] or f"col{index + 1}"
        if name in channels or name in CHANNEL_QUANTITY:
            name = f"{name}_col{index + 1}"
        unit = _raw_unit(table, index)
        try:
            values = finite(table.numbers(index))
        except InputError as error:
            issues.append(_left_out(error))
            continue
        channels[name] = make_channel(name, values, unit, column=table.head.names[index] or name)


def _left_out(error: InputError) -> Issue:
    seen = "" if error.value is None else f" (got {error.value!r})"
    return Issue(
        "column-left-out",
        "info",
        f"{error.where}: {error.what}{seen}, so the column was left out",
        "no action is needed, unless it is a channel",
    )


def _raw_unit(table: Table, index: int) -> str | None:
    try:
        unit = stated_unit(table, index)
    except InputError:
        unit = table.head.units[index]
    return unit_symbol(unit) if unit else None


def _left_raw(name: str, problem: InputError, table: Table) -> Issue:
    lost = problem in table.head.unaligned.values()  # it is in the file, and nothing else is it
    return Issue(
        "channel-not-settled",
        "warning" if lost else "info",
        f"{problem.where}: {problem.what}, so no column was taken as {name}",
        problem.remedy,
    )


def _ambiguous(table: Table, name: str, columns: tuple[int, ...]) -> InputError:
    names = table.head.names
    shown = [
        f"{names[k]} (column {k + 1})" if names.count(names[k]) > 1 else names[k] for k in columns
    ]
    unit = table.head.units[columns[0]] or read_name(names[columns[0]]).unit
    example = unit_symbol(unit) if unit else unit_example(name, table)
    remedy = f"choose one, as in {channel_flag(name, table, columns[0], example)}"
    return InputError(
        f"{len(columns)} columns look like {name}: {', '.join(shown)}",
        where=table.head.path,
        remedy=remedy if unit else f"{remedy}{_or_as_angle(name, table, columns[0])}",
    )


def _or_as_angle(name: str, table: Table, index: int) -> str:
    """What else a position may be where the format calls the turn of a joint one."""
    if name != "position" or "angle" not in table.usual_units:
        return ""
    return f", or {channel_flag('angle', table, index, table.usual_units['angle'])} if it turns"


def _unitless(table: Table, name: str, index: int) -> InputError:
    quantity, example = CHANNEL_QUANTITY[name], unit_example(name, table)
    headed = table.head.names[index] if table.head.headed else ""
    signal, written = signal_unit(headed), bracketed_text(headed)
    if signal is not None:
        return of_signal(name, signal, table, index, where=table.place(index))
    return InputError(
        f"{written} is no unit of {quantity}" if written else f"the {name} has no unit",
        where=table.place(index),
        remedy=f"state it, as in {channel_flag(name, table, index, example)}"
        + _or_as_angle(name, table, index),
    )
