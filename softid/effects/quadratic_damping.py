"""Quadratic damping: the resistance grows with the square of the speed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from softid.effects.base import Scale, StateEffect
from softid.kernels.terms import FORCE
from softid.parameters import Parameter, ParameterSet

SHARE = 0.1


@dataclass(frozen=True)
class QuadraticDamping(StateEffect):
    r"""Resistance with the square of the speed, + d2 v |v|.

    Turbulent flow through narrow channels, and the drag of the surrounding fluid, resist so.

    Source: Morison et al. 1950 (drag term), doi 10.2118/950149-G.
    """

    name: ClassVar[str] = "quadratic_damping"
    title: ClassVar[str] = "Damping with the square of the speed"
    law: ClassVar[str] = "+ d2 v |v|"
    meaning: ClassVar[str] = (
        "Fast motion is held back more than in proportion to its speed, as by turbulent flow or "
        "by the drag of a fluid."
    )
    signature: ClassVar[str] = (
        "The residual appears in fast stretches only, has the shape of the square of the speed, "
        "and shrinks faster than the motion when the amplitude shrinks."
    )
    neighbours: ClassVar[tuple[str, ...]] = (
        "pressure_mass",
        "asymmetric_damping",
        "coulomb_friction",
        "valve_flow",
    )
    remedy: ClassVar[str] = "widen the narrowest passage, or move in air instead of a liquid"
    shown_by: ClassVar[str] = "the same sine or step at several amplitudes"
    source: ClassVar[str] = "Morison et al. 1950, doi 10.2118/950149-G (drag term)"
    amplitude: ClassVar[str] = "d2"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The coefficient d2."""
        size = scale.force / scale.v_max**2
        return ParameterSet(
            (
                Parameter(
                    "d2",
                    SHARE * size,
                    f"{scale.force_unit}·s²/{scale.x_unit}²",
                    1e-6 * size,
                    100.0 * size,
                    "log",
                    meaning="resistance per square of the speed",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """One, since the effect is linear in its coefficient."""
        return (self.parameters(scale).values_dict(),)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force d2 v |v|."""
        out[FORCE] += eta[0] * v * abs(v)
