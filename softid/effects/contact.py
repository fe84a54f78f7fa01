"""Contact: beyond some position, or below one, the actuator presses against something."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import LEAST_AMPLITUDE, StateEffect
from softid.effects.scale import Scale
from softid.kernels.terms import FORCE
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

WIDTH = 0.01
"""Share of the range of positions over which a soft contact closes, and of the force that goes
through the whole range by which a hard one has closed."""

BOUNCE = 8.0
"""Rate of the motion against an obstacle as stiff as the spring, in ranges of positions that the
largest speed covers in a second: the steps then err by less than 3e-4 up to kw = 90 Q."""

PLACES = (0.35, 0.6, 0.8, 0.92)
"""Starts of the place, as shares of the way to the end of the range where the obstacle stands."""

BEYOND = 0.15
"""Share of the range of positions beyond it at which the contact may begin: the model without one
does not reach quite so far as the actuator that leans on it."""

STIFFEST = 100.0
"""Largest stiffness, in those of the actuator: a stiffer obstacle gives way by less than a
hundredth of what the actuator would move without it."""


@dataclass(frozen=True)
class Contact(StateEffect):
    r"""One-sided spring, + kw (x − xw)₊, with its corner rounded.

    (y)₊ is w ln(1 + exp(y/w)), so that derivatives exist, with w = 1 % of the range of positions
    over 1 + kw/Q, where Q is the actuator's own stiffness. The corner of an obstacle much stiffer
    than that is so narrow that kw w is 1 % of the force which moves the actuator through its range:
    with a width that stays, a wall would already be felt ten widths before it.

    Source: Johnson, *Contact Mechanics*, §4.3 (elastic foundation).
    """

    name: ClassVar[str] = "contact"
    title: ClassVar[str] = "Contact with an obstacle"
    law: ClassVar[str] = "+ kw max(x - xw, 0), corner rounded over 1 % of the range or less"
    meaning: ClassVar[str] = (
        "Beyond a certain position the actuator presses against an obstacle or against itself, and "
        "needs more force to move further."
    )
    signature: ClassVar[str] = (
        "The residual vanishes below one position; beyond it, it grows with the distance, both at "
        "rest and in motion."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("sensor_clipping", "stiffening", "static_curve")
    remedy: ClassVar[str] = "clear the workspace, or stay below the position of contact"
    shown_by: ClassVar[str] = "steps to high pressure while you watch for the contact"
    source: ClassVar[str] = "Johnson, Contact Mechanics, §4.3 (elastic foundation)"
    readings: ClassVar[tuple[str, ...]] = ("xw",)
    amplitude: ClassVar[str] = "kw"
    essential: ClassVar[tuple[str, ...]] = ("xw",)

    def ends(self, scale: Scale) -> tuple[float, float]:
        """End of the range of positions where the obstacle stands, and the other end."""
        return scale.x_high, scale.x_low

    def parameters(self, scale: Scale) -> ParameterSet:
        """Stiffness kw of the obstacle and its position xw."""
        stiffness = scale.force / scale.x_span
        near, far = self.ends(scale)
        beyond = near + BEYOND * (near - far)
        return ParameterSet(
            (
                Parameter(
                    "kw",
                    stiffness,
                    f"{scale.force_unit}/{scale.x_unit}",
                    LEAST_AMPLITUDE * stiffness,
                    STIFFEST * stiffness,
                    "log",
                    meaning="stiffness of the obstacle",
                    source=self.source,
                ),
                Parameter(
                    "xw",
                    far + PLACES[1] * (near - far),
                    scale.x_unit,
                    min(far, beyond),
                    max(far, beyond),
                    meaning="position at which the contact begins, less the sensor zero of the log",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Places from the middle of the range to its end."""
        stiffness = self.parameters(scale)["kw"].value
        near, far = self.ends(scale)
        return tuple({"kw": stiffness, "xw": far + place * (near - far)} for place in PLACES)

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """Width of a soft contact's corner, and the actuator's own stiffness."""
        return WIDTH * scale.x_span, scale.force / scale.x_span

    def rate(self, eta: Array, scale: Scale) -> float:
        """The motion against the obstacle is faster by √(kw/Q)."""
        ratio = max(float(eta[0]), 0.0) * scale.x_span / scale.force
        return float(BOUNCE * ratio**0.5 * scale.v_max / scale.x_span)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force kw w ln(1 + exp((x − xw)/w)), written so that nothing overflows."""
        width = eta[2] / (1.0 + abs(eta[0]) / eta[3])
        depth = (x - eta[1]) / width
        out[FORCE] += eta[0] * width * (max(depth, 0.0) + math.log1p(math.exp(-abs(depth))))


@dataclass(frozen=True)
class LowerContact(Contact):
    r"""One-sided spring on the other side, − kw (xw − x)₊, with its corner rounded as there.

    An arm that rests on a table while it is vented is held so, and so is one whose position falls
    with the pressure and that presses against something.

    Source: Johnson, *Contact Mechanics*, §4.3 (elastic foundation).
    """

    variant: ClassVar[str] = "lower"
    title: ClassVar[str] = "Contact with an obstacle below"
    law: ClassVar[str] = "- kw max(xw - x, 0), corner rounded over 1 % of the range or less"
    meaning: ClassVar[str] = (
        "Below a certain position the actuator presses against an obstacle or against itself, as "
        "an arm that rests on a table while it is vented."
    )
    signature: ClassVar[str] = (
        "The residual vanishes above one position; below it, it grows with the distance, both at "
        "rest and in motion."
    )
    shown_by: ClassVar[str] = "steps down to the lowest pressure while you watch for the contact"

    def ends(self, scale: Scale) -> tuple[float, float]:
        """The lower end of the range of positions, and the upper one."""
        return scale.x_low, scale.x_high

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force −kw w ln(1 + exp((xw − x)/w)), written so that nothing overflows."""
        width = eta[2] / (1.0 + abs(eta[0]) / eta[3])
        depth = (eta[1] - x) / width
        out[FORCE] -= eta[0] * width * (max(depth, 0.0) + math.log1p(math.exp(-abs(depth))))
