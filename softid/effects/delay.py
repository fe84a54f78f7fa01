"""Delay: the input arrives later than it is recorded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import InputEffect, Scale
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

LONGEST_S = 1.0
LONGEST_SHARE = 0.1
"""Longest delay, in seconds and as a share of the log."""


@dataclass(frozen=True)
class Delay(InputEffect):
    """Pure delay, pa(t) = p(t − τ).

    The kinks of the recorded input stay kinks. A delay is never negative: an output whose clock
    runs ahead belongs to the offset between the clocks of the channels.
    """

    name: ClassVar[str] = "delay"
    title: ClassVar[str] = "Delay of the input"
    law: ClassVar[str] = "pa(t) = p(t - tau)"
    meaning: ClassVar[str] = (
        "Everything happens a fixed time after the recorded input says it should: a valve or a "
        "controller waits, or the clocks of the channels are offset."
    )
    signature: ClassVar[str] = (
        "The residual is a short pulse after every change of the input, in proportion to the rate "
        "of the input just before."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("pneumatic_lag", "sensor_lag", "line_resonance")
    remedy: ClassVar[str] = (
        "stamp all channels with one clock; record the pressure at the actuator, not the command"
    )
    shown_by: ClassVar[str] = "fast steps, or a chirp"
    source: ClassVar[str] = "Ljung, System Identification, 2nd ed. 1999, §4.2"
    amplitude: ClassVar[str] = "tau"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The delay τ, at most 1 s and a tenth of the log."""
        longest = min(LONGEST_S, LONGEST_SHARE * scale.duration_s)
        return ParameterSet(
            (
                Parameter(
                    "tau",
                    min(4.0 * scale.period_s, 0.5 * longest),
                    "s",
                    0.0,
                    longest,
                    meaning="delay between the recorded and the arriving input",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """From two samples to half of the longest delay."""
        longest = self.parameters(scale)["tau"].upper
        shortest = min(2.0 * scale.period_s, 0.1 * longest)
        return tuple({"tau": float(t)} for t in np.geomspace(shortest, 0.5 * longest, 4))

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The straight-line input, read τ earlier."""
        del scale
        arriving: Array = np.interp(time_s - eta[0], time_s, u)
        return arriving
