"""Whether values are plausible in their unit: a range check that asks."""

from __future__ import annotations

import math

import numpy as np

from softid.channels import Channel
from softid.errors import InputError
from softid.units import CHANNEL_QUANTITY

CHECKED_QUANTILE = 0.99
"""The range is judged by this quantile of the magnitude, so that single spikes do not count."""

HIGHEST_PRESSURE_KPA = 2000.0
"""No soft actuator is driven so high; a pressure in Pa read as kPa or bar is."""

SMALLEST_SPAN_KPA = 0.05
"""A pressure that moves, but less than this, was recorded in a larger unit than stated."""

LARGEST_ANGLE_RAD = 4.0 * math.pi
"""Two turns; degrees read as radians pass it."""


def implausible(channel: Channel, *, where: str, remedy: str) -> InputError | None:
    """Judge a channel's values; an error to raise when they do not fit its unit, else None.

    Parameters
    ----------
    channel
        A channel with known quantity.
    where
        File and column.
    remedy
        How to state the right unit.
    """
    values = channel.values[np.isfinite(channel.values)]
    if not values.size:
        return None
    high = float(np.quantile(np.abs(values), CHECKED_QUANTILE))
    quantity = CHANNEL_QUANTITY.get(channel.name)
    said: str | None = None
    if quantity == "pressure":
        span = float(values.max() - values.min())
        if high > HIGHEST_PRESSURE_KPA:
            said = f"is {high:.4g} kPa, more than {HIGHEST_PRESSURE_KPA:g} kPa"
        elif 0.0 < span < SMALLEST_SPAN_KPA:
            high, said = span, f"moves by {span:.2g} kPa, less than {SMALLEST_SPAN_KPA:g} kPa"
    elif quantity == "angle" and high > LARGEST_ANGLE_RAD:
        said = f"is {high:.4g} rad, more than two turns"
    if said is None:
        return None
    return InputError(
        f"as {channel.display_unit} the {channel.name} {said}; is that its unit?",
        where=where,
        value=float(f"{high * channel.display_factor:.4g}"),
        remedy=remedy,
    )
