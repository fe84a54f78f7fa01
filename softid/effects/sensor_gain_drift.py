"""Sensor gain drift: the recorded output grows or shrinks in proportion to itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import OutputEffect
from softid.effects.scale import Scale
from softid.effects.shared_laws.one_start import OneStart
from softid.effects.shared_laws.steady_change import relative_rate
from softid.parameters import ParameterSet

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class SensorGainDrift(OneStart, OutputEffect):
    """Gain that changes at a constant rate, y = x (1 + g t), t from the start of the log.

    At rest it is what a stiffness that changes with time does; in motion that changes the time
    constant, too.

    Source: Fraden, *Handbook of Modern Sensors*, 5th ed. 2016, ch. 3 (sensitivity drift).
    """

    name: ClassVar[str] = "sensor_gain_drift"
    title: ClassVar[str] = "Drift of the sensor's gain"
    law: ClassVar[str] = "recorded y = x (1 + g t)"
    meaning: ClassVar[str] = (
        "For the same motion the reading slowly grows or shrinks, for example because the "
        "sensor's temperature or supply voltage changes."
    )
    signature: ClassVar[str] = (
        "The residual grows in proportion to time and to the output, in motion and at rest; the "
        "time constants do not change."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("ageing", "sensor_drift", "softening")
    remedy: ClassVar[str] = (
        "calibrate the sensor before and after the log, and the pressure sensor too, whose gain "
        "may drift instead; or stabilise their supply"
    )
    shown_by: ClassVar[str] = "the same fast steps at the beginning and at the end of a long log"
    source: ClassVar[str] = "Fraden, Handbook of Modern Sensors, 5th ed. 2016, ch. 3"
    begins_with_log: ClassVar[bool] = True
    amplitude: ClassVar[str] = "g"
    is_linear: ClassVar[bool] = True
    counts_position: ClassVar[bool] = True
    changes_sign: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The rate g; a negative one leaves a tenth of the gain at the end of the log."""
        meaning = "relative change of the gain per second"
        return relative_rate("g", scale, meaning=meaning, source=self.source)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Multiply by 1 + g t."""
        del scale
        grown: Array = y * (1.0 + eta[0] * time_s)
        return grown
