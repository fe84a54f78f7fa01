"""Sensor lag: the reading follows the motion late."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import OutputEffect
from softid.effects.extension.finer_motion import PIECES, finer_motion
from softid.effects.scale import Scale
from softid.effects.shared_laws.time_constants import lag_time, lag_times
from softid.kernels.filters import lag
from softid.parameters import ParameterSet

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class SensorLag(OutputEffect):
    """First-order lag of the reading, τ ẏ + y = x, for a motion straight in quarter intervals.

    Behind an actuator that is itself linear it is the same as a lag before it.

    Source: Doebelin, *Measurement Systems*, 5th ed. 2004, §3.3.
    """

    name: ClassVar[str] = "sensor_lag"
    title: ClassVar[str] = "Lag of the sensor"
    law: ClassVar[str] = "recorded y: tau y' + y = x"
    meaning: ClassVar[str] = (
        "The reading follows the motion exponentially, because the sensor or a filter behind it "
        "averages over a time of its own."
    )
    signature: ClassVar[str] = (
        "The residual is in proportion to the speed of the motion, with the same factor at every "
        "level and in both directions."
    )
    neighbours: ClassVar[tuple[str, ...]] = (
        "pneumatic_lag",
        "delay",
        "clock_rate",
        "sensor_resonance",
    )
    remedy: ClassVar[str] = (
        "switch off or shorten the sensor's smoothing filter, or correct the reading for it"
    )
    shown_by: ClassVar[str] = "a chirp beyond the bandwidth of the sensor, at two offsets"
    source: ClassVar[str] = "Doebelin, Measurement Systems, 5th ed. 2004, §3.3"
    amplitude: ClassVar[str] = "tau"
    is_linear: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The time constant τ, up to a quarter of the log."""
        meaning = "time constant with which the reading follows"
        return ParameterSet((lag_time(scale, meaning, self.source),))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """From two samples to the motion's own time."""
        return tuple({"tau": tau} for tau in lag_times(scale))

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """The lagged reading, settled at the first sample."""
        del scale
        piece_s, motion = finer_motion(time_s, y)
        lag(piece_s, motion, float(eta[0]), float(eta[0]))
        recorded: Array = motion[::PIECES].copy()
        return recorded
