"""Laws in no catalogue that remember: another creep, and hystereses that stand beside one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, cast

import numpy as np
import numpy.typing as npt

from softid.diagnosis.verdict.unlisted_drifts import one_parameter
from softid.effects import effect_of
from softid.effects.base import LEAST_AMPLITUDE, SHARPEST_BEND, OutputEffect, StateEffect
from softid.effects.scale import Scale
from softid.kernels.terms import FORCE, RATE
from softid.kernels.way_memory import loop
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

CREEP, HYSTERESIS = (cast(StateEffect, effect_of(name)) for name in ("creep", "hysteresis"))

LEAST_GAIN, MOST_GAIN = -0.9, 30.0
"""Bounds of what a loop gains over the range of positions, as a share of it at the lower end."""

MOST_HEIGHT, START_HEIGHT = 0.6, 0.04
"""Bound and start of the half height of a sensor's loop, as a share of the range, as of a play."""

LONGEST, DISTANCES = 2.0, (0.01, 0.05, 0.25)
"""Bound and starts of the distance over which it changes branch, in ranges, as of a hysteresis."""

CREEP_TIMES = (0.01, 0.03, 0.1, 0.3, 0.6)
"""Starts of the time of a second creep, as shares of the log."""


@dataclass(frozen=True)
class SecondCreep(StateEffect):
    """Creep of another time beside a creep, + k (x − z) with τ ż = x − z.

    What a material gives way by after a load has as many times as its molecules have lengths.
    """

    name: ClassVar[str] = "second_creep"
    title: ClassVar[str] = "Second creep"
    law: ClassVar[str] = "+ k (x - z),  tau z' = x - z"
    meaning: ClassVar[str] = "The material creeps within a short time, and within a long one."
    signature: ClassVar[str] = "The residual decays after every change, and later more slowly."
    remedy: ClassVar[str] = "precondition the actuator, or use a less viscoelastic elastomer"
    shown_by: ClassVar[str] = "a hold ten times as long as the longer time, and as long a rest"
    source: ClassVar[str] = "Christensen, Theory of Viscoelasticity, §1 (generalised Maxwell model)"
    amplitude: ClassVar[str] = "k"
    essential: ClassVar[tuple[str, ...]] = ("tau",)
    has_state: ClassVar[bool] = True
    follows_position: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """Stiffness and time of a creep."""
        return CREEP.parameters(scale)

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Times from a hundredth to more than half of the log, for the first creep has any."""
        declared = self.parameters(scale)
        k, tau = declared["k"], declared["tau"]
        wanted = np.clip(np.array(CREEP_TIMES) * scale.duration_s, tau.lower, tau.upper)
        return tuple({"k": k.value, "tau": time_s} for time_s in np.unique(wanted).tolist())

    step = staticmethod(CREEP.step)


@dataclass(frozen=True)
class SecondHysteresis(StateEffect):
    """Hysteresis over another distance beside one, + α z with zs ż = v − |v| z.

    What slips inside a material gives way a little here and a little there: elements in parallel.
    """

    name: ClassVar[str] = "second_hysteresis"
    title: ClassVar[str] = "Second hysteresis"
    law: ClassVar[str] = "+ alpha z,  z' = (v - |v| z)/zs"
    meaning: ClassVar[str] = (
        "The material gives way within a short distance, and within a long one."
    )
    signature: ClassVar[str] = "The residual differs up and down, and turns over two distances."
    remedy: ClassVar[str] = "approach every position from the same side"
    shown_by: ClassVar[str] = "slow loops of many sizes, one within the other"
    source: ClassVar[str] = "Rizos and Fassois, Chaos 14, 2004 (Maxwell slip: elements in parallel)"
    amplitude: ClassVar[str] = "alpha"
    essential: ClassVar[tuple[str, ...]] = ("zs",)
    has_state: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """Half height and distance of a hysteresis."""
        return HYSTERESIS.parameters(scale)

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """The distances of a hysteresis, for the first one has any."""
        return HYSTERESIS.starts(scale)

    def rate(self, eta: Array, scale: Scale) -> float:
        """That of a hysteresis."""
        return HYSTERESIS.rate(eta, scale)

    step = staticmethod(HYSTERESIS.step)


@dataclass(frozen=True)
class OwnBranches(SecondHysteresis):
    """The same as a slider s behind a spring, + α (x − s)/zs with zs ṡ = |v| (x − s).

    With z = (x − s)/zs this is α z, zs ż = v − |v| z. Where a log begins says nothing of where s
    is then: how an actuator was moved before is an unknown of each log.

    Source: Dahl 1968, *A Solid Friction Model*.
    """

    name: ClassVar[str] = "own_branches"
    title: ClassVar[str] = "Hysteresis from a branch of its own in each log"
    law: ClassVar[str] = "+ alpha (x - s)/zs,  zs s' = |v| (x - s)"
    meaning: ClassVar[str] = "The material keeps a set from how it was moved before each log."
    signature: ClassVar[str] = "The logs begin at one pressure and at different positions."
    remedy: ClassVar[str] = "run the same cycles before each log"
    shown_by: ClassVar[str] = "one path in two logs, the second right after the first"
    source: ClassVar[str] = "Dahl 1968, A Solid Friction Model"
    follows_position: ClassVar[bool] = True
    keeps_place: ClassVar[bool] = True

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force α (x − z)/zs, and ż = |v| (x − z)/zs: the own state z is the slider."""
        strain = (x - z) / eta[1]
        out[FORCE] += eta[0] * strain
        out[RATE] += abs(v) * strain


