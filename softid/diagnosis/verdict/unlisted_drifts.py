"""Laws in no catalogue that go with the time."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import exp
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import Effect, InputEffect, OutputEffect, StateEffect
from softid.effects.scale import Scale
from softid.kernels.terms import DAMPING, FORCE, RATE, STIFFNESS
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

LARGEST_CHANGE = 0.8
"""Bound of what has changed by the end of the longest log, as a share of the force or the input."""

STARTING_CHANGE = 0.1
"""Start of what has changed by the end of the longest log, either way."""

SETTLING_BOUNDS, SETTLING_STARTS = (0.03, 1.0), (0.1, 0.3)
"""Bounds and starts of a time in which something settles, as shares of the longest log."""

PATH_BOUNDS = (0.01, 3.0)
"""Bounds of a path over which something is lost, as shares of the whole one."""

LEAST_LOSS = 1e-4
"""Least share of a stiffness that is lost."""


def one_parameter(
    name: str, value: float, unit: str, lower: float, upper: float, meaning: str, source: str
) -> ParameterSet:
    """A single parameter on a linear scale."""
    return ParameterSet(
        (Parameter(name, value, unit, lower, upper, meaning=meaning, source=source),)
    )


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
        bound, start = LARGEST_CHANGE * largest, STARTING_CHANGE * largest
        return one_parameter("rate", start, unit, -bound, bound, "rate of change", self.source)

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Two starts: a rate of either sign."""
        rate = STARTING_CHANGE * self.largest(scale)[0]
        return ({"rate": rate}, {"rate": -rate})


@dataclass(frozen=True)
class LoadDrift(ConstantRate, StateEffect):
    """A load that changes at a constant rate r, + r t."""

    name: ClassVar[str] = "load_drift"
    title: ClassVar[str] = "Load that changes"
    law: ClassVar[str] = "+ rate t"
    meaning: ClassVar[str] = "What the actuator carries grows or shrinks at a constant rate."
    signature: ClassVar[str] = "The residual grows with time, most where the actuator is soft."
    remedy: ClassVar[str] = "weigh the load before and after"

    def largest(self, scale: Scale) -> tuple[float, str]:
        """The elastic force within the log."""
        return scale.force / scale.duration_s, f"{scale.force_unit}/s"

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Resisting force r t."""
        out[FORCE] += eta[0] * t


@dataclass(frozen=True)
class PressureGainDrift(ConstantRate, InputEffect):
    """A pressure that falls behind the recorded one more and more, u (1 + r t)."""

    name: ClassVar[str] = "pressure_gain_drift"
    title: ClassVar[str] = "Pressure that falls behind"
    law: ClassVar[str] = "arriving u = u (1 + rate t)"
    meaning: ClassVar[str] = "A leak grows, or the gain of the pressure gauge drifts."
    signature: ClassVar[str] = "The residual grows with time and with the pressure."
    remedy: ClassVar[str] = "look for a leak, calibrate the gauge"

    def largest(self, scale: Scale) -> tuple[float, str]:
        """All of the pressure within the log."""
        return 1.0 / scale.duration_s, "1/s"

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Multiply by 1 + r t."""
        del scale
        arriving: Array = u * (1.0 + eta[0] * time_s)
        return arriving


@dataclass(frozen=True)
class PressureDrift(ConstantRate, InputEffect):
    """A pressure whose zero drifts, u + r t."""

    name: ClassVar[str] = "pressure_drift"
    title: ClassVar[str] = "Drift of the pressure's zero"
    law: ClassVar[str] = "arriving u = u + rate t"
    meaning: ClassVar[str] = "The zero of the pressure gauge drifts at a constant rate."
    signature: ClassVar[str] = "The residual grows with time, most where the output is steep."
    remedy: ClassVar[str] = "read the gauge vented before and after"

    def largest(self, scale: Scale) -> tuple[float, str]:
        """The range of the pressure within the log."""
        return scale.u_span / scale.duration_s, f"{scale.u_unit}/s"

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Add r t."""
        del scale
        arriving: Array = u + eta[0] * time_s
        return arriving


@dataclass(frozen=True)
class DampingDrift(ConstantRate, StateEffect):
    """A damping that changes at a constant rate, (1 + r t) times the model's."""

    name: ClassVar[str] = "damping_drift"
    title: ClassVar[str] = "Damping that changes"
    law: ClassVar[str] = "damping (1 + rate t)"
    meaning: ClassVar[str] = "A passage clogs or widens, a lubricant warms up."
    signature: ClassVar[str] = "The residual after a step grows or shrinks with time."
    remedy: ClassVar[str] = "repeat the first steps at the end"
    shown_by: ClassVar[str] = "the same steps at the beginning and at the end"

    def largest(self, scale: Scale) -> tuple[float, str]:
        """All of it within the log."""
        return 1.0 / scale.duration_s, "1/s"

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Relative change r t of the damping."""
        out[DAMPING] += eta[0] * t


@dataclass(frozen=True)
class Settling(Effect):
    """What gains a share with the time and settles has the share, of either sign, and the time."""

    source: ClassVar[str] = "first order"
    amplitude: ClassVar[str] = "share"
    counts_position: ClassVar[bool] = True
    essential: ClassVar[tuple[str, ...]] = ("tau",)
    changes_sign: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The share s that is gained at last, and the time τ."""
        start, most = STARTING_CHANGE, LARGEST_CHANGE
        gained = one_parameter("share", start, "1", -most, most, "gained at last", self.source)
        tau = _settling_time(scale, "time in which it settles", self.source)
        return ParameterSet((*gained.values(), tau))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Either way, within a tenth or a third of the log."""
        times = [share * scale.duration_s for share in SETTLING_STARTS]
        return tuple(
            {"share": s, "tau": tau} for s in (STARTING_CHANGE, -STARTING_CHANGE) for tau in times
        )


@dataclass(frozen=True)
class SettlingStiffness(Settling, StateEffect):
    """A stiffness that settles with the time, (1 + s (1 − e^{−t/τ})) times the model's."""

    name: ClassVar[str] = "settling_stiffness"
    title: ClassVar[str] = "Stiffness that settles"
    law: ClassVar[str] = "Q (1 + share (1 - exp(-t/tau)))"
    meaning: ClassVar[str] = "The actuator warms up or is worn in, and then stays as it is."
    signature: ClassVar[str] = "The residual grows with the position, at first and then no more."
    remedy: ClassVar[str] = "let it settle before the log begins"
    shown_by: ClassVar[str] = "the same two levels again and again, for long"

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Relative change of the stiffness."""
        out[STIFFNESS] += eta[0] * (1.0 - exp(-t / eta[1]))


@dataclass(frozen=True)
class SettlingGain(Settling, OutputEffect):
    """A gain of the sensor that settles with the time, y (1 + s (1 − e^{−t/τ})).

    At rest it is what a stiffness that settles does; in motion that changes the time constant, too.
    """

    name: ClassVar[str] = "settling_gain"
    title: ClassVar[str] = "Gain of the sensor that settles"
    law: ClassVar[str] = "recorded y = x (1 + share (1 - exp(-t/tau)))"
    meaning: ClassVar[str] = "The sensor warms up, and then reads as it does."
    signature: ClassVar[str] = "The residual grows with the reading, at first and then no more."
    remedy: ClassVar[str] = "switch the sensor on long before the log begins"
    shown_by: ClassVar[str] = "the same fast steps again and again, for long"
    begins_with_log: ClassVar[bool] = True
    is_linear: ClassVar[bool] = True

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Multiply by 1 + s (1 − e^{−t/τ})."""
        del scale
        grown: Array = y * (1.0 - eta[0] * np.expm1(-time_s / eta[1]))
        return grown


