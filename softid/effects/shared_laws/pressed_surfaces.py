"""Forces between surfaces that the input presses onto each other: they grow by 1 + k |u|."""

from __future__ import annotations

from softid.effects.scale import Scale
from softid.parameters import Parameter

GROWTH = (1e-3, 1.0, 100.0)
"""Bounds and start of the share by which such a force grows up to the largest input: it stays,
doubles, or is next to nothing without pressure."""

SOURCE = "Tondu and Lopez 2000, doi 10.1109/37.833638"
"""Where the friction of a braid goes with the pressure that presses its threads onto each other."""

SHOWN_BY = "slow strokes up and down about a low and about a high pressure"
"""The log that shows the growth."""


def largest_input(scale: Scale) -> float:
    """The largest size of the input, of either sign; one unit where it is zero throughout.

    Parameters
    ----------
    scale
        Sizes of the logs.
    """
    return max(abs(scale.u_low), abs(scale.u_high)) or 1.0


def growth(scale: Scale) -> Parameter:
    """The share k of a force that is gained with each unit of input.

    Parameters
    ----------
    scale
        Sizes of the logs.
    """
    least, start, most = (share / largest_input(scale) for share in GROWTH)
    return Parameter(
        "k",
        start,
        f"1/{scale.u_unit}",
        least,
        most,
        "log",
        meaning="share gained with each unit of input",
        source=SOURCE,
    )