@dataclass(frozen=True)
class PositionHysteresis(SecondHysteresis):
    """Hysteresis that goes with the position, + α z (1 + d ξ), ξ from 0 to 1."""

    name: ClassVar[str] = "position_hysteresis"
    title: ClassVar[str] = "Hysteresis that goes with the position"
    law: ClassVar[str] = (
        "+ alpha z (1 + d xi),  z' = (v - |v| z)/zs,  xi the position within its range"
    )
    meaning: ClassVar[str] = "What bends further is pressed harder onto what it slips on."
    signature: ClassVar[str] = "Loops are wider at one end of the range."
    remedy: ClassVar[str] = "push the actuator at one pressure, from several positions"
    shown_by: ClassVar[str] = "slow loops at one pressure, about several positions"

    def parameters(self, scale: Scale) -> ParameterSet:
        """Those of a hysteresis, and the share d that it gains over the range."""
        gain = one_parameter("d", 0.0, "1", LEAST_GAIN, MOST_GAIN, "gain", self.source)
        return ParameterSet((*super().parameters(scale).values(), *gain.values()))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Those of a hysteresis, as wide at every position."""
        return tuple({**start, "d": 0.0} for start in super().starts(scale))

    def rate(self, eta: Array, scale: Scale) -> float:
        """That of a loop as wide as it gets."""
        widest = float(eta[0]) * max(1.0, 1.0 + float(eta[2]))
        return super().rate(np.array([widest, eta[1]]), scale)

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """Lower end of the range, and the range."""
        return scale.x_low, scale.x_span

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force α z (1 + d ξ), ż = (v − |v| z)/zs; beyond the range as wide as at its end."""
        place = min(max((x - eta[3]) / eta[4], 0.0), 1.0)
        out[FORCE] += eta[0] * z * (1.0 + eta[2] * place)
        out[RATE] += (v - abs(v) * z) / eta[1]


@dataclass(frozen=True)
class ReadingHysteresis(OutputEffect):
    """A sensor whose reading stays behind on the way up and on the way down, y − h y_span z.

    z follows the motion by Dahl's law, zs ż = ẏ − |ẏ| z, as the force of a hysteresis does. That
    holds the actuator back and makes it stiffer after every turn; a sensor does neither.
    """

    name: ClassVar[str] = "reading_hysteresis"
    title: ClassVar[str] = "Hysteresis of the sensor"
    law: ClassVar[str] = "recorded y = x - h y_span z,  z' = (x' - |x'| z)/zs"
    meaning: ClassVar[str] = (
        "The sensor, or what glues it to the actuator, reads less on the way up and more on the "
        "way down."
    )
    signature: ClassVar[str] = (
        "The residual over the position is a loop, and the motion rings and settles without it."
    )
    remedy: ClassVar[str] = "the sensor beside another one, bent by hand up and down"
    shown_by: ClassVar[str] = "fast steps that ring or settle within a loop, and small loops"
    source: ClassVar[str] = "Dahl 1968, A Solid Friction Model"
    amplitude: ClassVar[str] = "h"
    essential: ClassVar[tuple[str, ...]] = ("zs",)

    def parameters(self, scale: Scale) -> ParameterSet:
        """Half height as a share of the range, and the distance over which it changes branch."""
        height = Parameter("h", START_HEIGHT, "1", LEAST_AMPLITUDE, MOST_HEIGHT, "log")
        least, most = (share * scale.y_span for share in (SHARPEST_BEND, LONGEST))
        distance = Parameter("zs", (least * most) ** 0.5, scale.y_unit, least, most, "log")
        return ParameterSet(
            (
                replace(height, meaning="half height, share of the range", source=self.source),
                replace(distance, meaning="distance between the branches", source=self.source),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Distances from a sharp turn to a quarter of the range."""
        return tuple({"h": START_HEIGHT, "zs": share * scale.y_span} for share in DISTANCES)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Take away the branch."""
        del time_s
        branch = np.zeros(y.size)
        loop(np.ascontiguousarray(y, dtype=np.float64), float(eta[1]), branch)
        recorded: Array = y - eta[0] * scale.y_span * branch
        return recorded
