"""Laws of the supply in no catalogue, for which a lag, a valve, a delay or a curve may stand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects import effect_of
from softid.effects.base import InputEffect
from softid.effects.scale import Scale
from softid.kernels.earlier_input import largest_between
from softid.kernels.filters import lag_with_relief, limit_rate
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

SHORTEST_TIMES, LONGEST_SHARE = 1e-3, 0.25
"""Bounds of the time that a limit makes the whole range take: in times of the motion, and as a
share of the longest log."""

START_TIMES = (0.1, 0.2, 0.4, 0.7, 1.1, 1.7, 2.5, 4.0)
"""Starts of the time that a limit makes the whole range take, in times of the motion. Of
three that lay further apart the best one led to a false optimum; each costs one simulation."""

RATE_RATIOS = (0.1, 10.0)
"""Bounds of the time that a limit takes downward, in those upward: beyond them one way has none."""

LEAST_LOST, MOST_LOST, START_LOST = 1e-3, 20.0, 0.3
"""Bounds and start of what a leak loses of the pressure beyond that at which it opens."""

LIMITED_AT = (0.5, 0.75, 0.9)
"""Starts of the pressure that a supply does not exceed, as shares of the input's range."""

CORNER_WIDTH = 0.005
"""Width of the corner at the pressure that a supply does not exceed, as a share of the range: an
edge has no slope to follow."""

START_DELAYS = (0.1, 0.4)
"""Starts of the shorter and the longer of two delays, in times of the motion."""

OPENS_AT = (0.3, 0.6)
"""Starts of the pressure at which a leak opens, as shares of the input's range."""


