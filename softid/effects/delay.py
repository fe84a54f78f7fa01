"""Delay: the input arrives later than it is recorded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import InputEffect
from softid.effects.extension.stage_input import holds_jumps
from softid.effects.scale import Scale
from softid.effects.shared_laws.time_constants import first_time
from softid.kernels.earlier_input import means_between, read_at
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

LONGEST_S = 1.0
"""Longest delay: valves, controllers and buses take less, and clocks that are farther apart are
seen by eye."""

LONGEST_SHARE = 0.1
"""Longest delay as a share of the log, of which nothing is known for as long at its beginning."""

USUAL_PERIODS = 4.0
"""A moderate delay, in sampling intervals."""

LAST_SHARE = 0.5
"""The longest start, as a share of the longest delay: a search from the bound would be held
there."""


@dataclass(frozen=True)
class Delay(InputEffect):
    """Pure delay, pa(t) = p(t − τ).

    The kinks of the recorded input stay kinks. A delay is never negative: an output whose clock
    runs ahead belongs to the offset between the clocks of the channels.

    Source: Ljung, *System Identification*, 2nd ed. 1999, §4.2.
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
    is_linear: ClassVar[bool] = True
    has_one_form: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The delay τ, at most 1 s and a tenth of the log."""
        longest = min(LONGEST_S, LONGEST_SHARE * scale.duration_s)
        return ParameterSet(
            (
                Parameter(
                    "tau",
                    min(USUAL_PERIODS * scale.period_s, LAST_SHARE * longest),
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
        shortest = first_time(scale, longest)
        return tuple({"tau": float(t)} for t in np.geomspace(shortest, LAST_SHARE * longest, 4))

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The straight-line input, read τ earlier; its means where it jumps.

        A jump read at single times would move from one to the next as τ changes, by steps.
        """
        del scale
        if holds_jumps(time_s):
            return _means_before(eta[0], time_s, u)
        arriving = np.empty(u.size)
        read_at(time_s - eta[0], time_s, u, arriving)
        return arriving


def _means_before(tau: float, time_s: Array, u: Array) -> Array:
    """Mean of the straight-line input around every time, half way to its neighbours, τ earlier."""
    middle = 0.5 * (time_s[1:] + time_s[:-1])
    edges = np.concatenate((time_s[:1], middle, time_s[-1:])) - tau
    means = np.empty(u.size)
    means_between(edges, time_s, u, means)
    return means
