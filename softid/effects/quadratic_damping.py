"""Quadratic damping: the resistance grows with the square of the speed, or another power of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from softid.effects.base import LEAST_AMPLITUDE, StateEffect
from softid.effects.scale import Scale
from softid.effects.shared_laws.one_start import OneStart
from softid.kernels.terms import FORCE
from softid.parameters import Parameter, ParameterSet

SHARE = 0.1
"""Resistance at the largest speed with which a search begins, as a share of the base's force."""

LARGEST = 100.0
"""Bound of the resistance at the largest speed, in elastic forces. Little more than one of them
drives the motion; but the speed is that of a base without the resistance, and one that is ten times
too large makes a hundred of it."""

POWERS = (1.2, 6.0)
"""Bounds of the exponent: nearer to 1 it is damping in proportion to the speed, which the models
have, and beyond 6 the resistance is there at the largest speed only."""

START_POWERS = (1.4, 3.5)
"""Exponents at which a search begins, one below that of the square and one above."""

SMOOTH = 1e-3
"""Share of the largest speed below which the law bends into a line, so that derivatives exist."""


@dataclass(frozen=True)
class QuadraticDamping(OneStart, StateEffect):
    r"""Resistance with the square of the speed, + d2 v |v|.

    Turbulent flow through narrow channels, and the drag of the surrounding fluid, resist so.

    Source: Morison et al. 1950, doi 10.2118/950149-G (drag term).
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
                    _unit(scale),
                    LEAST_AMPLITUDE * size,
                    LARGEST * size,
                    "log",
                    meaning="resistance per square of the speed",
                    source=self.source,
                ),
            )
        )

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force d2 v |v|."""
        out[FORCE] += eta[0] * v * abs(v)


def _unit(scale: Scale) -> str:
    """Of a force per square of the speed; a model whose force is a number has no factor for it."""
    force = "" if scale.force_unit == "1" else f"{scale.force_unit}·"
    return f"{force}s²/{scale.x_unit}²"


@dataclass(frozen=True)
class PowerDamping(QuadraticDamping):
    r"""Resistance with a power of the speed, + d2 v_m² |v/v_m|ⁿ sign v.

    The largest speed v_m of the logs is where it is as large as d2 v |v|, so that d2 and n are
    nearly independent. A drag that is turbulent in part, or a fluid whose viscosity grows with the
    rate of shear, resists so.

    Source: Ostwald, *Kolloid-Zeitschrift* 36, 99, 1925 (power law of a fluid).
    """

    variant: ClassVar[str] = "power"
    title: ClassVar[str] = "Damping with a power of the speed"
    law: ClassVar[str] = "+ d2 vm^2 |v/vm|^n sign(v), vm the largest speed in the fitted logs"
    meaning: ClassVar[str] = (
        "Fast motion is held back more than in proportion to its speed, by a power of it that is "
        "not the square, as by a fluid that grows stiffer the faster it is sheared."
    )
    signature: ClassVar[str] = (
        "The residual appears in fast stretches only, has the shape of a power of the speed, and "
        "shrinks faster than the motion when the amplitude shrinks."
    )
    source: ClassVar[str] = "Ostwald, Kolloid-Zeitschrift 36, 99, 1925 (power law of a fluid)"
    essential: ClassVar[tuple[str, ...]] = ("n",)
    plain_at: ClassVar[tuple[str, float] | None] = ("n", 2.0)

    def parameters(self, scale: Scale) -> ParameterSet:
        """The coefficient d2 at the largest speed, and the exponent n."""
        return ParameterSet(
            (
                *super().parameters(scale).values(),
                Parameter(
                    "n",
                    START_POWERS[1],
                    "1",
                    *POWERS,
                    "log",
                    meaning="exponent of the speed",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """An exponent below and one above that of the square."""
        (plain,) = super().starts(scale)
        return tuple({**plain, "n": power} for power in START_POWERS)

    def law_at(self, scale: Scale) -> str:
        """With the largest speed."""
        return self.law.replace("the largest speed", f"= {scale.v_max:.5g} {scale.x_unit}/s")

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """The largest speed, and the square of the share of it below which the law is a line."""
        return scale.v_max, SMOOTH**2

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force d2 v_m² s (s² + ε²)^((n − 1)/2) with s = v/v_m."""
        share = v / eta[2]
        grown = (share * share + eta[3]) ** (0.5 * (eta[1] - 1.0))
        out[FORCE] += eta[0] * eta[2] * eta[2] * share * grown
