"""Channels as somebody asked for them, by flag or in the sidecar: a column and its unit."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from softid.errors import InputError, UsageError
from softid.readers.base import Table, first_names
from softid.readers.columns import meant_channel, read_name
from softid.readers.sidecar import Sidecar
from softid.readers.signals import require_unit_of
from softid.units import split_scale

Refusal = type[UsageError] | type[InputError]
"""What a wrong wish ends in: a flag is wrong usage, a sidecar a wrong file."""


@dataclass(frozen=True)
class Wish:
    """A channel as somebody asked for it.

    Attributes
    ----------
    index
        Column.
    unit
        Unit of one count times ``scale``, or None when not stated.
    scale
        Number before the unit: the value of one count.
    """

    index: int
    unit: str | None
    scale: float = 1.0


def asked_channels(
    table: Table, flags: Mapping[str, str], sidecar: Sidecar, needed: Collection[str]
) -> dict[str, Wish]:
    """Channel name → wish; flags beat the sidecar.

    Parameters
    ----------
    table
        The file's table.
    flags
        Channel name → ``"COLUMN[:UNIT]"``.
    sidecar
        What the sidecar says.
    needed
        Names that a role asks for too, so that they are no slip of typing.

    Raises
    ------
    UsageError
        A flag names a column that is not there, a unit that is none or a misspelt channel.
    InputError
        The sidecar does.
    """
    asked = {*flags, *sidecar.channels}
    wishes = {}
    for name, text in flags.items():
        where = f"--channel {name}"
        if name not in needed:
            _refuse_misspelt(name, asked, where, UsageError)
        column, unit = _split(table, text)
        wishes[name] = _wish(table, name, column, unit, where, UsageError)
    for name, entry in sidecar.channels.items():
        if name not in wishes:
            where = f"{sidecar.path}, [channels] {name}"
            if name not in needed:
                _refuse_misspelt(name, asked, where, InputError)
            wishes[name] = _wish(table, name, entry.column, entry.unit, where, InputError)
    return wishes


def _refuse_misspelt(name: str, asked: Collection[str], where: str, refusal: Refusal) -> None:
    """A raw channel may have any name, but a slip of typing would let another channel be fitted."""
    meant = meant_channel(name)
    if meant is not None and meant not in asked:
        raise refusal(
            "there is no such channel",
            where=where,
            value=name,
            remedy=f"did you mean {meant}? A channel of your own needs a name less like it",
        )


def _split(table: Table, text: str) -> tuple[str, str | None]:
    column, colon, unit = text.rpartition(":")
    if not colon or text in table.head.names:
        return text, None
    return column, unit.strip() or None


def _wish(
    table: Table, name: str, column: str | int, unit: str | None, where: str, refusal: Refusal
) -> Wish:
    index = _find_column(table, column, where, refusal)
    scale, symbol = split_scale(unit) if unit else (1.0, None)
    if not 0.0 < abs(scale) < math.inf:
        raise refusal(
            "one count of a column cannot be worth this",
            where=f"{table.head.path}, {where}",
            value=unit,
            remedy="write what one count is worth, as in 35.15*N",
        )
    if symbol is not None:
        try:
            require_unit_of(name, symbol, table, index, where=where)
        except InputError as error:
            raise refusal(
                error.what, where=f"{table.head.path}, {where}", value=unit, remedy=error.remedy
            ) from error
    return Wish(index, symbol, scale)


def _find_column(table: Table, column: str | int, where: str, refusal: Refusal) -> int:
    """Index of a column given by its name, or by its number counted from 1."""
    names = table.head.names
    text = str(column).strip()
    if text in table.head.unaligned:
        raise table.head.unaligned[text]
    wanted = text.casefold()
    for alike in (
        lambda name: name == text,
        lambda name: name.casefold() == wanted,
        lambda name: read_name(name).words == read_name(text).words != (),
    ):
        hits = [k for k, name in enumerate(names) if alike(name)]
        if len(hits) == 1:
            return hits[0]
        if hits:
            numbers = " and ".join(str(k + 1) for k in hits)
            raise refusal(
                f"the columns {numbers} could be {text}",
                where=f"{table.head.path}, {where}",
                remedy="give the column's number",
            )
        if text.isdecimal() and 1 <= int(text) <= len(names):
            return int(text) - 1
    known = f"1 to {len(names)}" if not table.head.headed else first_names(names)
    raise refusal(
        "there is no such column",
        where=f"{table.head.path}, {where}",
        value=column,
        remedy=f"choose from {known}",
    )
