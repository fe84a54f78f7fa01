"""Units at the edge: every number inside softid is a plain float in its quantity's canonical unit.

The frequent spellings are in a table, so that reading a log needs no unit library; anything else
is handed to pint.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

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
_TURN = 6.283185307179586
_PSI_KPA = 6.894757293168361
_KGF_CM2_KPA = 98.0665

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
    "usec": ("time", 1e-6),
    "µs": ("time", 1e-6),
    "μs": ("time", 1e-6),
    "micros": ("time", 1e-6),
    "ns": ("time", 1e-9),
    "min": ("time", 60.0),
    "minute": ("time", 60.0),
    "minutes": ("time", 60.0),
    "h": ("time", 3600.0),
    "hr": ("time", 3600.0),
    "hour": ("time", 3600.0),
    "hours": ("time", 3600.0),
    "pa": ("pressure", 1e-3),
    "hpa": ("pressure", 0.1),
    "kpa": ("pressure", 1.0),
    "bar": ("pressure", 100.0),
    "mbar": ("pressure", 0.1),
    "psi": ("pressure", _PSI_KPA),
    "psig": ("pressure", _PSI_KPA),
    "psi(g)": ("pressure", _PSI_KPA),
    "psia": ("pressure", _PSI_KPA),
    "n/mm2": ("pressure", 1e3),
    "kgf/cm2": ("pressure", _KGF_CM2_KPA),
    "barg": ("pressure", 100.0),
    "atm": ("pressure", 101.325),
    "mmhg": ("pressure", 0.133322387415),
    "torr": ("pressure", 0.133322368421),
    "rad": ("angle", 1.0),
    "radian": ("angle", 1.0),
    "radians": ("angle", 1.0),
    "mrad": ("angle", 1e-3),
    "deg": ("angle", _DEGREE),
    "deg.": ("angle", _DEGREE),
    "degs": ("angle", _DEGREE),
    "degree": ("angle", _DEGREE),
    "degrees": ("angle", _DEGREE),
    "°": ("angle", _DEGREE),
    "gon": ("angle", _TURN / 400.0),
    "rev": ("angle", _TURN),
    "revs": ("angle", _TURN),
    "mm": ("length", 1.0),
    "cm": ("length", 10.0),
    "m": ("length", 1000.0),
    "um": ("length", 1e-3),
    "µm": ("length", 1e-3),
    "μm": ("length", 1e-3),
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
    "MPA": ("pressure", 1e3),
    "mPa": ("pressure", 1e-6),
    "MN": ("force", 1e6),
}
_SYMBOLS = {
    "kpa": "kPa",
    "pa": "Pa",
    "hpa": "hPa",
    "bar": "bar",
    "mbar": "mbar",
    "psi": "psi",
    "rad": "rad",
    "deg": "deg",
    "mm": "mm",
    "kn": "kN",
    "mn": "mN",
    "n": "N",
    "nmm": "N·mm",
    "nm": "N·m",
    "mnm": "mN·m",
    "ncm": "N·cm",
    "mmhg": "mmHg",
    "degree": "deg",
    "degrees": "deg",
    "degs": "deg",
    "deg.": "deg",
    "°": "deg",
    "sec": "s",
    "second": "s",
    "seconds": "s",
    "msec": "ms",
    "millis": "ms",
    "usec": "us",
    "micros": "us",
    "minute": "min",
    "minutes": "min",
    "hr": "h",
    "hour": "h",
    "hours": "h",
}
# What may be handed to pint: names with small exponents, so that no text can ask for 9**9**9.
_UNIT_TEXT = re.compile(r"[^\W\d]\w*(\^-?\d)?( ?[*/·. ] ?[^\W\d]\w*(\^-?\d)?)*")
_LONGEST_UNIT = 40
_SCALED = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|-)\s*[*·]?\s*([^\d\s-].*)")
_EXPONENT = re.compile(r"(?<=[^\W\d_])(?=-?[23](?!\w))")
_AMBIGUOUS = frozenset({"grad", "grads"})
_SHARES = frozenset({"%", "percent", "per cent", "1", "mm/mm", "m/m"})
OF_A_SHARE = (
    "multiply a strain by the length that it is a share of; or declare "
    "--channel contraction=COLUMN:mm, and read every mm of the answer as the column's own unit"
)
"""What to do with a channel that is a share of a length: models take lengths and angles."""

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
        The text is no unit of time, pressure, angle, length, force or torque, or means two.

    Examples
    --------
    >>> parse_unit("bar")
    Unit(text='bar', quantity='pressure', factor=100.0)
    """
    if text.strip().lower() in _AMBIGUOUS:
        raise InputError(
            "in German this is the degree, elsewhere the gon, of which a turn has 400",
            where=where,
            value=text,
            remedy="state which one with --channel angle=COLUMN:deg or --channel angle=COLUMN:gon",
        )
    found = lookup_unit(text)
    if found is None:
        found = _parse_with_pint(text)
    if found is None:
        raise InputError(
            "this is not a unit that softid can convert",
            where=where,
            value=text,
            remedy=OF_A_SHARE
            if text.strip().lower() in _SHARES
            else "write a unit of time, pressure, angle, length, force or torque, such as kPa or "
            "deg, or leave the channel raw",
        )
    return found


