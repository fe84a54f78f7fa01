"""Laws in no catalogue, for which a cause of the catalogue may stand.

They are in no race: beside every other effect they would make ties of what a log tells apart.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import Effect, InputEffect, OutputEffect, Scale, StateEffect
from softid.kernels.filters import limit_rate
from softid.kernels.terms import FORCE
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

LARGEST = 0.8
"""Bound of what has changed by the end of the longest log, as a share of the force or the input."""

START = 0.1
"""Start of that, either way."""

SHORTEST, LONGEST = 1e-3, 0.25
"""Bounds of the time that a limit makes the whole range take: in times of the motion, and as a
share of the longest log."""

START_TIMES = (0.2, 0.7, 2.5)
"""Starts of it, in times of the motion."""

MOST_BENT = 0.9
"""Bound of what a bend adds to the slope of a reading at the ends of its range: it still rises."""

START_BENT = 0.2
"""Start of that, either way."""


@dataclass(frozen=True)
class ConstantRate(Effect):
    """What changes with the time has one parameter, the rate, of either sign."""

    shown_by: ClassVar[str] = "rests at several levels at the beginning and at the end"
    source: ClassVar[str] = "a constant rate"
    amplitude: ClassVar[str] = "rate"
    changes_sign: ClassVar[bool] = True

    @abstractmethod
    def largest(self, scale: Scale) -> tuple[float, str]:
        """The rate that changes as much as there is within the longest log, and its unit."""

    def parameters(self, scale: Scale) -> ParameterSet:
        """The rate."""
        largest, unit = self.largest(scale)
        bound, start = LARGEST * largest, START * largest
        rate = Parameter(
            "rate", start, unit, -bound, bound, meaning="rate of change", source=self.source
        )
        return ParameterSet((rate,))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Either way."""
        rate = START * self.largest(scale)[0]
        return ({"rate": rate}, {"rate": -rate})


@dataclass(frozen=True)
class LoadDrift(ConstantRate, StateEffect):
    """A load that changes at a constant rate, + f t."""

    name: ClassVar[str] = "load_drift"
    title: ClassVar[str] = "Load that changes"
    law: ClassVar[str] = "+ f t"
    meaning: ClassVar[str] = "What the actuator carries grows or shrinks at a constant rate."
    signature: ClassVar[str] = "The residual grows with time, most where the actuator is soft."
    remedy: ClassVar[str] = "weigh the load before and after"

    def largest(self, scale: Scale) -> tuple[float, str]:
        """The elastic force within the log."""
        return scale.force / scale.duration_s, f"{scale.force_unit}/s"

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Resisting force f t."""
        out[FORCE] += eta[0] * t


@dataclass(frozen=True)
class PressureGainDrift(ConstantRate, InputEffect):
    """A pressure that falls behind the recorded one more and more, u (1 + g t)."""

    name: ClassVar[str] = "pressure_gain_drift"
    title: ClassVar[str] = "Pressure that falls behind"
    law: ClassVar[str] = "arriving u = u (1 + g t)"
    meaning: ClassVar[str] = "A leak grows, or the gain of the pressure gauge drifts."
    signature: ClassVar[str] = "The residual grows with time and with the pressure."
    remedy: ClassVar[str] = "look for a leak, calibrate the gauge"

    def largest(self, scale: Scale) -> tuple[float, str]:
        """All of the pressure within the log."""
        return 1.0 / scale.duration_s, "1/s"

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Multiply by 1 + g t."""
        del scale
        arriving: Array = u * (1.0 + eta[0] * time_s)
        return arriving


