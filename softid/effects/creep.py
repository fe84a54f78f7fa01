"""Creep: part of the material keeps yielding after the motion has settled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from softid.effects.base import LEAST_AMPLITUDE, StateEffect
from softid.effects.scale import Scale
from softid.effects.shared_laws.settling import SettlingShare, settling_starts, settling_time
from softid.kernels.terms import FORCE, RATE
from softid.parameters import Parameter, ParameterSet

SHARE = 0.2
"""Start of the stiffness that relaxes, in those of the actuator."""

STIFFEST = 30.0
"""Largest stiffness that relaxes, in those of the actuator: a thirtieth of what a sudden force
meets is then left at rest."""

SERIES_SHARES = (1e-4, 3.0)
"""Bounds of the share by which a reading creeps on: less is lost in any noise, and what creeps
three times as far as it jumped did not settle at all."""


@dataclass(frozen=True)
class Creep(StateEffect):
    r"""Creep of a standard linear solid, + k (x − z) with τ ż = x − z.

    A second spring stands in series with a damper beside the first: a fast motion feels both
    springs, and after a time τ only the first is left.

    Source: Christensen, *Theory of Viscoelasticity*, §1 (standard linear solid).
    """

    name: ClassVar[str] = "creep"
    title: ClassVar[str] = "Creep of the material"
    law: ClassVar[str] = "+ k (x - z),  tau z' = x - z"
    meaning: ClassVar[str] = (
        "After a change the actuator settles quickly to most of its new position and then creeps "
        "on, because part of its elastic force relaxes."
    )
    signature: ClassVar[str] = (
        "The residual decays exponentially after every change of level. Its size is proportional "
        "to the change, and its time constant is the same at every level and in both directions."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("sensor_warmup", "hysteresis", "sensor_drift")
    remedy: ClassVar[str] = "precondition the actuator, or use a less viscoelastic elastomer"
    shown_by: ClassVar[str] = "a hold of 20 s followed by a rest of 20 s"
    source: ClassVar[str] = "Christensen, Theory of Viscoelasticity, §1 (standard linear solid)"
    amplitude: ClassVar[str] = "k"
    is_linear: ClassVar[bool] = True
    essential: ClassVar[tuple[str, ...]] = ("tau",)
    has_state: ClassVar[bool] = True
    follows_position: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """Stiffness k that relaxes, and the time τ in which it does."""
        stiffness = scale.force / scale.x_span
        return ParameterSet(
            (
                Parameter(
                    "k",
                    SHARE * stiffness,
                    f"{scale.force_unit}/{scale.x_unit}",
                    LEAST_AMPLITUDE * stiffness,
                    STIFFEST * stiffness,
                    "log",
                    meaning="part of the stiffness that relaxes",
                    source=self.source,
                ),
                settling_time(scale, "relaxation time", self.source),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Times from a thirtieth to a third of the log."""
        return settling_starts("k", self.parameters(scale), scale)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force k (x − z), and ż = (x − z)/τ."""
        out[FORCE] += eta[0] * (x - z)
        out[RATE] += (x - z) / eta[1]


@dataclass(frozen=True)
class SeriesCreep(SettlingShare):
    r"""Creep by the same share of every deflection, y = x + c z with τ ż + z = x.

    A spring and a damper side by side stand in series with the actuator (Kelvin and Voigt), or a
    strain sensor creeps. In an actuator whose stiffness does not depend on the pressure it is
    nearly the creep of a standard linear solid; in others that one creeps less where they are
    stiff.

    Source: Christensen, *Theory of Viscoelasticity*, §1 (Kelvin-Voigt element).
    """

    name: ClassVar[str] = "creep"
    variant: ClassVar[str] = "series"
    title: ClassVar[str] = "Creep in proportion to the deflection"
    law: ClassVar[str] = "recorded y = x + c z,  tau z' + z = x"
    meaning: ClassVar[str] = (
        "After a change the reading settles quickly to most of its new value and then creeps "
        "on, by a fraction of the change that is the same at every pressure, because the body, or "
        "a strain sensor on it, keeps yielding."
    )
    signature: ClassVar[str] = (
        "After every change of level the residual approaches, exponentially, a fixed fraction of "
        "the change of deflection, with one time constant at every level and in both directions."
    )
    neighbours: ClassVar[tuple[str, ...]] = Creep.neighbours
    remedy: ClassVar[str] = (
        "precondition the actuator, use a less viscoelastic elastomer, or a sensor that does not "
        "creep"
    )
    shown_by: ClassVar[str] = "a hold of 20 s followed by a rest of 20 s, at two levels"
    source: ClassVar[str] = "Christensen, Theory of Viscoelasticity, §1 (Kelvin-Voigt element)"
    ceilings: ClassVar[tuple[str, ...]] = ("c",)
    shares: ClassVar[tuple[float, float]] = SERIES_SHARES
    meanings: ClassVar[tuple[str, str]] = (
        "fraction of a change by which the reading creeps on",
        "time constant of the creep",
    )
    direction: ClassVar[float] = 1.0
