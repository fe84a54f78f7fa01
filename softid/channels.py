"""One measured quantity of a log, in its canonical unit and in the file's."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.errors import InputError
from softid.given_values import as_numbers
from softid.units import CANONICAL_UNIT, CHANNEL_QUANTITY, factor_to_canonical

Array = npt.NDArray[np.float64]

OUTPUT_PREFERENCE = (
    "angle",
    "contraction",
    "distance",
    "length",
    "position",
    "torque",
    "force",
)
"""Which channel is the output when the user names none: the first of these that is there."""

PRESSURE_COMMAND = "pressure_command"
"""The channel of a pressure that was set."""

COMMAND_WORDS = frozenset(
    [
        "cmd",
        "command",
        "commanded",
        "set",
        "setpoint",
        "setp",
        "sp",
        "ref",
        "reference",
        "target",
        "desired",
        "des",
        "demand",
        "goal",
        "soll",
    ]
)
"""Words in a name that say that somebody set it and nobody measured it."""


def is_command(name: str) -> bool:
    """Whether an input is what was commanded, by the words of its name.

    Parameters
    ----------
    name
        Of the input: an output of such a name may be a reference sensor.

    Examples
    --------
    >>> is_command("pressure_command"), is_command("valve setpoint (V)"), is_command("pressure")
    (True, True, False)
    """
    return not COMMAND_WORDS.isdisjoint(re.split(r"[^a-z]+", name.lower()))


def read_only(values: npt.ArrayLike) -> Array:
    """Copy to a float64 array that nobody can change; what nobody can change already stays."""
    if isinstance(values, np.ndarray) and values.dtype == np.float64 and _is_held(values):
        return values
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def _is_held(values: npt.NDArray[Any]) -> bool:
    return values.flags.owndata and not values.flags.writeable


@dataclass(frozen=True, eq=False)
class Channel:
    """One measured quantity over the log's own times.

    Attributes
    ----------
    name
        Known name (`softid.units.CHANNEL_QUANTITY`) or, for a raw channel, the column's.
    values
        Samples in ``unit``, shape (n,); NaN where nothing was recorded.
    unit
        Canonical unit, or the user's own for a raw channel.
    display_unit, display_factor
        Unit of the file and the factor from ``unit`` to it, so that results can be shown in it.
    column
        Column of the file, or None for arrays.
    """

    name: str
    values: Array = field(repr=False)
    unit: str
    display_unit: str
    display_factor: float = 1.0
    column: str | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", read_only(self.values))

    @property
    def displayed(self) -> Array:
        """The samples in the unit of the file."""
        return self.values * self.display_factor


def make_channel(
    name: str, values: npt.ArrayLike, unit: str | None = None, *, column: str | None = None
) -> Channel:
    """Build a channel from values in any unit.

    Parameters
    ----------
    name
        A known channel name, or any other name for a raw channel.
    values
        Samples, shape (n,), in ``unit``; NaN or masked where nothing was recorded.
    unit
        Their unit; None means the canonical one (a raw channel: ``"1"``).
    column
        Column of the file they came from.

    Raises
    ------
    InputError
        The unit does not measure what the channel is, or the values are no vector of numbers.

    Examples
    --------
    >>> make_channel("pressure", [0.0, 1.5], "bar").values.tolist()
    [0.0, 150.0]
    """
    numbers = as_numbers(values, where=column or name)
    quantity = CHANNEL_QUANTITY.get(name, "raw")
    if quantity == "raw":
        own = unit or "1"
        return Channel(name, numbers, own, own, 1.0, column)
    canonical = CANONICAL_UNIT[quantity]
    shown = unit or canonical
    factor = factor_to_canonical(shown, quantity, where=column or name)
    return Channel(name, numbers * factor, canonical, shown, 1.0 / factor, column)


def default_outputs(
    channels: Mapping[str, Channel], input_name: str, *, where: str
) -> tuple[str, ...]:
    """The output channel to explain when the user names none.

    Raises
    ------
    InputError
        No channel has a name that is recognised as an output.
    """
    for name in OUTPUT_PREFERENCE:
        if name in channels and name != input_name:
            return (name,)
    raise InputError(
        "no output channel is recognised",
        where=where,
        value=", ".join(channels),
        remedy="name one with --channel angle=COLUMN:UNIT or --output (outputs= in Python)",
    )
