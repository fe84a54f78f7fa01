"""Sensor warm-up: the reading wanders after switching on and settles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import OutputEffect
from softid.effects.scale import Scale
from softid.effects.shared_laws.time_constants import SETTLING_PERIODS, start_times, time_bounds
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

LARGEST_SHARE = 1.0
"""Bound of the wander, as a share of the output's range: a sensor that wanders by more shows
nothing else."""

START_SHARE = 0.1
"""Start of the wander, as a share of the output's range."""

LONGEST_SHARE = 2.0
"""Longest warm-up in logs: of a longer one a log holds less than 40 %, nearly a straight line,
which is a drift."""

TIMES = (0.05, 0.2, 0.6)
"""Starts of the warm-up time, as shares of the log."""


@dataclass(frozen=True)
class SensorWarmup(OutputEffect):
    """Exponential wander after switching on, y = x + size (1 − e^{−t/time}).

    t counts from the start of the log.

    Source: Fraden, *Handbook of Modern Sensors*, 5th ed. 2016, ch. 3.
    """

    name: ClassVar[str] = "sensor_warmup"
    title: ClassVar[str] = "Warm-up of the sensor"
    law: ClassVar[str] = "recorded y = x + size (1 - exp(-t/time))"
    meaning: ClassVar[str] = (
        "The sensor's zero wanders after it was switched on and comes to rest as the sensor gets "
        "warm."
    )
    signature: ClassVar[str] = (
        "The residual rises or falls fast at the start of the log and ever more slowly later, "
        "whatever the input does."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("sensor_drift", "creep", "ageing")
    remedy: ClassVar[str] = "switch the sensor on long before the log, or log a rest first"
    shown_by: ClassVar[str] = "a log much longer than the warm-up, with rests in it"
    source: ClassVar[str] = "Fraden, Handbook of Modern Sensors, 5th ed. 2016, ch. 3"
    begins_with_log: ClassVar[bool] = True
    amplitude: ClassVar[str] = "size"
    is_linear: ClassVar[bool] = True
    essential: ClassVar[tuple[str, ...]] = ("time",)
    changes_sign: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The size, at most the output's range, and the time, at most two logs."""
        shortest, longest = time_bounds(scale, periods=SETTLING_PERIODS, share=LONGEST_SHARE)
        return ParameterSet(
            (
                Parameter(
                    "size",
                    START_SHARE * scale.y_span,
                    scale.y_unit,
                    -LARGEST_SHARE * scale.y_span,
                    LARGEST_SHARE * scale.y_span,
                    meaning="wander of the reading until it is warm",
                    source=self.source,
                ),
                Parameter(
                    "time",
                    min(max(TIMES[1] * scale.duration_s, shortest), longest),
                    "s",
                    shortest,
                    longest,
                    "log",
                    meaning="time constant of the warming",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Times from a twentieth to most of the log; the effect is linear in its size."""
        declared = self.parameters(scale)
        times = start_times(declared["time"], scale, TIMES)
        return tuple({"size": declared["size"].value, "time": time} for time in times)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Add size (1 − e^{−t/time})."""
        del scale
        warming: Array = y - eta[0] * np.expm1(-time_s / eta[1])
        return warming
