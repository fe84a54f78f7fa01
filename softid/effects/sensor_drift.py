"""Sensor drift: the recorded output wanders at a constant rate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import OutputEffect
from softid.effects.scale import Scale
from softid.effects.shared_laws.one_start import OneStart
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

LARGEST_SHARE = 2.0
"""Bound of the drift over the longest log, in the output's ranges: what drifts by more than a range
must be made up for by as large a motion the other way."""

START_SHARE = 0.05
"""Start of the drift, as a share of its bound."""


@dataclass(frozen=True)
class SensorDrift(OneStart, OutputEffect):
    """Drift at a constant rate, y = x + rate t.

    Source: Fraden, *Handbook of Modern Sensors*, 5th ed. 2016, ch. 3.
    """

    name: ClassVar[str] = "sensor_drift"
    title: ClassVar[str] = "Drift of the sensor"
    law: ClassVar[str] = "recorded y = x + rate t"
    meaning: ClassVar[str] = "The sensor's reading wanders at a constant rate while nothing moves."
    signature: ClassVar[str] = "The residual is a straight line over the whole log."
    neighbours: ClassVar[tuple[str, ...]] = ("sensor_warmup", "ageing", "creep")
    remedy: ClassVar[str] = "let the sensor warm up, calibrate a gyro's bias at rest"
    shown_by: ClassVar[str] = "a rest at the beginning and at the end of a long log"
    source: ClassVar[str] = "Fraden, Handbook of Modern Sensors, 5th ed. 2016, ch. 3"
    amplitude: ClassVar[str] = "rate"
    is_linear: ClassVar[bool] = True
    changes_sign: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The rate, at most twice the output's range within the log."""
        largest = LARGEST_SHARE * scale.y_span / scale.duration_s
        return ParameterSet(
            (
                Parameter(
                    "rate",
                    START_SHARE * largest,
                    f"{scale.y_unit}/s",
                    -largest,
                    largest,
                    meaning="drift of the reading",
                    source=self.source,
                ),
            )
        )

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Add rate t."""
        del scale
        drifting: Array = y + eta[0] * time_s
        return drifting
