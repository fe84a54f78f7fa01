"""Whether values are plausible in their unit: a range check that asks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from softid.channels import Channel
from softid.units import CHANNEL_QUANTITY, lookup_unit

CHECKED_QUANTILE = 0.99
"""The range is judged by this quantile of the magnitude, so that single spikes do not count."""

HIGHEST_PRESSURE_KPA = 2000.0
"""No soft actuator is driven so high; a pressure in Pa read as kPa or bar is."""

SMALLEST_SPAN_KPA = 0.05
"""Least move of a pressure in kPa: one that moves less was recorded in a larger unit than stated,
unless it stays `REST_LEVEL_KPA` from zero."""

REST_LEVEL_KPA = 1.0
"""Distance from zero in kPa at which a pressure may move as little as it likes, as that of a rig at
rest does."""

LARGEST_ANGLE_RAD = 4.0 * math.pi
"""Two turns; degrees read as radians pass it."""


_PRESSURE_UNITS = ("kPa", "Pa", "bar", "psi")
_ANGLE_UNITS = ("deg",)


@dataclass(frozen=True)
class Doubt:
    """Why a channel's values do not fit its unit.

    Attributes
    ----------
    what
        The question to the user.
    value
        What was seen, in the stated unit.
    better
        A unit in which the values would be plausible.
    """

    what: str
    value: float
    better: str


def find_doubt(channel: Channel) -> Doubt | None:
    """Judge the values of a channel with known quantity; None when they fit its unit.

    Examples
    --------
    >>> from softid.channels import make_channel
    >>> find_doubt(make_channel("pressure", [0.0, 1e5], "bar")).better
    'Pa'
    """
    values = channel.values[np.isfinite(channel.values)]
    if not values.size:
        return None
    high = float(np.quantile(np.abs(values), CHECKED_QUANTILE))
    span = float(values.max() - values.min())
    quantity = CHANNEL_QUANTITY.get(channel.name)
    said: str | None = None
    units: tuple[str, ...] = ()
    if quantity == "pressure":
        units = _PRESSURE_UNITS
        said = _pressure_doubt(high, span)
        if high <= HIGHEST_PRESSURE_KPA:
            high = span
    elif quantity == "angle" and high > LARGEST_ANGLE_RAD:
        units = _ANGLE_UNITS
        said = f"is {high:.4g} rad, more than two turns"
    if said is None:
        return None
    seen = float(f"{high * channel.display_factor:.4g}")
    return Doubt(
        f"as {channel.display_unit} the {channel.name} {said}; is that its unit?",
        seen,
        next((u for u in units if _fits(seen, u)), units[0]),
    )


def _pressure_doubt(high_kpa: float, span_kpa: float) -> str | None:
    if high_kpa > HIGHEST_PRESSURE_KPA:
        return f"is {high_kpa:.4g} kPa, more than {HIGHEST_PRESSURE_KPA:g} kPa"
    if 0.0 < span_kpa < SMALLEST_SPAN_KPA and high_kpa < REST_LEVEL_KPA:
        return f"moves by {span_kpa:.2g} kPa, less than {SMALLEST_SPAN_KPA:g} kPa"
    return None


def _fits(value: float, unit: str) -> bool:
    found = lookup_unit(unit)
    if found is None:
        return False
    canonical = value * found.factor
    if found.quantity == "angle":
        return canonical <= LARGEST_ANGLE_RAD
    return SMALLEST_SPAN_KPA <= canonical <= HIGHEST_PRESSURE_KPA
