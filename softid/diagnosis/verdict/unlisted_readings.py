"""Laws of the records in no catalogue: clocks that differ, filters, sensors with other inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.diagnosis.verdict.unlisted_drifts import one_parameter
from softid.effects import effect_of
from softid.effects.base import InputEffect, OutputEffect
from softid.effects.scale import Scale
from softid.kernels.earlier_input import read_at
from softid.kernels.filters import lag
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

EARLIEST = 0.1
"""Bound of the time by which a reading runs ahead, as a share of the longest log."""

MOST_SAMPLES, START_SAMPLES = 200.0, (4.0, 16.0)
"""Bound and starts of the time over which an input is smoothed, in sampling intervals."""

SHARPENINGS = 3
"""Times that what smoothing took away is added: of a course of twice the window's time the first
leaves an eighth missing, the third a sixtieth."""

MOST_FELT, START_FELT = 1.0, (0.03, -0.03)
"""Bound and starts of what a sensor makes of the whole range of the pressure, as a share of its
own."""

MOST_SWINGING, START_SWINGING = 0.6, 0.2
"""Bound and start of the part of a reading that swings by itself; the whole of it is a sensor on a
flexible mount."""

MOST_DAMPED = 0.3
"""Bound of the damping ratio of what swings; a part that is damped more is about a lag."""

MEAN = "smoothing.mean"
"""Key of the effect that smooths a reading as such a record of the input was."""

SWINGING = "sensor_resonance"
"""Key of the effect that has the whole reading swing, as a load does, too."""

UNEVEN = "pneumatic_lag.separate"
"""Key of the effect that does to the input what an uneven sensor does to the reading."""


@dataclass(frozen=True)
class EarlyReading(OutputEffect):
    """A reading that runs ahead of the recorded input, y(t + s)."""

    name: ClassVar[str] = "early_reading"
    title: ClassVar[str] = "Reading that runs ahead"
    law: ClassVar[str] = "recorded y(t) = x(t + s)"
    meaning: ClassVar[str] = "The clocks are offset, or the pressure is recorded late."
    signature: ClassVar[str] = "The residual goes with the speed; the output moves first."
    remedy: ClassVar[str] = "both channels with one clock, and the pressure with a faster gauge"
    shown_by: ClassVar[str] = "fast steps"
    source: ClassVar[str] = "a constant offset of the clocks"
    amplitude: ClassVar[str] = "s"

    def parameters(self, scale: Scale) -> ParameterSet:
        """By how much it runs ahead, up to a tenth of the log."""
        longest = max(EARLIEST * scale.duration_s, scale.motion_s)
        return one_parameter(
            "s", 0.3 * scale.motion_s, "s", 0.0, longest, "time ahead", self.source
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Fractions of the motion's own time."""
        return tuple({"s": share * scale.motion_s} for share in (0.1, 0.4))

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Read what comes later; the end goes on as it was going."""
        del scale
        last = (y[-1] - y[-2]) / (time_s[-1] - time_s[-2])
        later = time_s + eta[0]
        beyond = last * np.maximum(later - time_s[-1], 0.0)
        recorded = np.empty(y.size)
        read_at(later, time_s, y, recorded)
        recorded += beyond
        return recorded


@dataclass(frozen=True)
class LateGauge(InputEffect):
    """A gauge that follows the pressure late, as a lag: what drives the actuator is u + τ u̇."""

    name: ClassVar[str] = "gauge_lag"
    title: ClassVar[str] = "Pressure gauge that lags behind"
    law: ClassVar[str] = "arrives u + tau u'"
    meaning: ClassVar[str] = "The gauge sits behind a long tube or a filter of its own."
    signature: ClassVar[str] = "The residual goes with the rate of the input; the output leads."
    remedy: ClassVar[str] = "a faster gauge, at the actuator itself"
    shown_by: ClassVar[str] = "fast steps"
    source: ClassVar[str] = "a first-order lag, solved for what it lags behind"
    amplitude: ClassVar[str] = "tau"

    def parameters(self, scale: Scale) -> ParameterSet:
        """Time constant of the gauge, as that of a lag."""
        tau = effect_of("pneumatic_lag").parameters(scale)["tau"]
        return ParameterSet(
            (replace(tau, meaning="time constant of the gauge", source=self.source),)
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Fractions of the motion's own time."""
        return tuple({"tau": share * scale.motion_s} for share in (0.1, 0.4))

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Add the rate of the input, the mean of those before and after a corner."""
        del scale
        arriving: Array = u + float(eta[0]) * np.gradient(u, time_s)
        return arriving


@dataclass(frozen=True)
class SmoothedInput(InputEffect):
    """A pressure whose record was smoothed afterwards, u = S p with the mean S over w.

    What arrives is Σ (1 − S)ᵏ u for k up to `SHARPENINGS`, which differs from p by the next power
    only.

    Source: van Cittert, *Zeitschrift für Physik* 69, 298 (1931).
    """

    name: ClassVar[str] = "smoothed_input"
    title: ClassVar[str] = "Pressure that was smoothed"
    law: ClassVar[str] = "recorded u(t) = mean of p from t - w/2 to t + w/2"
    meaning: ClassVar[str] = (
        "The pressure was filtered there and back, or averaged, after it was recorded."
    )
    signature: ClassVar[str] = "The residual goes with the bends of the pressure, before and after."
    remedy: ClassVar[str] = "the same record as it was before any filter"
    shown_by: ClassVar[str] = "fast steps without any filter"
    source: ClassVar[str] = "van Cittert, Zeitschrift für Physik 69, 298 (1931)"
    amplitude: ClassVar[str] = "w"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The width of the window."""
        start, longest = (n * scale.period_s for n in (START_SAMPLES[0], MOST_SAMPLES))
        return one_parameter("w", start, "s", 0.0, longest, "window", self.source)

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """A few samples, and more of them."""
        return tuple({"w": n * scale.period_s} for n in START_SAMPLES)

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Add what smoothing takes away, again and again."""
        mean = effect_of(MEAN)
        assert isinstance(mean, OutputEffect)
        arriving = np.array(u, np.float64)
        for _ in range(SHARPENINGS if eta[0] > 0.0 else 0):
            arriving += u - mean.apply(eta, time_s, arriving, scale)
        return arriving


@dataclass(frozen=True)
class UnevenReading(OutputEffect):
    """A sensor that lags by one time upward and by another one downward, τ ẏ + y = x."""

    name: ClassVar[str] = "uneven_reading"
    title: ClassVar[str] = "Sensor that lags unevenly"
    law: ClassVar[str] = (
        "recorded y: tau y' + y = x while it rises, ratio tau y' + y = x while it falls"
    )
    meaning: ClassVar[str] = "The sensor follows the motion faster one way than the other."
    signature: ClassVar[str] = "The residual goes with the speed, by another factor up than down."
    remedy: ClassVar[str] = "a sensor that is clamped so that it is pulled both ways alike"
    shown_by: ClassVar[str] = "steps up and down between the same levels"
    source: ClassVar[str] = "Doebelin, Measurement Systems, 5th ed. 2004, §3.3"
    amplitude: ClassVar[str] = "tau"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The time upward, and the one downward as a multiple of it."""
        return effect_of(UNEVEN).parameters(scale)

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Two times, each faster and slower downward."""
        return effect_of(UNEVEN).starts(scale)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """The reading lagged by the time of its direction, settled at the first sample."""
        del scale
        recorded = np.array(y, np.float64)
        lag(np.diff(time_s), recorded, float(eta[0]), float(eta[0] * eta[1]))
        return recorded


@dataclass(frozen=True)
class Feedthrough(OutputEffect):
    """A sensor that also answers to the input, y + g y_span (u − u_low)/u_span.

    The model's zero takes up the constant part. The parameter g may have either sign.
    """

    name: ClassVar[str] = "feedthrough"
    title: ClassVar[str] = "Sensor that answers to the pressure"
    law: ClassVar[str] = "recorded y = x + g y_span (u - u_low)/u_span"
    meaning: ClassVar[str] = (
        "The pressure stretches or heats the sensor itself, or its wires pick up the valve, so "
        "part of the reading comes at once."
    )
    signature: ClassVar[str] = "The residual goes with the pressure, and jumps where it does."
    remedy: ClassVar[str] = "the sensor beside a camera, with the actuator held fast"
    shown_by: ClassVar[str] = "steps of the pressure with the actuator held fast"
    source: ClassVar[str] = "Ljung, System Identification, 2nd ed. 1999, §4.3 (direct term D)"
    amplitude: ClassVar[str] = "g"
    changes_sign: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """What the sensor makes of the range of the pressure."""
        del scale
        return one_parameter("g", 0.0, "1", -MOST_FELT, MOST_FELT, "share of range", self.source)

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Either sign."""
        del scale
        return tuple({"g": share} for share in START_FELT)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """The reading under a pressure that stays at the lower end of its range."""
        del eta, time_s, scale
        return np.array(y, np.float64)

    def recorded(self, eta: Array, time_s: Array, y: Array, u: Array, scale: Scale) -> Array:
        """Add what the sensor makes of the pressure."""
        del time_s
        felt: Array = y + eta[0] * scale.y_span / scale.u_span * (u - scale.u_low)
        return felt


