"""Clock rate: the sensor's clock runs faster or slower than the input's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import OutputEffect
from softid.effects.scale import Scale
from softid.kernels.filters import cubic
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

LARGEST = 0.05
"""Bound of the relative rate: clocks that run farther apart were given a wrong period, which is to
be mended in the log."""

START_SHIFTS = (0.2, 1.0)
"""Shifts at the end of the log for the starts, in motion times."""

START_SHARE = 0.5
"""The starts' largest share of the bound, at which a search would be held."""


@dataclass(frozen=True)
class ClockRate(OutputEffect):
    """Reading on a clock with another rate, y(t) = x((1 + rate) t), t from the start of the log.

    Between samples the motion is the cubic through its four nearest samples. Before the first and
    after the last one it runs out from its speed there within the motion's own time.

    Source: linear clock model; IEEE Std 1588-2019.
    """

    name: ClassVar[str] = "clock_rate"
    title: ClassVar[str] = "Clock-rate error between input and output"
    law: ClassVar[str] = "recorded y(t) = x((1 + rate) t)"
    meaning: ClassVar[str] = (
        "Input and output are time-stamped by two clocks that run at different rates, so the "
        "output is recorded earlier and earlier, or later and later."
    )
    signature: ClassVar[str] = (
        "The residual is proportional to the speed of the motion times the time since the start."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("delay", "sensor_lag", "ageing")
    remedy: ClassVar[str] = "stamp all channels with one clock, or mark the start and end in both"
    shown_by: ClassVar[str] = "the same fast steps at the beginning and end of a long log"
    source: ClassVar[str] = "linear clock model; IEEE Std 1588-2019"
    amplitude: ClassVar[str] = "rate"
    is_linear: ClassVar[bool] = True
    changes_sign: ClassVar[bool] = True
    begins_with_log: ClassVar[bool] = True
    has_one_form: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The relative rate, within five per cent."""
        return ParameterSet(
            (
                Parameter(
                    "rate",
                    _rates(scale)[0],
                    "1",
                    -LARGEST,
                    LARGEST,
                    meaning="relative rate error: what is stamped t was measured at (1 + rate) t "
                    "of the input's clock",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Shifts within the log of a part and of the whole of the motion's time, either way."""
        return tuple({"rate": sign * rate} for rate in _rates(scale) for sign in (1.0, -1.0))

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """The motion read at (1 + rate) t."""
        at_s = (1.0 + eta[0]) * time_s
        if eta[0] == 0.0 or y.size < 2:
            return np.array(y, np.float64)
        within_s = np.clip(at_s, time_s[0], time_s[-1])
        recorded = np.empty(y.size)
        if y.size < 4:
            recorded[:] = np.interp(within_s, time_s, y)
        else:
            cubic(np.array(time_s, np.float64), np.array(y, np.float64), within_s, recorded)
        ends_s = max(scale.motion_s, scale.period_s)
        speed = np.where(
            at_s < time_s[0],
            (y[1] - y[0]) / (time_s[1] - time_s[0]),
            (y[-1] - y[-2]) / (time_s[-1] - time_s[-2]),
        )
        outside_s = at_s - within_s
        recorded -= speed * ends_s * np.sign(outside_s) * np.expm1(-np.abs(outside_s) / ends_s)
        return recorded


def _rates(scale: Scale) -> tuple[float, ...]:
    slowest_s = max(scale.motion_s, scale.period_s)
    return tuple(
        min(shift * slowest_s / scale.duration_s, START_SHARE * LARGEST) for shift in START_SHIFTS
    )