def lookup_unit(text: str) -> Unit | None:
    """Resolve a frequent spelling from the table alone; None when it is not there."""
    stripped = text.strip()
    hit = _CASE_SENSITIVE.get(stripped) or _SPELLINGS.get(stripped.lower().replace(" ", ""))
    return Unit(text, *hit) if hit else None


def unit_symbol(text: str) -> str:
    """The usual way to write a unit that a header spells in lower case or in words.

    Examples
    --------
    >>> unit_symbol("kpa"), unit_symbol("MPa"), unit_symbol("counts")
    ('kPa', 'MPa', 'counts')
    """
    stripped = text.strip()
    if stripped in _CASE_SENSITIVE:
        return "MPa" if stripped == "MPA" else stripped
    return _SYMBOLS.get(stripped.lower().replace(" ", ""), stripped)


def split_scale(text: str) -> tuple[float, str]:
    """Split a number before a unit from it: the value of one step of a counter or a voltage.

    Parameters
    ----------
    text
        A unit, a number times a unit, ``"35.15*N"``, or a minus before it for a sensor that is
        mounted the other way round, ``"-deg"``.

    Returns
    -------
    tuple
        The number, 1.0 when there is none, and the unit.

    Examples
    --------
    >>> split_scale("35.15*N"), split_scale("kPa"), split_scale("-deg")
    ((35.15, 'N'), (1.0, 'kPa'), (-1.0, 'deg'))
    """
    plain = text.strip().replace("\N{MINUS SIGN}", "-")
    match = _SCALED.fullmatch(plain)
    if match is None:
        return 1.0, plain
    return -1.0 if match[1] == "-" else float(match[1]), match[2].strip()


@cache
def _parse_with_pint(text: str) -> Unit | None:
    plain = " ".join(text.replace("**", "^").replace("²", "^2").replace("³", "^3").split())
    plain = _EXPONENT.sub("^", plain)
    if len(plain) > _LONGEST_UNIT or not _UNIT_TEXT.fullmatch(plain):
        return None

    import pint  # 0.2 s, and only an unusual unit needs it

    registry: Any = pint.UnitRegistry()
    try:
        quantity = registry.Quantity(1.0, plain.replace("·", "*")).to_base_units()
    except Exception:  # noqa: BLE001 - pint raises tokenizer, attribute and value errors alike
        return None
    if quantity.units == registry.Unit("radian"):
        return Unit(text, "angle", float(quantity.magnitude))
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
            f"{unit} is a unit of {parsed.quantity}, not of {quantity}",
            where=where,
            remedy=f"give a unit of {quantity}, such as {CANONICAL_UNIT[quantity]}",
        )
    return parsed.factor