@dataclass(frozen=True)
class SwingingPart(OutputEffect):
    """A reading a part of which follows the motion in second order, (1 − c) y + c r(y).

    r obeys r̈/ω² + 2ζ ṙ/ω + r = y, with ω = 2π/period.
    """

    name: ClassVar[str] = "swinging_part"
    title: ClassVar[str] = "Part of the reading that swings"
    law: ClassVar[str] = (
        "recorded y = (1 - c) x + c r,  r''/w^2 + 2 zeta r'/w + r = x, w = 2 pi/period"
    )
    meaning: ClassVar[str] = (
        "The marker or the tip that carries it swings on what is bent, as a second mode does."
    )
    signature: ClassVar[str] = "The residual rings with one frequency after every fast motion."
    remedy: ClassVar[str] = "a marker nearer to the base, or a stiffer tip"
    shown_by: ClassVar[str] = "a blow against the tip while the pressure is held"
    source: ClassVar[str] = "Doebelin, Measurement Systems, 5th ed. 2004, §3.3 (second order)"
    amplitude: ClassVar[str] = "c"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The part that swings, its period and its damping ratio."""
        swinging = effect_of(SWINGING).parameters(scale)
        part = Parameter(
            "c",
            START_SWINGING,
            "1",
            0.0,
            MOST_SWINGING,
            meaning="part that swings",
            source=self.source,
        )
        damping = replace(swinging["zeta"], upper=MOST_DAMPED)
        return ParameterSet((part, swinging["period"], damping))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """A fifth of it, with the periods at which the whole of it would be looked for."""
        whole = effect_of(SWINGING).starts(scale)
        return tuple({"c": START_SWINGING, **start} for start in whole)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """The reading with the part that swings, settled at the first sample."""
        whole = effect_of(SWINGING)
        assert isinstance(whole, OutputEffect)
        recorded: Array = (1.0 - eta[0]) * y + eta[0] * whole.apply(eta[1:], time_s, y, scale)
        return recorded
