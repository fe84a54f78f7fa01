"""Hysteresis: the way up and the way down differ, however slow the motion is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import LEAST_AMPLITUDE, SHARPEST_BEND, StateEffect
from softid.effects.scale import Scale
from softid.effects.shared_laws.pressed_surfaces import SHOWN_BY, SOURCE, growth, largest_input
from softid.kernels.terms import FORCE, RATE
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

SHARE = 0.05
"""Start of the half height, as a share of the elastic force."""

LARGEST = 10.0
"""Bound of the half height, in elastic forces. One as high as the elastic force holds the actuator
wherever it turns; but the elastic force is that of a base without the loop, and may be too
small."""

LONGEST = 2.0
"""Longest zs in ranges of positions: over a longer one less than two fifths of the way between the
branches fit into the range, and the law is nearly a spring."""

TURN = 8.0
"""Rate that the steps resolve where the loop is as steep as the spring, in ranges of positions that
the largest speed covers in a second; the corner of |v| at a turn asks for more than smooth laws."""

DISTANCES = (0.01, 0.05, 0.25)
"""Starts of zs in ranges of positions."""

BRANCHES = (-0.8, 0.8)
"""Starts of z0: near the end of the way down, and of the way up."""


@dataclass(frozen=True)
class Hysteresis(StateEffect):
    r"""Rate-independent hysteresis of Dahl, + α z with zs ż = v − |v| z.

    z runs to ±1 over a distance zs after every turn, so that the loop depends on the path and not
    on its speed. It is the Bouc–Wen law with exponent 1 and β = γ.

    Source: Dahl 1968, *A Solid Friction Model*; Ikhouane & Rodellar, *Systems with Hysteresis*
    (Bouc–Wen).
    """

    name: ClassVar[str] = "hysteresis"
    title: ClassVar[str] = "Hysteresis of the material"
    law: ClassVar[str] = "+ alpha z,  z' = (v - |v| z)/zs"
    meaning: ClassVar[str] = (
        "The way up and the way down follow different curves however slow the motion is, because "
        "of friction inside the material or between its fibres."
    )
    signature: ClassVar[str] = (
        "The residual plotted over the position is a loop whose area does not shrink at low speed; "
        "small back-and-forth motions give small loops inside it."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("coulomb_friction", "creep", "pneumatic_lag")
    remedy: ClassVar[str] = "approach every position from the same side, or invert the loop"
    shown_by: ClassVar[str] = "the same path at two speeds, and small loops within large ones"
    source: ClassVar[str] = (
        "Dahl 1968, A Solid Friction Model; Ikhouane & Rodellar, Systems with Hysteresis"
    )
    essential: ClassVar[tuple[str, ...]] = ("zs",)
    amplitude: ClassVar[str] = "alpha"
    has_state: ClassVar[bool] = True
    begins_with_log: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """Half height α of the loop, and the distance zs over which it changes branch."""
        return ParameterSet(
            (
                Parameter(
                    "alpha",
                    SHARE * scale.force,
                    scale.force_unit,
                    LEAST_AMPLITUDE * scale.force,
                    LARGEST * scale.force,
                    "log",
                    meaning="force by which the branches lie off the middle",
                    source=self.source,
                ),
                Parameter(
                    "zs",
                    DISTANCES[1] * scale.x_span,
                    scale.x_unit,
                    SHARPEST_BEND * scale.x_span,
                    LONGEST * scale.x_span,
                    "log",
                    meaning="distance over which one branch turns into the other",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Distances from a sharp turn to a quarter of the range."""
        return tuple(
            {"alpha": SHARE * scale.force, "zs": share * scale.x_span} for share in DISTANCES
        )

    def rate(self, eta: Array, scale: Scale) -> float:
        """After a turn the loop acts as a spring of stiffness α/zs."""
        ratio = max(float(eta[0] / eta[1]), 0.0) * scale.x_span / scale.force
        return float(TURN * ratio**0.5 * scale.v_max / scale.x_span)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force α z, and ż = (v − |v| z)/zs."""
        out[FORCE] += eta[0] * z
        out[RATE] += (v - abs(v) * z) / eta[1]


@dataclass(frozen=True)
class BranchHysteresis(Hysteresis):
    r"""The same where every log begins on a branch, + α z with z(0) = z0.

    An actuator that has been moved before a log begins rests on the branch by which it came there:
    at z0 = −1 on that of the way down, at 1 on that of the way up. All logs are taken to begin
    alike, as do those that begin vented.

    Source: Dahl 1968, *A Solid Friction Model*; Ikhouane & Rodellar, *Systems with Hysteresis*
    (Bouc–Wen).
    """

    variant: ClassVar[str] = "branch"
    title: ClassVar[str] = "Hysteresis of the material that has been moved before"
    law: ClassVar[str] = "+ alpha z,  z' = (v - |v| z)/zs,  z = z0 as a log begins"
    plain_at: ClassVar[tuple[str, float] | None] = ("z0", 0.0)

    def parameters(self, scale: Scale) -> ParameterSet:
        """Those of the plain form, and the branch z0 on which a log begins."""
        return ParameterSet(
            (
                *super().parameters(scale).values(),
                Parameter(
                    "z0",
                    BRANCHES[0],
                    "1",
                    -1.0,
                    1.0,
                    meaning="branch on which a log begins: -1 that of the way down, 1 of that up",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """The middle one of the plain form, on either branch."""
        middle = super().starts(scale)[1]
        return tuple({**middle, "z0": branch} for branch in BRANCHES)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force α (z₀ + y), and ẏ = (v − |v| (z₀ + y))/zs: the own state y rests at zero."""
        branch = eta[2] + z
        out[FORCE] += eta[0] * branch
        out[RATE] += (v - abs(v) * branch) / eta[1]


