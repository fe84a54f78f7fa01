"""Coulomb friction: a force of constant size against the motion, and forms whose size varies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import LEAST_AMPLITUDE, SHARPEST_BEND, StateEffect
from softid.effects.scale import Scale
from softid.effects.shared_laws.pressed_surfaces import SHOWN_BY, SOURCE, growth, largest_input
from softid.kernels.exponential import hyperbolic_tangent
from softid.kernels.terms import FORCE
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

SHARE = 0.05
"""Start of the friction, as a share of the elastic force."""

LARGEST = 3.0
"""Bound of the friction, in elastic forces. Friction above one holds the actuator everywhere; but
the elastic force is that of a base without friction, whose force may be too small."""

TURN = 0.8
"""Rate that the steps resolve while the speed goes through ±vs, in units of that at which it passes
from zero to vs, or of the rate at a jump (`SHARP`) where that is less."""

SHARP = 190.0
"""Rate that the steps resolve where friction changes so sharply that it is a jump for them, in
units of that at which a motion that turns round leaves a range of positions: a position is off by
the square of a step times the acceleration. Up to `SHARPEST` that is less than 1e-4 of the range,
and 2e-5 rms (`tests/effects/test_coulomb_friction.py`)."""

SHARPEST = 5000.0
"""Largest v_max/vs. What sticks creeps at up to vs: at a fiftieth of it, by an error of the angle
that is told from friction in ten seconds of a hold."""

LARGE = 0.05
"""Share of the elastic force from which on friction makes the motion stick. The error of the steps
at a jump goes with their square and with the friction up to there, and then stops growing."""

SMOOTHEST = 0.3
"""Share of the largest speed up to which friction is dry; what comes up more slowly is damping."""

SPEEDS = (0.01, 0.06)
"""Starts of vs, as shares of the largest speed."""

EXCESS = (1e-3, 0.5, 20.0)
"""Bounds and start of the share by which friction is larger at low speed. Static friction is seldom
twice the sliding one; the upper bound leaves room where none of the motion is quick enough to show
the latter alone."""

STRIBECK_SPEEDS = (0.03, 0.1)
"""Starts of vb, as shares of the largest speed."""


@dataclass(frozen=True)
class CoulombFriction(StateEffect):
    r"""Dry friction, + Fc tanh(v/vs).

    Below the speed vs the sign function is replaced by a steep slope, so that derivatives exist.

    Source: Armstrong-Hélouvry et al. 1994, doi 10.1016/0005-1098(94)90209-7.
    """

    name: ClassVar[str] = "coulomb_friction"
    title: ClassVar[str] = "Dry friction"
    law: ClassVar[str] = "+ Fc tanh(v/vs)"
    meaning: ClassVar[str] = (
        "Surfaces that rub hold the motion back with a force of constant size, so the actuator "
        "sticks when the motion reverses."
    )
    signature: ClassVar[str] = (
        "The residual has the sign of the velocity and the same size however slow the motion is; "
        "the output has flat stretches at the turning points."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("hysteresis", "quadratic_damping", "dead_zone")
    remedy: ClassVar[str] = "lubricate or align the guides, add dither, or compensate the force"
    shown_by: ClassVar[str] = "the same path once slowly and once fast"
    source: ClassVar[str] = "Armstrong-Hélouvry et al. 1994, doi 10.1016/0005-1098(94)90209-7"
    amplitude: ClassVar[str] = "Fc"
    ceilings: ClassVar[tuple[str, ...]] = ("vs",)
    sticks: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """Size Fc of the friction, and the speed vs below which it fades."""
        return ParameterSet(
            (
                Parameter(
                    "Fc",
                    SHARE * scale.force,
                    scale.force_unit,
                    LEAST_AMPLITUDE * scale.force,
                    LARGEST * scale.force,
                    "log",
                    meaning="friction force at high speed",
                    source=self.source,
                ),
                Parameter(
                    "vs",
                    SPEEDS[1] * scale.v_max,
                    f"{scale.x_unit}/s",
                    scale.v_max / SHARPEST,
                    SMOOTHEST * scale.v_max,
                    "log",
                    meaning="speed scale of the smoothed sign: at v = vs friction reaches 76 % of "
                    "Fc",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """A sharp and a gradual change with the direction."""
        return tuple({"Fc": SHARE * scale.force, "vs": share * scale.v_max} for share in SPEEDS)

    def rate(self, eta: Array, scale: Scale) -> float:
        """The friction turns round while the speed goes through ±vs."""
        largest = float(eta[0]) * (1.0 + self.excess(eta, scale))
        passes = scale.turning_rate * scale.v_max / float(eta[1])
        share = min(max(largest / scale.force, 0.0) / LARGE, 1.0)
        jumps = SHARP * math.sqrt(share * scale.turning_rate * scale.v_max / scale.x_span)
        return TURN * min(passes, jumps)

    def excess(self, eta: Array, scale: Scale) -> float:
        """Share by which the largest friction is above Fc."""
        del eta, scale
        return 0.0

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force Fc tanh(v/vs)."""
        out[FORCE] += eta[0] * hyperbolic_tangent(v / eta[1])


