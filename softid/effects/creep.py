"""Creep: part of the material goes on giving way after the motion has settled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from softid.effects.base import LEAST_AMPLITUDE, Scale, StateEffect
from softid.effects.time_constants import SETTLING_PERIODS, start_times, time_bounds
from softid.kernels.terms import FORCE, RATE
from softid.parameters import Parameter, ParameterSet

SHARE = 0.2
"""Start of the stiffness that relaxes, in those of the actuator."""

STIFFEST = 30.0
"""Largest stiffness that relaxes, in those of the actuator: a thirtieth of what a sudden force
meets is then left at rest."""

LONGEST_SHARE = 1.0
"""Longest relaxation as a share of the log: one that takes longer is a drift in it."""

TIMES = (0.03, 0.1, 0.3)
"""Starts of the time, as shares of the log."""


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
        shortest, longest = time_bounds(scale, periods=SETTLING_PERIODS, share=LONGEST_SHARE)
        return ParameterSet(
            (
                Parameter(
                    "k",
                    SHARE * stiffness,
                    f"{scale.force_unit}/{scale.x_unit}",
                    LEAST_AMPLITUDE * stiffness,
                    STIFFEST * stiffness,
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
        """Times from a thirtieth to a third of the log."""
        declared = self.parameters(scale)
        times = start_times(declared["tau"], scale, TIMES)
        return tuple({"k": declared["k"].value, "tau": tau} for tau in times)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force k (x − z), and ż = (x − z)/τ."""
        out[FORCE] += eta[0] * (x - z)
        out[RATE] += (x - z) / eta[1]