@dataclass(frozen=True)
class PressureDrift(ConstantRate, InputEffect):
    """A pressure whose zero drifts, u + d t."""

    name: ClassVar[str] = "pressure_drift"
    title: ClassVar[str] = "Drift of the pressure's zero"
    law: ClassVar[str] = "arriving u = u + d t"
    meaning: ClassVar[str] = "The zero of the pressure gauge drifts at a constant rate."
    signature: ClassVar[str] = "The residual grows with time, most where the output is steep."
    remedy: ClassVar[str] = "read the gauge vented before and after"

    def largest(self, scale: Scale) -> tuple[float, str]:
        """The range of the pressure within the log."""
        return scale.u_span / scale.duration_s, f"{scale.u_unit}/s"

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Add d t."""
        del scale
        arriving: Array = u + eta[0] * time_s
        return arriving


@dataclass(frozen=True)
class RateLimit(InputEffect):
    """A pressure that never changes faster than a limit, |ṗa| ≤ u_span/time."""

    name: ClassVar[str] = "rate_limit"
    title: ClassVar[str] = "Limit of the filling rate"
    law: ClassVar[str] = "|arriving u'| <= u_span/time"
    meaning: ClassVar[str] = "A pump or a servo valve fills and vents at no more than one rate."
    signature: ClassVar[str] = "What is left after a step lasts longer the larger the step is."
    shown_by: ClassVar[str] = "steps of several sizes"
    source: ClassVar[str] = "Tao and Kokotović, Adaptive Control of Systems, Wiley 1996"
    amplitude: ClassVar[str] = "time"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The time that the whole range takes."""
        longest = max(LONGEST * scale.duration_s, scale.motion_s)
        return ParameterSet(
            (
                Parameter(
                    "time",
                    0.5 * scale.motion_s,
                    "s",
                    SHORTEST * scale.motion_s,
                    longest,
                    "log",
                    meaning="time in which the input passes through its range",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """From a fraction to a few of the motion's own times."""
        longest = self.parameters(scale)["time"].upper
        return tuple({"time": min(share * scale.motion_s, longest)} for share in START_TIMES)

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Follow the input as fast as is allowed."""
        arriving = np.array(u, np.float64)
        if eta[0] > 0.0:
            limit_rate(np.diff(time_s), arriving, scale.u_span / float(eta[0]))
        return arriving


@dataclass(frozen=True)
class BentReading(OutputEffect):
    """A sensor that is not straight, y + y_span ξ (ξ − 1) (bend + skew (ξ − ½)).

    ξ is y within its range, from 0 to 1: the ends stay, for the model takes up zero and gain.
    """

    name: ClassVar[str] = "bent_reading"
    title: ClassVar[str] = "Sensor that is not straight"
    law: ClassVar[str] = "recorded y = y + y_span xi (xi - 1) (bend + skew (xi - 1/2))"
    meaning: ClassVar[str] = (
        "The gain of the sensor differs from one end of its range to the other."
    )
    signature: ClassVar[str] = "The residual is a function of the position, at rest and in motion."
    shown_by: ClassVar[str] = "the sensor beside another one, by hand"
    source: ClassVar[str] = "Doebelin, Measurement Systems, 5th ed. 2004, §3.2"
    amplitude: ClassVar[str] = "bend"
    changes_sign: ClassVar[bool] = True

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """Both vanish together."""
        return ("bend", "skew")

    def parameters(self, scale: Scale) -> ParameterSet:
        """The two bends."""
        del scale

        def own(name: str, bound: float, meaning: str) -> Parameter:
            return Parameter(name, 0.0, "1", -bound, bound, meaning=meaning, source=self.source)

        return ParameterSet(
            (
                own(
                    "bend",
                    MOST_BENT,
                    "what the slope gains at the upper end and loses at the lower",
                ),
                own("skew", 2.0 * MOST_BENT, "twice what the slope gains at both ends"),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Bent either way."""
        del scale
        return tuple({"bend": bend, "skew": 0.0} for bend in (START_BENT, -START_BENT))

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Bend the reading between the ends of its range."""
        del time_s
        xi = (y - scale.y_low) / scale.y_span
        recorded: Array = y + scale.y_span * xi * (xi - 1.0) * (eta[0] + eta[1] * (xi - 0.5))
        return recorded


UNLISTED_LAWS: tuple[type[StateEffect | InputEffect | OutputEffect], ...] = (
    LoadDrift,
    PressureGainDrift,
    PressureDrift,
    RateLimit,
    BentReading,
)