@dataclass(frozen=True)
class PressureHysteresis(Hysteresis):
    """The same with a loop that is wider at high input, + α z (1 + k |u|).

    What slips in it is pressed together by the pressure, as the threads of a braid are.

    Source: Dahl 1968, *A Solid Friction Model*; Tondu and Lopez 2000, doi 10.1109/37.833638.
    """

    variant: ClassVar[str] = "pressure"
    title: ClassVar[str] = "Hysteresis that grows with the pressure"
    law: ClassVar[str] = "+ alpha z (1 + k |u|),  z' = (v - |v| z)/zs"
    meaning: ClassVar[str] = (
        "The way up and the way down follow different curves however slow the motion is, and lie "
        "further apart the harder the pressure presses the fibres onto each other."
    )
    signature: ClassVar[str] = (
        "As for hysteresis, and loops about a high pressure are wider than about a low one."
    )
    shown_by: ClassVar[str] = SHOWN_BY
    source: ClassVar[str] = f"Dahl 1968, A Solid Friction Model; {SOURCE}"

    def parameters(self, scale: Scale) -> ParameterSet:
        """Those of the plain form, of which α is that without pressure, and the growth k."""
        height, distance = super().parameters(scale).values()
        height = replace(height, meaning=f"{height.meaning} without pressure")
        return ParameterSet((height, distance, growth(scale)))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Those of the plain form, of which half comes with the largest input."""
        k = growth(scale).value
        return tuple(
            {**start, "alpha": start["alpha"] / (1.0 + k * largest_input(scale)), "k": k}
            for start in super().starts(scale)
        )

    def rate(self, eta: Array, scale: Scale) -> float:
        """That of a loop as wide as at the largest input."""
        widest = eta[0] * (1.0 + max(float(eta[2]), 0.0) * largest_input(scale))
        return super().rate(np.array([widest, eta[1]]), scale)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force α z (1 + k |u|), and ż = (v − |v| z)/zs."""
        out[FORCE] += eta[0] * z * (1.0 + eta[2] * abs(u))
        out[RATE] += (v - abs(v) * z) / eta[1]
