"""Line resonance: the air in the tube rings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import InputEffect
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
class LineResonance(InputEffect):
    """Second-order resonance p̈a/ω² + 2ζ ṗa/ω + pa = p, exact for a straight input.

    It is written with the period 2π/ω, so that a period of zero is no resonance at all.

    Source: Bergh and Tijdeman, NLR-TR F.238, 1965.
    """

    name: ClassVar[str] = "line_resonance"
    title: ClassVar[str] = "Resonance of the supply line"
    law: ClassVar[str] = "pa''/w^2 + 2 zeta pa'/w + pa = p,  w = 2 pi/period"
    meaning: ClassVar[str] = (
        "The air in the tube and the volume behind it swing like a mass on a spring, so the "
        "actuator's pressure overshoots and rings after every fast change."
    )
    signature: ClassVar[str] = (
        "The residual rings with one frequency after every step, and turns over in a chirp where "
        "that frequency is passed."
    )
    neighbours: ClassVar[tuple[str, ...]] = (
        "pneumatic_lag",
        "delay",
        "pressure_mass",
        "sensor_lag",
        "sensor_resonance",
    )
    remedy: ClassVar[str] = (
        "shorten the tube, put a restrictor at the actuator, or record the pressure there"
    )
    shown_by: ClassVar[str] = "fast steps, or a chirp beyond the ringing frequency"
    source: ClassVar[str] = "Bergh and Tijdeman, NLR-TR F.238, 1965"
    amplitude: ClassVar[str] = "period"
    is_linear: ClassVar[bool] = True
    essential: ClassVar[tuple[str, ...]] = ("period",)
    floors: ClassVar[tuple[str, ...]] = ("zeta",)

    def parameters(self, scale: Scale) -> ParameterSet:
        """The ringing period 2π/ω and the damping ratio ζ."""
        return ringing_parameters(scale, what="line", source=self.source)

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Lightly damped, from six samples to four times the motion's own time."""
        return ringing_starts(scale)

    def wording(self, values: Mapping[str, float]) -> Wording:
        """Well damped it does not ring, and is a lag of second order."""
        if rings(values):
            return super().wording(values)
        return Wording(
            "Lag of second order of the supply line",
            "The actuator's pressure follows the recorded one late without ringing, but not with "
            "one time constant: the air passes several restrictions and volumes one after the "
            "other, or a long tube.",
            "shorten or widen the tube, or record the pressure at the actuator",
        )

    def first_order(self, values: Mapping[str, float]) -> str | None:
        """Well damped it is close to a first-order lag, and closer to one beside a delay."""
        return None if rings(values) else "pneumatic_lag"

    def simpler(self, values: Mapping[str, float]) -> tuple[str, Mapping[str, float]] | None:
        """Overdamped it is a first-order lag."""
        lag = as_lag(values)
        return ("pneumatic_lag", lag) if lag is not None else None

    def differs_within(self, values: Mapping[str, float]) -> float:
        """The shorter time constant, by which it is later than that lag."""
        return shorter_time(values)

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The ringing input."""
        del scale
        arriving = np.array(u, np.float64)
        if eta[0] > 0.0:
            resonance(np.diff(time_s), arriving, 2.0 * np.pi / float(eta[0]), float(eta[1]))
        return arriving
