"""Creep: part of the material goes on giving way after the motion has settled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from softid.effects.base import Scale, StateEffect
from softid.kernels.terms import FORCE, RATE
from softid.parameters import Parameter, ParameterSet

STIFFNESS_SHARES = 0.2
TIMES = (0.03, 0.1, 0.3)


@dataclass(frozen=True)
class Creep(StateEffect):
    r"""Creep of a standard linear solid, + k (x − z) with τ ż = x − z.

    A second spring stands in series with a damper beside the first: a fast motion feels both
    springs, and after a time τ only the first is left.

    Source: standard linear solid (Zener); Christensen, *Theory of Viscoelasticity*, §1.
    """

    name: ClassVar[str] = "creep"
    title: ClassVar[str] = "Creep of the material"
    law: ClassVar[str] = "+ k (x - z),  tau z' = x - z"
    meaning: ClassVar[str] = (
        "After a change the actuator settles quickly to most of its new position and then creeps "
        "on for seconds or minutes, because part of its elastic force relaxes."
    )
    signature: ClassVar[str] = (
        "The residual decays exponentially after every change of level, in proportion to the "
        "change, with the same time at every level and in both directions."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("sensor_warmup", "hysteresis", "sensor_drift")
    remedy: ClassVar[str] = "precondition the actuator, or use a less viscoelastic elastomer"
    shown_by: ClassVar[str] = "a hold of 20 s followed by a rest of 20 s"
    source: ClassVar[str] = "Christensen, Theory of Viscoelasticity, 1 (standard linear solid)"
    amplitude: ClassVar[str] = "k"
    essential: ClassVar[tuple[str, ...]] = ("tau",)
    has_state: ClassVar[bool] = True
    follows_position: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """Stiffness k that relaxes, and the time τ in which it does."""
        stiffness = scale.force / scale.x_span
        shortest = 5.0 * scale.period_s
        longest = max(scale.duration_s, 10.0 * shortest)
        return ParameterSet(
            (
                Parameter(
                    "k",
                    STIFFNESS_SHARES * stiffness,
                    f"{scale.force_unit}/{scale.x_unit}",
                    1e-6 * stiffness,
                    30.0 * stiffness,
                    "log",
                    meaning="stiffness that relaxes",
                    source=self.source,
                ),
                Parameter(
                    "tau",
                    (shortest * longest) ** 0.5,
                    "s",
                    shortest,
                    longest,
                    "log",
                    meaning="time in which it relaxes",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Times from a few of the motion's own to a third of the log."""
        declared = self.parameters(scale)
        return tuple(
            {
                "k": declared["k"].value,
                "tau": min(
                    max(share * scale.duration_s, declared["tau"].lower), declared["tau"].upper
                ),
            }
            for share in TIMES
        )

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force k (x − z), and ż = (x − z)/τ."""
        out[FORCE] += eta[0] * (x - z)
        out[RATE] += (x - z) / eta[1]
