"""What grows or shrinks at a constant rate throughout a log, in proportion to itself."""

from __future__ import annotations

from softid.effects.base import MOST_LOST
from softid.effects.scale import Scale
from softid.parameters import Parameter, ParameterSet

SHARE = 0.1
"""Start of the change over the log."""


def relative_rate(name: str, scale: Scale, *, meaning: str, source: str) -> ParameterSet:
    """The rate r of a quantity q (1 + r t); a negative one leaves a tenth of q at the log's end.

    Parameters
    ----------
    name
        Of the rate.
    scale
        Sizes of the logs.
    meaning, source
        Of the rate.
    """
    most = MOST_LOST / scale.duration_s
    rate = Parameter(
        name, SHARE / scale.duration_s, "1/s", -most, most, meaning=meaning, source=source
    )
    return ParameterSet((rate,))
