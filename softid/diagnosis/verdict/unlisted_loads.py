"""Laws in no catalogue of what hangs on the actuator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.diagnosis.verdict.unlisted_readings import MOST_DAMPED, SWINGING
from softid.effects import effect_of
from softid.effects.base import OutputEffect
from softid.effects.scale import Scale
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

MOST_HELD, START_HELD = 0.9, 0.2
"""Bound and start of the share of a fast move that a swinging load keeps back: a load as heavy as
the actuator that swings at a third of its frequency keeps back a tenth, one of ten times its weight
half."""

SLOWER = (5.0, 8.0, 11.0, 16.0, 22.0, 32.0)
"""Starts of the period in times of the motion: what swings faster than the actuator is carried
along."""


@dataclass(frozen=True)
class SwingingLoad(OutputEffect):
    """A load that swings on the actuator, which then moves to (1 − c) x + c r + 2d ṙ/ω.

    r obeys r̈/ω² + 2ζ ṙ/ω + r = x, with ω = 2π/period, where x is the motion with the load held
    still. A mass on a spring with a damper, carried by a linear actuator of second order, gives a
    numerator and a denominator of one order more each in s², which this is; over an actuator whose
    stiffness goes with the pressure it holds about one pressure.

    Source: Den Hartog, *Mechanical Vibrations*, 4th ed. 1956, §3.2 (auxiliary mass on a spring).
    """

    name: ClassVar[str] = "swinging_load"
    title: ClassVar[str] = "Load that swings"
    law: ClassVar[str] = (
        "y = (1 - c) x + c r + 2 d r'/w,  r''/w^2 + 2 zeta r'/w + r = x, w = 2 pi/period"
    )
    meaning: ClassVar[str] = (
        "What hangs on the actuator swings after every move, and pulls the actuator with it."
    )
    signature: ClassVar[str] = "The residual rings slowly with one frequency after every move."
    remedy: ClassVar[str] = "the same load clamped to the tip"
    shown_by: ClassVar[str] = (
        "a push against the load, and one against what is read, while the pressure is held"
    )
    source: ClassVar[str] = "Den Hartog, Mechanical Vibrations, 4th ed. 1956, §3.2"
    amplitude: ClassVar[str] = "c"

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """Both vanish together."""
        return ("c", "d")

    def parameters(self, scale: Scale) -> ParameterSet:
        """The share that is kept back, the period, and the damping ratios of poles and zeros."""
        swinging = effect_of(SWINGING).parameters(scale)
        held = Parameter(
            "c",
            START_HELD,
            "1",
            0.0,
            MOST_HELD,
            meaning="share of a fast move that the load keeps back",
            source=self.source,
        )
        own = Parameter(
            "d",
            0.0,
            "1",
            -MOST_DAMPED,
            MOST_DAMPED,
            meaning="damping ratio of the load alone, less (1 - c) zeta",
            source=self.source,
        )
        damping = replace(swinging["zeta"], upper=MOST_DAMPED)
        return ParameterSet((held, swinging["period"], damping, own))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Periods slower than the motion's own."""
        declared = self.parameters(scale)
        period, usual = declared["period"], {name: declared[name].value for name in declared.names}
        wanted = np.clip(np.array(SLOWER) * scale.motion_s, period.lower, period.upper)
        return tuple({**usual, "period": t} for t in np.unique(wanted).tolist())

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """The motion with the load that swings, settled at the first sample."""
        load = effect_of(SWINGING)
        assert isinstance(load, OutputEffect)
        swung = load.apply(eta[1:3], time_s, y, scale)
        moved: Array = (1.0 - eta[0]) * y + eta[0] * swung
        moved += float(eta[3] * eta[1]) / np.pi * np.gradient(swung, time_s)
        return moved
