"""Stiffening: the spring grows stiffer, or softer, the further it is moved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from softid.effects.base import StateEffect
from softid.effects.scale import Scale
from softid.kernels.terms import FORCE
from softid.parameters import Parameter, ParameterSet

SOFTEST = -0.3
"""Lower bound of k3, in units of the k3 that doubles the force at the end of the range of
positions: at −1/3 the spring would have no stiffness left there."""

STIFFEST = 10.0
"""Upper bound of k3, in units of the k3 that doubles the force at the end of the range of
positions: there the force is eleven times that of the spring alone; what grows more steeply is an
obstacle."""

SHARES = (0.1, -0.1)
"""Starts of k3, both in units of the k3 that doubles the force at the end of the range of
positions."""


@dataclass(frozen=True)
class Stiffening(StateEffect):
    r"""Cubic part of the elastic force, + k3 x³.

    A rubber wall stiffens as its chains come to their full length (k3 > 0), and a thin wall that
    buckles or balloons gives way (k3 < 0).

    Source: Nayfeh & Mook, *Nonlinear Oscillations*, §4.1 (Duffing's spring).
    """

    name: ClassVar[str] = "stiffening"
    title: ClassVar[str] = "Stiffening with deformation"
    law: ClassVar[str] = "+ k3 x^3"
    meaning: ClassVar[str] = (
        "The actuator's own spring grows stiffer, or softer, the further it is bent or stretched."
    )
    signature: ClassVar[str] = (
        "The residual at rest depends on the position alone and grows steeply towards the largest "
        "positions; the motion there is faster, or slower, than simulated."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("static_curve", "contact")
    remedy: ClassVar[str] = "work in the middle of the range, or use a wall that is strained less"
    shown_by: ClassVar[str] = "held levels and a chirp over the full range of positions"
    source: ClassVar[str] = "Nayfeh & Mook, Nonlinear Oscillations, §4.1 (Duffing's spring)"
    amplitude: ClassVar[str] = "k3"
    counts_position: ClassVar[bool] = True
    changes_sign: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The coefficient k3; a negative one leaves some stiffness over the range of positions."""
        size = _natural(scale)
        return ParameterSet(
            (
                Parameter(
                    "k3",
                    SHARES[0] * size,
                    f"{scale.force_unit}/{scale.x_unit}³",
                    SOFTEST * size,
                    STIFFEST * size,
                    meaning="cubic stiffness",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """One of each sign."""
        return tuple({"k3": share * _natural(scale)} for share in SHARES)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force k3 x³."""
        out[FORCE] += eta[0] * x * x * x


def _natural(scale: Scale) -> float:
    """The k3 that doubles the force at the largest position."""
    reach = max(abs(scale.x_low), abs(scale.x_high))
    return scale.force / scale.x_span / reach**2
