"""Pressure mass: the moving mass grows with the pressure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from softid.effects.base import MOST_LOST, StateEffect
from softid.effects.scale import Scale
from softid.effects.shared_laws.one_start import OneStart
from softid.effects.shared_laws.pressed_surfaces import largest_input
from softid.kernels.terms import INERTIA
from softid.parameters import Parameter, ParameterSet

HEAVIEST = 10.0
"""Largest gain, in times the inertia without input: with more, hardly anything but the fluid
moves."""

SHARE = 0.3
"""Start of the gain at the largest input."""


@dataclass(frozen=True)
class PressureMass(OneStart, StateEffect):
    r"""Inertia that depends on the input, M (1 + m u).

    The fluid that fills the chambers moves along, and a longer or wider chamber carries its wall
    further out.

    Source: Ru et al. 2019, doi 10.1007/s11432-018-9709-x, Eq 4, where M may depend on pressure.
    """

    name: ClassVar[str] = "pressure_mass"
    title: ClassVar[str] = "Inertia that depends on pressure"
    law: ClassVar[str] = "M (1 + m u) in place of M"
    meaning: ClassVar[str] = (
        "The mass that moves changes with the pressure, because fluid comes in and the shape "
        "changes."
    )
    signature: ClassVar[str] = (
        "The residual rings after fast changes, with another frequency at high pressure than at "
        "low; at rest and in slow motion there is none."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("quadratic_damping", "line_resonance")
    remedy: ClassVar[str] = "none is needed: schedule the controller with pressure"
    shown_by: ClassVar[str] = "a chirp past the natural frequency at a low and at a high pressure"
    source: ClassVar[str] = "Ru et al. 2019, doi 10.1007/s11432-018-9709-x, Eq 4"
    amplitude: ClassVar[str] = "m"
    changes_sign: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The relative change m per unit of input; the inertia stays positive over its range."""
        reach = largest_input(scale)
        largest, smallest = HEAVIEST / reach, -HEAVIEST / reach
        if scale.u_low < 0.0:
            largest = min(largest, -MOST_LOST / scale.u_low)
        if scale.u_high > 0.0:
            smallest = max(smallest, -MOST_LOST / scale.u_high)
        return ParameterSet(
            (
                Parameter(
                    "m",
                    SHARE / reach,
                    f"1/{scale.u_unit}",
                    smallest,
                    largest,
                    meaning="share of the inertia gained with each unit of input",
                    source=self.source,
                ),
            )
        )

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Relative change m u of the inertia."""
        out[INERTIA] += eta[0] * u
