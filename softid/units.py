"""Units at the edge: every number inside softid is a plain float in its quantity's canonical unit.

The frequent spellings are in a table, so that reading a log needs no unit library; anything else
is handed to pint.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from softid.errors import InputError

Quantity = Literal["time", "pressure", "angle", "length", "torque", "force", "raw"]

CANONICAL_UNIT: dict[Quantity, str] = {
    "time": "s",
    "pressure": "kPa",
    "angle": "rad",
    "length": "mm",
    "torque": "N·mm",
    "force": "N",
}
"""The unit in which each quantity is held inside softid; a raw channel keeps its own."""

CHANNEL_QUANTITY: dict[str, Quantity] = {
    "time": "time",
    "pressure": "pressure",
    "pressure_command": "pressure",
    "angle": "angle",
    "contraction": "length",
    "length": "length",
    "distance": "length",
    "position": "length",
    "torque": "torque",
    "force": "force",
}
"""The channels that softid knows by name, and what they measure."""

_DEGREE = 0.017453292519943295
_PSI_KPA = 6.894757293168361

# Spelling -> quantity, factor to the canonical unit. Case matters only where it must (mPa, MPa).
_SPELLINGS: dict[str, tuple[Quantity, float]] = {
    "s": ("time", 1.0),
    "sec": ("time", 1.0),
    "second": ("time", 1.0),
    "seconds": ("time", 1.0),
    "ms": ("time", 1e-3),
    "msec": ("time", 1e-3),
    "millis": ("time", 1e-3),
    "us": ("time", 1e-6),
    "µs": ("time", 1e-6),
    "micros": ("time", 1e-6),
    "ns": ("time", 1e-9),
    "min": ("time", 60.0),
    "pa": ("pressure", 1e-3),
    "hpa": ("pressure", 0.1),
    "kpa": ("pressure", 1.0),
    "bar": ("pressure", 100.0),
    "mbar": ("pressure", 0.1),
    "psi": ("pressure", _PSI_KPA),
    "psig": ("pressure", _PSI_KPA),
    "atm": ("pressure", 101.325),
    "rad": ("angle", 1.0),
    "radian": ("angle", 1.0),
    "radians": ("angle", 1.0),
    "mrad": ("angle", 1e-3),
    "deg": ("angle", _DEGREE),
    "degs": ("angle", _DEGREE),
    "degree": ("angle", _DEGREE),
    "degrees": ("angle", _DEGREE),
    "°": ("angle", _DEGREE),
    "mm": ("length", 1.0),
    "cm": ("length", 10.0),
    "m": ("length", 1000.0),
    "um": ("length", 1e-3),
    "µm": ("length", 1e-3),
    "in": ("length", 25.4),
    "inch": ("length", 25.4),
    "n": ("force", 1.0),
    "mn": ("force", 1e-3),
    "kn": ("force", 1e3),
    "nmm": ("torque", 1.0),
    "n·mm": ("torque", 1.0),
    "n*mm": ("torque", 1.0),
    "n.mm": ("torque", 1.0),
    "nm": ("torque", 1000.0),
    "n·m": ("torque", 1000.0),
    "n*m": ("torque", 1000.0),
    "n.m": ("torque", 1000.0),
    "mnm": ("torque", 1.0),
    "ncm": ("torque", 10.0),
}
_CASE_SENSITIVE: dict[str, tuple[Quantity, float]] = {
    "MPa": ("pressure", 1e3),
    "mPa": ("pressure", 1e-6),
    "MN": ("force", 1e6),
}
_PINT_DIMENSIONS: tuple[tuple[str, Quantity, str], ...] = (
    ("[time]", "time", "s"),
    ("[mass] / [length] / [time] ** 2", "pressure", "kPa"),
    ("[length]", "length", "mm"),
    ("[mass] * [length] / [time] ** 2", "force", "N"),
    ("[mass] * [length] ** 2 / [time] ** 2", "torque", "N*mm"),
)


@dataclass(frozen=True)
class Unit:
    """A unit as written, resolved: ``canonical value = factor · value``.

    Attributes
    ----------
    text
        The unit as the user wrote it.
    quantity
        What it measures.
    factor
        Multiplier to the canonical unit of that quantity.
    """

    text: str
    quantity: Quantity
    factor: float


def parse_unit(text: str, *, where: str | None = None) -> Unit:
    """Resolve the spelling of a unit.

    Parameters
    ----------
    text
        A unit as found in a header or typed by the user: ``"kPa"``, ``"deg"``, ``"N mm"``.
    where
        Place named in the error.

    Raises
    ------
    InputError
        The text is no unit of time, pressure, angle, length, force or torque.

    Examples
    --------
    >>> parse_unit("bar")
    Unit(text='bar', quantity='pressure', factor=100.0)
    """
    found = lookup_unit(text)
    if found is None:
        found = _parse_with_pint(text)
    if found is None:
        raise InputError(
            "this is not a unit that softid can convert",
            where=where,
            value=text,
            remedy="write a unit of time, pressure, angle, length, force or torque, such as kPa or "
            "deg, or leave the channel raw",
        )
    return found


def lookup_unit(text: str) -> Unit | None:
    """Resolve a frequent spelling from the table alone; None when it is not there."""
    stripped = text.strip()
    hit = _CASE_SENSITIVE.get(stripped) or _SPELLINGS.get(stripped.lower().replace(" ", ""))
    return Unit(text, *hit) if hit else None


def _parse_with_pint(text: str) -> Unit | None:
    import pint  # 0.2 s, and only an unusual unit needs it

    registry = pint.UnitRegistry()
    try:
        quantity = registry.Quantity(1.0, text)
    except Exception:  # noqa: BLE001 - pint raises tokenizer, attribute and value errors alike
        return None
    if quantity.dimensionless and quantity.units != registry.Unit("dimensionless"):
        return Unit(text, "angle", float(quantity.to("rad").magnitude))
    for dimension, name, canonical in _PINT_DIMENSIONS:
        if quantity.check(dimension):
            return Unit(text, name, float(quantity.to(canonical).magnitude))
    return None


def factor_to_canonical(unit: str, quantity: Quantity, *, where: str | None = None) -> float:
    """Multiplier from ``unit`` to the canonical unit of ``quantity``.

    Raises
    ------
    InputError
        The unit is unknown or measures something else.

    Examples
    --------
    >>> factor_to_canonical("psi", "pressure")
    6.894757293168361
    """
    if quantity == "raw":
        return 1.0
    parsed = parse_unit(unit, where=where)
    if parsed.quantity != quantity:
        raise InputError(
            f"{unit} is a unit of {parsed.quantity}, but this channel is a {quantity}",
            where=where,
            remedy=f"give a unit of {quantity}, such as {CANONICAL_UNIT[quantity]}",
        )
    return parsed.factor