@dataclass(frozen=True)
class StribeckFriction(CoulombFriction):
    r"""Dry friction that is larger at low speed, + Fc tanh(v/vs) (1 + β exp(−(v/vb)²)).

    Source: Armstrong-Hélouvry et al. 1994, doi 10.1016/0005-1098(94)90209-7, §2.1.
    """

    variant: ClassVar[str] = "stribeck"
    plain_at: ClassVar[tuple[str, float] | None] = ("vb", 0.0)
    title: ClassVar[str] = "Dry friction that is larger at low speed"
    law: ClassVar[str] = "+ Fc tanh(v/vs) (1 + beta exp(-(v/vb)^2))"
    meaning: ClassVar[str] = (
        "Surfaces that rub hold the motion back, and more so just before and after they stick, so "
        "slow motion may be jerky."
    )
    signature: ClassVar[str] = (
        "As for dry friction, and in slow motion the residual is larger than in fast motion."
    )

    def parameters(self, scale: Scale) -> ParameterSet:
        """Those of dry friction, its share β of excess at low speed, and the speed vb."""
        return ParameterSet(
            (
                *super().parameters(scale).values(),
                Parameter(
                    "beta",
                    EXCESS[1],
                    "1",
                    EXCESS[0],
                    EXCESS[2],
                    "log",
                    meaning="excess of friction at low speed, as a fraction of Fc",
                    source=self.source,
                ),
                Parameter(
                    "vb",
                    STRIBECK_SPEEDS[1] * scale.v_max,
                    f"{scale.x_unit}/s",
                    SHARPEST_BEND * scale.v_max,
                    scale.v_max,
                    "log",
                    meaning="Stribeck speed, at which the excess has fallen to 1/e",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Those of dry friction with two Stribeck speeds."""
        return tuple(
            {**start, "beta": EXCESS[1], "vb": share * scale.v_max}
            for start, share in zip(super().starts(scale), STRIBECK_SPEEDS, strict=True)
        )

    def excess(self, eta: Array, scale: Scale) -> float:
        """The share β."""
        del scale
        return max(float(eta[2]), 0.0)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force Fc tanh(v/vs) (1 + β exp(−(v/vb)²))."""
        fast = v / eta[3]
        out[FORCE] += (
            eta[0] * hyperbolic_tangent(v / eta[1]) * (1.0 + eta[2] * math.exp(-fast * fast))
        )


@dataclass(frozen=True)
class PressureFriction(CoulombFriction):
    """Dry friction that grows with the input, + Fc tanh(v/vs) (1 + k |u|).

    Pressure presses the threads of a braid, or a bellows and its guide, onto each other.

    Source: Tondu and Lopez 2000, doi 10.1109/37.833638 (friction of a braid goes with pressure).
    """

    variant: ClassVar[str] = "pressure"
    title: ClassVar[str] = "Dry friction that grows with the pressure"
    law: ClassVar[str] = "+ Fc tanh(v/vs) (1 + k |u|)"
    meaning: ClassVar[str] = (
        "Surfaces that rub hold the motion back, and more so the harder the pressure presses them "
        "onto each other, as it does the threads of a braid."
    )
    signature: ClassVar[str] = (
        "As for dry friction, and at high pressure the residual is larger than at low pressure."
    )
    shown_by: ClassVar[str] = SHOWN_BY
    source: ClassVar[str] = SOURCE

    def parameters(self, scale: Scale) -> ParameterSet:
        """Those of dry friction, of which Fc is that without pressure, and the growth k."""
        force, speed = super().parameters(scale).values()
        force = replace(force, meaning="friction force at high speed without pressure")
        return ParameterSet((force, speed, growth(scale)))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Those of dry friction, of which half comes with the largest input."""
        k = growth(scale).value
        return tuple(
            {**start, "Fc": start["Fc"] / (1.0 + k * largest_input(scale)), "k": k}
            for start in super().starts(scale)
        )

    def excess(self, eta: Array, scale: Scale) -> float:
        """The growth up to the largest input."""
        return max(float(eta[2]), 0.0) * largest_input(scale)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force Fc tanh(v/vs) (1 + k |u|)."""
        out[FORCE] += eta[0] * hyperbolic_tangent(v / eta[1]) * (1.0 + eta[2] * abs(u))
