"""Sensor clipping: the reading stops at the end of the sensor's range."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import OutputEffect
from softid.effects.scale import Scale
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

DEEPEST = 0.7
"""Deepest cut, as a share of the output's range: of a motion cut deeper little is left to fit."""

BEYOND = 1.0
"""How far beyond the range a limit may lie, in ranges; it cuts nothing there."""

START_DEPTHS = (0.01, 0.1, 0.3)
"""Starts of the depth of a cut, as shares of the output's range."""

START_PAIRS = ((0.01, 0.01), (0.1, 0.1), (0.3, 0.1), (0.1, 0.3))
"""Starts of the upper and of the lower limit, as shares of the range."""


@dataclass(frozen=True)
class SensorClipping(OutputEffect):
    """Reading that ends at an upper limit, y = min(x, upper).

    The limit counts from the model's own zero, as x does: what was recorded is flat at the limit
    plus the sensor zero of the log. There is no amplitude: the effect
    vanishes when the limit lies beyond all of the motion.

    Source: Doebelin, *Measurement Systems*, 5th ed. 2004, §3.2.
    """

    name: ClassVar[str] = "sensor_clipping"
    title: ClassVar[str] = "Clipping of the sensor at its upper limit"
    law: ClassVar[str] = "recorded y = min(x, upper) + sensor zero of the log"
    meaning: ClassVar[str] = (
        "The motion continues, but the reading stops at the end of the sensor's range: at the "
        "limit plus the sensor zero of the log."
    )
    signature: ClassVar[str] = (
        "The reading is flat at one exact value at its extremes, where the residual is the part of "
        "the motion that is cut off."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("contact", "static_curve", "stiffening")
    remedy: ClassVar[str] = (
        "use a sensor with a larger range, a smaller gain, or mount it differently"
    )
    shown_by: ClassVar[str] = "levels that exceed the end of the sensor's range and return"
    source: ClassVar[str] = "Doebelin, Measurement Systems, 5th ed. 2004, §3.2"
    amplitude: ClassVar[str | None] = None
    mutes: ClassVar[bool] = True
    readings: ClassVar[tuple[str, ...]] = ("upper", "lower")

    def parameters(self, scale: Scale) -> ParameterSet:
        """The upper limit, from 0.3 of the range to a whole range beyond it."""
        return ParameterSet((_upper(scale, START_DEPTHS[1], self.source),))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Limits that just touch the range, and that cut off a tenth and a third."""
        return tuple({"upper": scale.y_high - d * scale.y_span} for d in START_DEPTHS)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Cut off above the limit; where it is cut, the derivative is by the limit alone."""
        del time_s, scale
        recorded: Array = np.minimum(y, eta[0])
        return recorded


@dataclass(frozen=True)
class LowerSensorClipping(SensorClipping):
    """Reading that ends at a lower limit, y = max(x, lower).

    Source: Doebelin, *Measurement Systems*, 5th ed. 2004, §3.2.
    """

    variant: ClassVar[str] = "lower"
    title: ClassVar[str] = "Clipping of the sensor at its lower limit"
    law: ClassVar[str] = "recorded y = max(x, lower) + sensor zero of the log"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The lower limit, from 0.7 of the range to a whole range below it."""
        return ParameterSet((_lower(scale, START_DEPTHS[1], self.source),))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Limits that just touch the range, and that cut off a tenth and a third."""
        return tuple({"lower": scale.y_low + d * scale.y_span} for d in START_DEPTHS)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Cut off below the limit."""
        del time_s, scale
        recorded: Array = np.maximum(y, eta[0])
        return recorded


@dataclass(frozen=True)
class BothSensorClipping(SensorClipping):
    """Reading that ends at either end, y = max(min(x, upper), lower).

    Source: Doebelin, *Measurement Systems*, 5th ed. 2004, §3.2.
    """

    variant: ClassVar[str] = "both"
    title: ClassVar[str] = "Clipping of the sensor at both limits"
    law: ClassVar[str] = "recorded y = max(min(x, upper), lower) + sensor zero of the log"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The upper and the lower limit."""
        depth = START_DEPTHS[1]
        return ParameterSet((_upper(scale, depth, self.source), _lower(scale, depth, self.source)))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Limits at equal depths, and two that cut one end deeper than the other."""
        return tuple(
            {
                "upper": scale.y_high - above * scale.y_span,
                "lower": scale.y_low + below * scale.y_span,
            }
            for above, below in START_PAIRS
        )

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Cut off above and below."""
        del time_s, scale
        recorded: Array = np.maximum(np.minimum(y, eta[0]), eta[1])
        return recorded


def _upper(scale: Scale, depth: float, source: str) -> Parameter:
    return Parameter(
        "upper",
        scale.y_high - depth * scale.y_span,
        scale.y_unit,
        scale.y_high - DEEPEST * scale.y_span,
        scale.y_high + BEYOND * scale.y_span,
        meaning="largest possible reading, less the sensor zero of the log",
        source=source,
    )


def _lower(scale: Scale, depth: float, source: str) -> Parameter:
    return Parameter(
        "lower",
        scale.y_low + depth * scale.y_span,
        scale.y_unit,
        scale.y_low - BEYOND * scale.y_span,
        scale.y_low + DEEPEST * scale.y_span,
        meaning="smallest possible reading, less the sensor zero of the log",
        source=source,
    )