@dataclass(frozen=True)
class RateLimit(InputEffect):
    """A pressure that never changes faster than a limit, −u_span/(ratio time) ≤ ṗa ≤ u_span/time.

    A regulator fills through one seat and vents through another.
    """

    name: ClassVar[str] = "rate_limit"
    title: ClassVar[str] = "Limit of the filling rate"
    law: ClassVar[str] = "-u_span/(ratio time) <= arriving u' <= u_span/time"
    meaning: ClassVar[str] = "A pump or a servo valve fills and vents at no more than some rate."
    signature: ClassVar[str] = "What is left after a step lasts longer the larger the step is."
    shown_by: ClassVar[str] = "steps of several sizes"
    source: ClassVar[str] = "Tao and Kokotović, Adaptive Control of Systems, Wiley 1996"
    amplitude: ClassVar[str] = "time"
    plain_at: ClassVar[tuple[str, float] | None] = ("ratio", 1.0)

    def parameters(self, scale: Scale) -> ParameterSet:
        """The time that the whole range takes upward, and that downward as a multiple of it."""
        longest = max(LONGEST_SHARE * scale.duration_s, scale.motion_s)
        return ParameterSet(
            (
                Parameter(
                    "time",
                    0.5 * scale.motion_s,
                    "s",
                    SHORTEST_TIMES * scale.motion_s,
                    longest,
                    "log",
                    meaning="time in which the input rises through its range",
                    source=self.source,
                ),
                Parameter(
                    "ratio",
                    1.0,
                    "1",
                    *RATE_RATIOS,
                    "log",
                    meaning="time in which it falls over that in which it rises",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """From a fraction to a few of the motion's own times, as fast up as down."""
        longest = self.parameters(scale)["time"].upper
        times = [min(share * scale.motion_s, longest) for share in START_TIMES]
        return tuple({"time": time_s, "ratio": 1.0} for time_s in times)

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Follow the input as fast as is allowed."""
        arriving, (rise_s, ratio) = np.array(u, np.float64), eta.tolist()
        if rise_s > 0.0:
            rising = scale.u_span / rise_s
            limit_rate(np.diff(time_s), arriving, rising, rising / ratio)
        return arriving


@dataclass(frozen=True)
class ReliefLeak(InputEffect):
    """A leak above a pressure behind a restriction, τ ṗa + pa + ℓ max(pa − p0, 0) = p.

    Below p0 it is a lag, above it a shorter one of a smaller gain: a bend of the static curve and a
    lag that differs by level, both at one pressure.
    """

    name: ClassVar[str] = "relief_leak"
    title: ClassVar[str] = "Leak above a pressure"
    law: ClassVar[str] = "tau pa' + pa + lost max(pa - opens, 0) = p"
    meaning: ClassVar[str] = "A relief valve opens, or a fitting or a seam gives way."
    signature: ClassVar[str] = "The curve bends at one pressure, above which all is quicker, too."
    remedy: ClassVar[str] = "listen for a leak at the highest pressure, and watch a closed line"
    shown_by: ClassVar[str] = "steps to levels below and above the pressure at which it opens"
    source: ClassVar[str] = "Andersen, The Analysis and Design of Pneumatic Systems, Wiley 1967"
    amplitude: ClassVar[str] = "lost"
    essential: ClassVar[tuple[str, ...]] = ("opens",)

    def parameters(self, scale: Scale) -> ParameterSet:
        """Time constant of the restriction, pressure at which the leak opens, and what it loses."""
        range_ = scale.u_low, scale.u_high
        begin = scale.u_low + OPENS_AT[0] * scale.u_span
        tau = effect_of("pneumatic_lag").parameters(scale)["tau"]
        opens = Parameter("opens", begin, scale.u_unit, *range_)
        lost = Parameter("lost", START_LOST, "1", LEAST_LOST, MOST_LOST, "log")
        return ParameterSet(
            (
                replace(tau, meaning="time constant below the leak", source=self.source),
                replace(opens, meaning="pressure at which it opens", source=self.source),
                replace(lost, meaning="part of the pressure beyond that", source=self.source),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Short and long times, and a leak that opens in either half of the range."""
        lags = effect_of("pneumatic_lag").starts(scale)
        return tuple(
            {**lag, "opens": scale.u_low + share * scale.u_span, "lost": START_LOST}
            for lag, share in product(lags, OPENS_AT)
        )

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The lagged input less what leaks."""
        del scale
        arriving = np.array(u, np.float64)
        lag_with_relief(np.diff(time_s), arriving, *(float(value) for value in eta))
        return arriving

    def bends_in_s(self, eta: Array) -> float:
        """The time constant above the leak."""
        return float(eta[0] / (1.0 + eta[2]))


@dataclass(frozen=True)
class InputLimit(InputEffect):
    """A pressure that never exceeds a limit, pa = min(p, top), with a corner of a small width."""

    name: ClassVar[str] = "input_limit"
    title: ClassVar[str] = "Limit of the supply"
    law: ClassVar[str] = "arriving u = min(u, top)"
    meaning: ClassVar[str] = "The supply or the regulator gives no more than a pressure."
    signature: ClassVar[str] = "Nothing moves above one pressure, however quickly it is passed."
    remedy: ClassVar[str] = "the pressure at the actuator itself, at the highest command"
    shown_by: ClassVar[str] = "levels close to each other at the upper end of the range"
    source: ClassVar[str] = "Tao and Kokotović, Adaptive Control of Systems, Wiley 1996"
    amplitude: ClassVar[str] = "top"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The pressure that is not exceeded."""
        top = Parameter("top", scale.u_high, scale.u_unit, scale.u_low, scale.u_high)
        return ParameterSet((replace(top, meaning="largest pressure", source=self.source),))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """At several levels in the upper half of the range."""
        return tuple({"top": scale.u_low + share * scale.u_span} for share in LIMITED_AT)

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The input up to the limit."""
        del time_s
        width = CORNER_WIDTH * scale.u_span
        arriving: Array = u - width * np.logaddexp(0.0, (u - eta[0]) / width)
        return arriving


@dataclass(frozen=True)
class UnevenDelay(InputEffect):
    """A delay that differs by direction, pa(t) = p(t − up) on the way up, p(t − down) on that down.

    It is the largest of what was between both times before, or the least if down is the shorter.
    """

    name: ClassVar[str] = "uneven_delay"
    title: ClassVar[str] = "Delay that differs by direction"
    law: ClassVar[str] = (
        "arriving u(t) = max of u from t - down to t - up; where down is the shorter, min of u "
        "from t - up to t - down"
    )
    meaning: ClassVar[str] = "A valve takes another time to open than to close."
    signature: ClassVar[str] = "A short pulse after every change, of another length up than down."
    remedy: ClassVar[str] = "the pressure at the actuator itself"
    shown_by: ClassVar[str] = "fast steps up and down between the same levels"
    source: ClassVar[str] = "two constant delays"
    amplitude: ClassVar[str] = "up"

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """Both vanish together."""
        return ("up", "down")

    def parameters(self, scale: Scale) -> ParameterSet:
        """Both delays."""
        declared = effect_of("delay").parameters(scale)["tau"]
        return ParameterSet(
            tuple(
                replace(declared, name=name, meaning=f"delay on the way {name}", source=self.source)
                for name in self.amplitudes
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Either is the longer."""
        longest = self.parameters(scale)["up"].upper
        delays = [min(share * scale.motion_s, 0.5 * longest) for share in START_DELAYS]
        return tuple({"up": up, "down": down} for up, down in (delays, reversed(delays)))

    def simpler(self, values: Mapping[str, float]) -> tuple[str, Mapping[str, float]] | None:
        """A delay by the mean of both."""
        return "delay", {"tau": 0.5 * (values["up"] + values["down"])}

    def differs_within(self, values: Mapping[str, float]) -> float:
        """The time by which one delay is longer than the other."""
        return abs(values["up"] - values["down"])

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The input that has arrived by then."""
        del scale
        later, sign = max(eta), (1.0 if eta[1] >= eta[0] else -1.0)
        arriving = np.empty(u.size)
        largest_between(time_s - later, time_s - min(eta), time_s, sign * u, arriving)
        arriving *= sign
        return arriving
