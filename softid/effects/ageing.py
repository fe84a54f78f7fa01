"""Ageing: the stiffness changes steadily with time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from softid.effects.base import StateEffect
from softid.effects.scale import Scale
from softid.effects.shared_laws.one_start import OneStart
from softid.effects.shared_laws.steady_change import relative_rate
from softid.kernels.terms import STIFFNESS
from softid.parameters import ParameterSet


@dataclass(frozen=True)
class Ageing(OneStart, StateEffect):
    r"""Stiffness that changes at a constant rate, Q (1 + r t).

    To first order in time an actuator that warms up or wears changes so over a long log.

    Source: Treloar, *The Physics of Rubber Elasticity*, ch. 2 (stiffness and temperature).
    """

    name: ClassVar[str] = "ageing"
    title: ClassVar[str] = "Stiffness that changes with time"
    law: ClassVar[str] = "Q (1 + r t) in place of Q"
    meaning: ClassVar[str] = (
        "The actuator slowly grows softer or stiffer while the log runs, whether it moves or not, "
        "as when it warms up or wears."
    )
    signature: ClassVar[str] = (
        "The residual grows in proportion to time and to the position: it is largest at high "
        "levels late in the log and vanishes where the position is zero."
    )
    neighbours: ClassVar[tuple[str, ...]] = (
        "softening",
        "sensor_gain_drift",
        "sensor_drift",
        "sensor_warmup",
    )
    remedy: ClassVar[str] = "let it reach its temperature first, or identify it again now and then"
    shown_by: ClassVar[str] = "the same two levels at the beginning and at the end of a long log"
    source: ClassVar[str] = "Treloar, The Physics of Rubber Elasticity, ch. 2"
    begins_with_log: ClassVar[bool] = True
    amplitude: ClassVar[str] = "r"
    counts_position: ClassVar[bool] = True
    changes_sign: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The rate r; a negative one leaves a tenth of the stiffness at the end of the log."""
        meaning = "share of the stiffness gained each second"
        return relative_rate("r", scale, meaning=meaning, source=self.source)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Relative change r t of the stiffness."""
        out[STIFFNESS] += eta[0] * t