@dataclass(frozen=True)
class SettlingPressure(Settling, InputEffect):
    """A zero of the pressure gauge that settles with the time, u + s u_span (1 − e^{−t/τ}).

    In a linear model it is what a sensor's zero that settles does; a bent curve tells them apart.
    """

    name: ClassVar[str] = "settling_pressure"
    title: ClassVar[str] = "Zero of the pressure gauge that settles"
    law: ClassVar[str] = "arriving u = u + share u_span (1 - exp(-t/tau))"
    meaning: ClassVar[str] = "The pressure gauge warms up, and then reads as it does."
    signature: ClassVar[str] = "The residual wanders at first, most where the output is steep."
    remedy: ClassVar[str] = "switch the gauge on long before the log begins"
    shown_by: ClassVar[str] = "rests at several levels at the beginning and at the end"
    counts_position: ClassVar[bool] = False

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Add s u_span (1 − e^{−t/τ})."""
        arriving: Array = u - eta[0] * scale.u_span * np.expm1(-time_s / eta[1])
        return arriving


@dataclass(frozen=True)
class RecoveringSoftening(StateEffect):
    """A softening by use that goes back at rest, Q (1 − s (1 − e^{−w})), ẇ = |v|/W0 − w/τ."""

    name: ClassVar[str] = "recovering_softening"
    title: ClassVar[str] = "Softening that recovers"
    law: ClassVar[str] = "Q (1 - share (1 - exp(-w))),  w' = |v|/W0 - w/tau"
    meaning: ClassVar[str] = "The actuator warms up while it moves, and cools down while it rests."
    signature: ClassVar[str] = (
        "The residual grows with the position after much motion, not at rest."
    )
    remedy: ClassVar[str] = "let it cool down between the moves, or cycle it until it stays warm"
    shown_by: ClassVar[str] = "the same moves after a long rest and after many others"
    source: ClassVar[str] = "first order"
    amplitude: ClassVar[str] = "share"
    counts_position: ClassVar[bool] = True
    essential: ClassVar[tuple[str, ...]] = ("tau",)
    has_state: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The share s that is lost at most, the path W0 over which it goes, and the time τ."""
        least, most = (share * scale.travel for share in PATH_BOUNDS)
        share = Parameter(
            "share", STARTING_CHANGE, "1", LEAST_LOSS, LARGEST_CHANGE, "log", meaning="lost at most"
        )
        path = Parameter("W0", (least * most) ** 0.5, scale.x_unit, least, most, "log")
        return ParameterSet(
            (
                replace(share, source=self.source),
                replace(path, meaning="path over which it is lost", source=self.source),
                _settling_time(scale, "time in which it comes back at rest", self.source),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """As much as the mean speed holds up, within a tenth or a third of the log."""
        return tuple(
            {
                "share": 2.0 * STARTING_CHANGE,
                "W0": share * scale.travel,
                "tau": share * scale.duration_s,
            }
            for share in SETTLING_STARTS
        )

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Relative change of the stiffness, and what has been gone and is not forgotten."""
        out[STIFFNESS] -= eta[0] * (1.0 - exp(-z))
        out[RATE] += abs(v) / eta[1] - z / eta[2]


def _settling_time(scale: Scale, meaning: str, source: str) -> Parameter:
    shortest, longest = (share * scale.duration_s for share in SETTLING_BOUNDS)
    middle = (shortest * longest) ** 0.5
    return Parameter("tau", middle, "s", shortest, longest, "log", meaning=meaning, source=source)
