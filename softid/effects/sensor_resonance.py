"""Sensor resonance: the sensor, its mount or its filter answers to the motion in second order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import OutputEffect
from softid.effects.extension.finer_motion import PIECES, finer_motion
from softid.effects.scale import Scale
from softid.effects.shared_laws.second_order import (
    as_lag,
    ringing_parameters,
    ringing_starts,
    rings,
    shorter_time,
)
from softid.effects.wording import Wording
from softid.kernels.filters import resonance
from softid.parameters import ParameterSet

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class SensorResonance(OutputEffect):
    """Second-order reading ÿ/ω² + 2ζ ẏ/ω + y = x, for a motion straight in quarter intervals.

    Lightly damped it is a sensor on a flexible mount; near ζ = 0.8 it is close to a moving average
    or another smoothing filter. Behind an actuator that is itself linear it is the same as a
    resonance before it.

    Source: Doebelin, *Measurement Systems*, 5th ed. 2004, §3.3.
    """

    name: ClassVar[str] = "sensor_resonance"
    title: ClassVar[str] = "Resonance of the sensor"
    law: ClassVar[str] = "recorded y: y''/w^2 + 2 zeta y'/w + y = x,  w = 2 pi/period"
    meaning: ClassVar[str] = (
        "The sensor swings on its mount, or a smoothing filter behind it has more than one time "
        "constant, so the reading follows the motion late and may overshoot it."
    )
    signature: ClassVar[str] = (
        "The residual rings with one frequency after every fast motion, at every level alike, or "
        "is in proportion to speed and acceleration where the filter is well damped."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("sensor_lag", "line_resonance", "delay")
    remedy: ClassVar[str] = (
        "stiffen the sensor's mount, switch off or shorten its smoothing filter, or correct the "
        "reading for it"
    )
    shown_by: ClassVar[str] = "a chirp beyond the bandwidth of the sensor, at two offsets"
    source: ClassVar[str] = "Doebelin, Measurement Systems, 5th ed. 2004, §3.3"
    amplitude: ClassVar[str] = "period"
    is_linear: ClassVar[bool] = True
    essential: ClassVar[tuple[str, ...]] = ("period",)
    floors: ClassVar[tuple[str, ...]] = ("zeta",)

    def parameters(self, scale: Scale) -> ParameterSet:
        """The ringing period 2π/ω and the damping ratio ζ."""
        return ringing_parameters(scale, what="sensor", source=self.source)

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Lightly damped, from six samples to four times the motion's own time."""
        return ringing_starts(scale)

    def wording(self, values: Mapping[str, float]) -> Wording:
        """Well damped it does not ring, and is a smoothing filter."""
        if rings(values):
            return super().wording(values)
        return Wording(
            "Lag of second order of the sensor",
            "The reading follows the motion late without ringing, but not with one time constant: "
            "a smoothing filter, or a mean over the last samples.",
            "switch off or shorten the sensor's smoothing filter, or correct the reading for it",
        )

    def first_order(self, values: Mapping[str, float]) -> str | None:
        """Well damped it is close to a first-order lag, and closer to one beside a delay."""
        return None if rings(values) else "sensor_lag"

    def simpler(self, values: Mapping[str, float]) -> tuple[str, Mapping[str, float]] | None:
        """Overdamped it is a first-order lag."""
        lag = as_lag(values)
        return ("sensor_lag", lag) if lag is not None else None

    def differs_within(self, values: Mapping[str, float]) -> float:
        """The shorter time constant, by which it is later than that lag."""
        return shorter_time(values)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """The reading, settled at the first sample."""
        del scale
        if eta[0] <= 0.0:
            return np.array(y, np.float64)
        piece_s, motion = finer_motion(time_s, y)
        resonance(piece_s, motion, 2.0 * np.pi / float(eta[0]), float(eta[1]))
        recorded: Array = motion[::PIECES].copy()
        return recorded
