"""Units that measure what a channel is, and signals of a gauge, of which nobody said how much."""

from __future__ import annotations

from softid.errors import InputError
from softid.readers.base import Table
from softid.readers.columns import signal_unit
from softid.readers.times import channel_flag
from softid.units import CANONICAL_UNIT, CHANNEL_QUANTITY, factor_to_canonical


def require_unit_of(channel: str, unit: str, table: Table, index: int, *, where: str) -> None:
    """Refuse a unit that does not measure what a channel is.

    Parameters
    ----------
    channel
        Name of the channel; one of the user's own has any unit.
    unit
        The unit as written.
    table, index
        The file's table and the column.
    where
        Where the unit was given, for the message.

    Raises
    ------
    InputError
        It is none, measures something else, or is a signal's.
    """
    signal = signal_unit(unit)
    if signal is not None and channel in CHANNEL_QUANTITY:
        raise of_signal(channel, signal, table, index, where=where)
    factor_to_canonical(unit, CHANNEL_QUANTITY.get(channel, "raw"), where=where)


def of_signal(channel: str, signal: str, table: Table, index: int, *, where: str) -> InputError:
    """The error about a channel in volts, milliamperes or counts, which asks for the scale."""
    return InputError(
        f"{signal} is no unit of {CHANNEL_QUANTITY[channel]}",
        where=where,
        remedy=f"say how much 1 {signal} is, as in "
        f"{channel_flag(channel, table, index, f'100*{unit_example(channel, table)}')}",
    )


def unit_example(channel: str, table: Table) -> str:
    """A unit to propose for a known channel."""
    usual = {"angle": "deg", **table.usual_units}
    return usual.get(channel, CANONICAL_UNIT[CHANNEL_QUANTITY[channel]])
