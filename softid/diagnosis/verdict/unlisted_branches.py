"""Hysteresis of which each log begins on a branch of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects import effect_of
from softid.effects.base import StateEffect
from softid.effects.scale import Scale
from softid.kernels.terms import FORCE, RATE
from softid.parameters import ParameterSet

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class OwnBranches(StateEffect):
    """Dahl's hysteresis as a slider s behind a spring, + α (x − s)/zs with zs ṡ = |v| (x − s).

    With z = (x − s)/zs this is α z, zs ż = v − |v| z. Where a log begins says nothing of where s
    is then: an actuator that was moved before another log, or was not, is an unknown of each.

    Source: Dahl 1968, *A Solid Friction Model*.
    """

    name: ClassVar[str] = "own_branches"
    title: ClassVar[str] = "Hysteresis from a branch of its own in each log"
    law: ClassVar[str] = "+ alpha (x - s)/zs,  zs s' = |v| (x - s)"
    meaning: ClassVar[str] = "The material keeps a set from how it was moved before each log."
    signature: ClassVar[str] = "The logs begin at one pressure and at different positions."
    remedy: ClassVar[str] = "run the same cycles before each log"
    shown_by: ClassVar[str] = "one path in two logs, the second right after the first"
    source: ClassVar[str] = "Dahl 1968, A Solid Friction Model"
    amplitude: ClassVar[str] = "alpha"
    essential: ClassVar[tuple[str, ...]] = ("zs",)
    has_state: ClassVar[bool] = True
    follows_position: ClassVar[bool] = True
    keeps_place: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """Half height and distance of a hysteresis."""
        return effect_of("hysteresis").parameters(scale)

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """The distances of a hysteresis."""
        return effect_of("hysteresis").starts(scale)

    def rate(self, eta: Array, scale: Scale) -> float:
        """That of a hysteresis."""
        plain = effect_of("hysteresis")
        assert isinstance(plain, StateEffect)
        return plain.rate(eta, scale)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force α (x − z)/zs, and ż = |v| (x − z)/zs: the own state z is the slider."""
        strain = (x - z) / eta[1]
        out[FORCE] += eta[0] * strain
        out[RATE] += abs(v) * strain
