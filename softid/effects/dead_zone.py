"""Dead zone: nothing moves until the input passes a threshold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import InputEffect
from softid.effects.scale import Scale
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

LARGEST_SHARE = 0.6
"""Bound of the threshold in the range of the input: above it too little of a log would move."""

START_SHARES = (0.05, 0.15, 0.4)
"""Starts of the threshold in the range of the input."""

SOFTNESS = (0.02, 0.1, 0.5)
"""Bounds and start of the width of the bend over the threshold. A sharper bend is a corner to every
log; a softer one reaches down to no input at all, and is no threshold."""


@dataclass(frozen=True)
class DeadZone(InputEffect):
    """Dead zone with a rounded edge, pa = S(p) − S(−p) with S(p) = w ln(1 + e^{(p − p0)/w}).

    The law is odd, so that an input of either sign has the dead zone on both sides of zero and
    nothing arrives at p = 0. The width w of the bend is a multiple of p0, so that p0 = 0 is no
    effect. An input that never comes near zero shows the zone only if p0 lies within its range, so
    the bound lies there too.

    Source: Tao and Kokotović, *Adaptive Control of Systems with Actuator and Sensor
    Nonlinearities*, Wiley 1996.
    """

    name: ClassVar[str] = "dead_zone"
    title: ClassVar[str] = "Dead zone of the input"
    law: ClassVar[str] = "pa = S(p) - S(-p),  S(p) = w ln(1 + exp((p - p0)/w)),  w = softness p0"
    meaning: ClassVar[str] = (
        "Below a threshold the input does nothing: a valve's overlap, a slack sleeve or a folded "
        "bladder must be overcome first."
    )
    signature: ClassVar[str] = (
        "The residual is flat below one input and bends there; the simulation moves before the "
        "actuator does."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("static_curve", "coulomb_friction", "stiffening")
    remedy: ClassVar[str] = "start from a pressure above the threshold, or preload the sleeve"
    shown_by: ClassVar[str] = "a fine staircase near zero input"
    source: ClassVar[str] = (
        "Tao and Kokotović, Adaptive Control of Systems with Actuator and Sensor Nonlinearities, "
        "Wiley 1996"
    )
    amplitude: ClassVar[str] = "p0"
    ceilings: ClassVar[tuple[str, ...]] = ("p0", "softness")

    def parameters(self, scale: Scale) -> ParameterSet:
        """The threshold p0, and the width of its bend as a share of it."""
        return ParameterSet(
            (
                Parameter(
                    "p0",
                    _at_share(scale, START_SHARES[1]),
                    scale.u_unit,
                    0.0,
                    _at_share(scale, LARGEST_SHARE),
                    meaning="threshold below which nothing arrives",
                    source=self.source,
                ),
                Parameter(
                    "softness",
                    SOFTNESS[1],
                    "1",
                    SOFTNESS[0],
                    SOFTNESS[2],
                    "log",
                    meaning="width of the bend over the threshold",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Thresholds in the lower part of the range."""
        return tuple(
            {"p0": _at_share(scale, share), "softness": SOFTNESS[1]} for share in START_SHARES
        )

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The input without its dead zone."""
        del time_s, scale
        threshold, width = float(eta[0]), float(eta[0] * eta[1])
        if threshold <= 0.0:
            return np.array(u, np.float64)
        passed = _soft_part((u - threshold) / width) - _soft_part((-u - threshold) / width)
        return width * passed


def _soft_part(z: Array) -> Array:
    """ln(1 + e^z), several times faster than `numpy.logaddexp`."""
    found: Array = np.maximum(z, 0.0) + np.log1p(np.exp(-np.abs(z)))
    return found


def _at_share(scale: Scale, share: float) -> float:
    """A threshold between the recorded inputs nearest to and farthest from zero."""
    farthest = max(abs(scale.u_low), abs(scale.u_high))
    passes_zero = scale.u_low <= 0.0 <= scale.u_high
    nearest = 0.0 if passes_zero else min(abs(scale.u_low), abs(scale.u_high))
    return nearest + share * (farthest - nearest)
