"""Laws in no catalogue that go with the position."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, cast

import numpy as np
import numpy.typing as npt

from softid.diagnosis.verdict.unlisted_drifts import one_parameter
from softid.effects import effect_of
from softid.effects.base import StateEffect
from softid.effects.scale import Scale
from softid.kernels.exponential import hyperbolic_tangent
from softid.kernels.terms import DAMPING, FORCE, INERTIA
from softid.parameters import ParameterSet

Array = npt.NDArray[np.float64]

MOST_LOST = 0.9
"""Bound of what a damping, an inertia or a friction loses somewhere in the range, as a share."""

DAMPING_KNOTS = 11
"""Positions at which a damping is known; the compiled step counts on it."""

MOST_GAINED = 9.0
"""Bound of what a damping gains somewhere in the range."""

MOST_RUBBED = 30.0
"""Bound of what a friction gains over the range, as a share of it at the lower end."""

START_INERTIA = (0.5, -0.3)
"""Starts of what an inertia gains over the range, either way, as a share of it at the lower end."""

DRY = cast(StateEffect, effect_of("coulomb_friction"))
"""The friction of the catalogue, which does not go with the position."""


@dataclass(frozen=True)
class PositionDamping(StateEffect):
    """A damping that goes with the position, (1 + d(ξ)) times the model's, ξ from 0 to 1.

    d is linear between `DAMPING_KNOTS` values at equal distances, and constant beyond them.
    """

    name: ClassVar[str] = "position_damping"
    title: ClassVar[str] = "Damping that goes with the position"
    law: ClassVar[str] = "damping (1 + d(xi)), xi the position within its range, d through d0 … d10"
    meaning: ClassVar[str] = "Air has narrower ways, or folds rub more, the further it is bent."
    signature: ClassVar[str] = "The residual after a step lasts longer at some positions."
    remedy: ClassVar[str] = "push the actuator at one pressure, from several positions"
    shown_by: ClassVar[str] = "steps of one size from many positions"
    source: ClassVar[str] = "a polygon"
    amplitude: ClassVar[str] = "d0"
    changes_sign: ClassVar[bool] = True

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """All vanish together."""
        return tuple(f"d{k}" for k in range(DAMPING_KNOTS))

    def parameters(self, scale: Scale) -> ParameterSet:
        """What the damping gains at each position, as a share of it."""
        del scale
        declared = (
            one_parameter(name, 0.0, "1", -MOST_LOST, MOST_GAINED, "gain there", self.source)[name]
            for name in self.amplitudes
        )
        return ParameterSet(tuple(declared))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """One start: a damping that is the same at every position."""
        del scale
        return (dict.fromkeys(self.amplitudes, 0.0),)

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """Lower end of the range, and the distance of the knots."""
        return scale.x_low, scale.x_span / (DAMPING_KNOTS - 1)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Relative change d(ξ) of the damping."""
        place = min(max((x - eta[11]) / eta[12], 0.0), 9.999999)
        knot = int(place)
        part = place - knot
        out[DAMPING] += (1.0 - part) * eta[knot] + part * eta[knot + 1]


@dataclass(frozen=True)
class PositionInertia(StateEffect):
    """An inertia that goes with the position, M (1 + g ξ), ξ from 0 to 1 within the range."""

    name: ClassVar[str] = "position_inertia"
    title: ClassVar[str] = "Inertia that goes with the position"
    law: ClassVar[str] = "M (1 + g xi) in place of M, xi the position within its range"
    meaning: ClassVar[str] = "What bends has its mass nearer to, or further from, where it is held."
    signature: ClassVar[str] = "It swings more slowly at one end of the range than at the other."
    remedy: ClassVar[str] = "let the actuator swing about several positions"
    shown_by: ClassVar[str] = "quick steps of one size about several positions"
    source: ClassVar[str] = "a straight line"
    amplitude: ClassVar[str] = "g"
    changes_sign: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """What the inertia gains over the range, as a share of it at the lower end."""
        del scale
        start = START_INERTIA[0]
        return one_parameter("g", start, "1", -MOST_LOST, MOST_GAINED, "its gain", self.source)

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Two starts: a gain of either sign."""
        del scale
        return tuple({"g": gain} for gain in START_INERTIA)

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """Lower end of the range, and the range."""
        return scale.x_low, scale.x_span

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Relative change g ξ of the inertia; beyond the range as large as at its end."""
        out[INERTIA] += eta[0] * min(max((x - eta[1]) / eta[2], 0.0), 1.0)


@dataclass(frozen=True)
class PositionFriction(StateEffect):
    """Dry friction that goes with the position, + Fc tanh(v/vs) (1 + d ξ), ξ from 0 to 1."""

    name: ClassVar[str] = "position_friction"
    title: ClassVar[str] = "Dry friction that goes with the position"
    law: ClassVar[str] = "+ Fc tanh(v/vs) (1 + d xi), xi the position within its range"
    meaning: ClassVar[str] = "What bends further is pressed harder onto what it rubs on."
    signature: ClassVar[str] = "As for dry friction, larger at one end of the range."
    remedy: ClassVar[str] = "push the actuator at one pressure, from several positions"
    shown_by: ClassVar[str] = "slow strokes at one pressure, about several positions"
    source: ClassVar[str] = "a straight line"
    amplitude: ClassVar[str] = "Fc"
    essential: ClassVar[tuple[str, ...]] = ("d",)
    sticks: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """Those of dry friction, and the share d that it gains over the range."""
        gain = one_parameter("d", 0.0, "1", -MOST_LOST, MOST_RUBBED, "gain", self.source)
        return ParameterSet((*DRY.parameters(scale).values(), *gain.values()))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Those of dry friction, as large at every position."""
        return tuple({**start, "d": 0.0} for start in DRY.starts(scale))

    def rate(self, eta: Array, scale: Scale) -> float:
        """That of a dry friction as large as it gets."""
        largest = float(eta[0]) * max(1.0, 1.0 + float(eta[2]))
        return DRY.rate(np.array([largest, eta[1]]), scale)

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """Lower end of the range, and the range."""
        return scale.x_low, scale.x_span

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force Fc tanh(v/vs) (1 + d ξ); beyond the range as large as at its end."""
        place = min(max((x - eta[3]) / eta[4], 0.0), 1.0)
        out[FORCE] += eta[0] * hyperbolic_tangent(v / eta[1]) * (1.0 + eta[2] * place)
