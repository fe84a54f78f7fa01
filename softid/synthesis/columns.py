"""Column names of a synthetic CSV: a channel, an underscore and its unit."""

from __future__ import annotations

from dataclasses import dataclass

from softid.errors import InputError
from softid.units import CANONICAL_UNIT, CHANNEL_QUANTITY, lookup_unit


@dataclass(frozen=True)
class Column:
    """A column name taken apart.

    Attributes
    ----------
    channel
        Channel as `softid.units.CHANNEL_QUANTITY` names it.
    unit
        Unit as written in the name.
    factor
        Multiplier from that unit to the canonical one.
    canonical_unit
        Unit in which softid holds the channel.
    """

    channel: str
    unit: str
    factor: float
    canonical_unit: str


def parse_column(name: str, *, where: str = "sensors") -> Column:
    """Take a column name apart.

    Parameters
    ----------
    name
        As in the header of the CSV.
    where
        Place named in the error.

    Raises
    ------
    InputError
        The name does not end in a unit of its channel.

    Examples
    --------
    >>> parse_column("pressure_command_bar")
    Column(channel='pressure_command', unit='bar', factor=100.0, canonical_unit='kPa')
    """
    channel, _, unit_text = name.rpartition("_")
    quantity = CHANNEL_QUANTITY.get(channel)
    unit = lookup_unit(unit_text)
    if quantity is None or channel == "time" or unit is None or unit.quantity != quantity:
        raise InputError(
            "this is not a channel with its unit",
            where=where,
            value=name,
            remedy="write a column such as pressure_kpa, angle_deg or contraction_mm",
        )
    return Column(channel, unit_text, unit.factor, CANONICAL_UNIT[quantity])
