"""Softening: the first cycles make the rubber softer."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from softid.effects.base import LEAST_AMPLITUDE, MOST_LOST, StateEffect
from softid.effects.scale import Scale
from softid.kernels.terms import RATE, STIFFNESS
from softid.parameters import Parameter, ParameterSet

SHARE = 0.1
"""Start of the share of the stiffness that goes."""

PATHS = (0.05, 0.2, 0.7)
"""Starts of the path, as shares of the whole one."""

SHORTEST, LONGEST = 0.01, 3.0
"""Bounds of the path, as shares of the whole one. A softening that is sooner done has no samples;
of one that takes longer the log holds a quarter, which is nearly in proportion to the path: how far
it would go is not seen."""


@dataclass(frozen=True)
class Softening(StateEffect):
    r"""Softening by use, Q (1 − s (1 − exp(−W/W0))) with W = ∫|v| dt.

    The own state is w = W/W0, which is 0 at the beginning and grows with the path, not with time.

    Source: Mullins 1969, doi 10.5254/1.3539210; as a damage law Simo 1987,
    doi 10.1016/0045-7825(87)90107-1.
    """

    name: ClassVar[str] = "softening"
    title: ClassVar[str] = "Softening by use (Mullins effect)"
    law: ClassVar[str] = "Q (1 - s (1 - exp(-W/W0))) in place of Q,  W' = |v|"
    meaning: ClassVar[str] = (
        "The first cycles make the rubber softer, so that the same pressure moves it further and "
        "further until it has settled in."
    )
    signature: ClassVar[str] = (
        "The residual grows with the path covered, quickly in the first cycles, and stands still "
        "while the actuator rests."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("ageing", "sensor_warmup")
    remedy: ClassVar[str] = "cycle a new actuator over its full range before it is used"
    shown_by: ClassVar[str] = "many cycles with pauses between them"
    source: ClassVar[str] = "Mullins 1969, doi 10.5254/1.3539210"
    begins_with_log: ClassVar[bool] = True
    amplitude: ClassVar[str] = "s"
    counts_position: ClassVar[bool] = True
    essential: ClassVar[tuple[str, ...]] = ("W0",)
    has_state: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """Share s of the stiffness that goes, and the path W0 over which it goes."""
        return ParameterSet(
            (
                Parameter(
                    "s",
                    SHARE,
                    "1",
                    LEAST_AMPLITUDE,
                    MOST_LOST,
                    "log",
                    meaning="share of the stiffness that is lost in the end",
                    source=self.source,
                ),
                Parameter(
                    "W0",
                    PATHS[1] * scale.travel,
                    scale.x_unit,
                    SHORTEST * scale.travel,
                    LONGEST * scale.travel,
                    "log",
                    meaning="path over which it is lost",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Paths from the first cycles to most of the log."""
        return tuple({"s": SHARE, "W0": share * scale.travel} for share in PATHS)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Relative change −s (1 − exp(−w)) of the stiffness, and ẇ = |v|/W0."""
        out[STIFFNESS] -= eta[0] * (1.0 - math.exp(-z))
        out[RATE] += abs(v) / eta[1]
