"""Asymmetric damping: one direction of motion is held back more than the other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from softid.effects.base import SHARPEST_BEND, StateEffect
from softid.effects.scale import Scale
from softid.kernels.exponential import hyperbolic_tangent
from softid.kernels.terms import DAMPING
from softid.parameters import Parameter, ParameterSet

LARGEST = 0.95
"""Bound of the asymmetry either way: with all of the damping gone, one direction would run free."""

SHARE = 0.2
"""Start of the asymmetry: clear of zero, and far from its bound."""

SPEEDS = (0.02, 0.3)
"""Starts of v0 as shares of the largest speed: a sudden and a gradual change with the direction."""

SMOOTHEST = 0.5
"""Share of the largest speed up to which the damping still changes with the direction; what comes
up more slowly grows with the speed, as quadratic damping does."""


@dataclass(frozen=True)
class AsymmetricDamping(StateEffect):
    r"""Damping that depends on the direction, N (1 + eps tanh(v/v0)), v = dx/dt.

    Filling and venting take different paths, and a wall that is stretched loses more energy than
    one that comes back.

    Source: Dixon, *The Shock Absorber Handbook* (bump and rebound).
    """

    name: ClassVar[str] = "asymmetric_damping"
    title: ClassVar[str] = "Damping that differs by direction"
    law: ClassVar[str] = "N (1 + eps tanh(v/v0)) in place of N, v = dx/dt"
    meaning: ClassVar[str] = (
        "Motion in one direction is damped more than in the other, so rise and return take "
        "different times."
    )
    signature: ClassVar[str] = (
        "The residual has the same sign after steps up and after steps down, and vanishes when "
        "the motion ends."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("pneumatic_lag", "valve_flow", "quadratic_damping")
    remedy: ClassVar[str] = (
        "if the pressure is read before a valve or a long tube, vent through a path as wide as the "
        "one that fills; if it is read in the chamber, look for what rubs or drags one way only"
    )
    shown_by: ClassVar[str] = "equal steps up and down between the same levels"
    source: ClassVar[str] = "Dixon, The Shock Absorber Handbook (bump and rebound)"
    amplitude: ClassVar[str] = "eps"
    ceilings: ClassVar[tuple[str, ...]] = ("v0",)
    changes_sign: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The asymmetry eps, positive where a growing x is damped more, and the speed v0."""
        return ParameterSet(
            (
                Parameter(
                    "eps",
                    SHARE,
                    "1",
                    -LARGEST,
                    LARGEST,
                    meaning="relative excess of damping while x, the position in the law, grows",
                    source=self.source,
                ),
                Parameter(
                    "v0",
                    SPEEDS[0] * scale.v_max,
                    f"{scale.x_unit}/s",
                    SHARPEST_BEND * scale.v_max,
                    SMOOTHEST * scale.v_max,
                    "log",
                    meaning="speed scale of the smoothed sign: at v = v0 the excess is 76 % of eps",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """A sudden and a gradual change with the direction."""
        return tuple({"eps": SHARE, "v0": share * scale.v_max} for share in SPEEDS)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Relative change eps tanh(v/v0) of the damping."""
        out[DAMPING] += eta[0] * hyperbolic_tangent(v / eta[1])
