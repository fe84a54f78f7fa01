"""Smoothing: the record was filtered afterwards, or the reading is a mean over its past."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import OutputEffect
from softid.effects.scale import Scale
from softid.effects.wording import Wording
from softid.even_times import even_interval_s
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

SHARES = (0.1, 0.25, 0.6, 1.5)
"""Starts of the period or the width, in times of the motion."""

LONGEST = 0.1
"""Bound of the period or the width, as a share of the longest log."""

ORDER, MOST_ORDERS = 2.0, 8.0
"""Start and upper bound of the order: filters of the second order are the usual ones, and beyond
the eighth all have the same edge."""

ALIKE = 0.65
"""Second differences over so many periods are as large as those of white noise of the same power,
to 5 % behind a filter of the second order and 15 % between the first and the third."""

EVEN = 0.01
"""Times are even where they are so many intervals off at most."""


@dataclass(frozen=True)
class _Smoothed(OutputEffect):
    """What the forms share; their words are those of a filter that ran over the finished record."""

    meaning: ClassVar[str] = (
        "The output was filtered there and back, or averaged about every sample, after it was "
        "recorded: it begins to move before the pressure does, and has lost edges and fast noise."
    )
    signature: ClassVar[str] = (
        "The residual swings before every fast motion as it does after it, at every level alike."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("sensor_lag", "sensor_resonance", "pneumatic_lag")
    remedy: ClassVar[str] = "leave the record as it was read; a fit needs no smoothing"
    shown_by: ClassVar[str] = "fast steps, and the record as it was before any filter"
    is_linear: ClassVar[bool] = True


@dataclass(frozen=True)
class Smoothing(_Smoothed):
    """A Butterworth filter that ran there and back, Y(f) = X(f)/(1 + (f period)^(2 order)).

    It delays nothing, and a half is left at the cut-off 1/period. Between the first and the third
    order it is close to a Gaussian, to a mean and to a moving polynomial.

    Source: Gustafsson, *IEEE Trans. Signal Process.* 44, 988 (1996), doi 10.1109/78.492552, for the
    way there and back; Butterworth, *Wireless Engineer* 7, 536 (1930), for the filter.
    """

    name: ClassVar[str] = "smoothing"
    title: ClassVar[str] = "Smoothing of the record afterwards"
    law: ClassVar[str] = "recorded Y(f) = X(f)/(1 + (f period)^(2 order))"
    source: ClassVar[str] = (
        "Gustafsson, IEEE Trans. Signal Process. 44, 988 (1996), doi 10.1109/78.492552"
    )
    amplitude: ClassVar[str] = "period"
    essential: ClassVar[tuple[str, ...]] = ("period",)

    def parameters(self, scale: Scale) -> ParameterSet:
        """The period at the cut-off, and the order of the filter."""
        order = Parameter(
            "order",
            ORDER,
            "1",
            1.0,
            MOST_ORDERS,
            "log",
            meaning="order of the filter that ran there and back",
            source=self.source,
        )
        meaning = "period of which a half is left, one over the cut-off"
        return ParameterSet((_time("period", scale, meaning, self.source), order))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """From a fraction of the motion's own time to more than it."""
        return tuple({"period": time_s, "order": ORDER} for time_s in _start_times(scale))

    def alike_within(self, values: Mapping[str, float]) -> float:
        """A part of the period at the cut-off: noise has nothing faster behind the filter."""
        return ALIKE * values["period"]

    def wording(self, values: Mapping[str, float]) -> Wording:
        """With the cut-off as a frequency."""
        if not values["period"] > 0.0:
            return super().wording(values)
        cut_off = f"{self.meaning} The filter's cut-off is {1.0 / values['period']:.3g} Hz."
        return Wording(self.title, cut_off, self.remedy)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Filter the reading; uneven samples are straight lines."""
        del scale
        period, order = float(eta[0]), float(eta[1])
        if period <= 0.0 or y.size < 3:
            return np.array(y, np.float64)
        step_s = even_interval_s(time_s)
        count = round((time_s[-1] - time_s[0]) / step_s) + 1
        even_s = time_s[0] + step_s * np.arange(count)
        is_even = count == y.size and bool(np.all(np.abs(even_s - time_s) < EVEN * step_s))
        even = y if is_even else np.interp(even_s, time_s, y)
        line = np.linspace(even[0], even[-1], count)
        turned = _turned_about_its_ends(even - line)
        cycles = period * np.fft.rfftfreq(turned.size, step_s)
        left = np.fft.rfft(turned) / (1.0 + cycles ** (2.0 * order))
        smooth: Array = line + np.fft.irfft(left, turned.size)[:count]
        return smooth if is_even else np.interp(time_s, even_s, smooth)


@dataclass(frozen=True)
class MeanSmoothing(_Smoothed):
    """A centred mean, y(t) = mean of x from t − width/2 to t + width/2.

    Source: Oppenheim and Schafer, *Discrete-Time Signal Processing*, 3rd ed. 2010, §2.2, the moving
    average with as many samples before as after.
    """

    name: ClassVar[str] = "smoothing"
    variant: ClassVar[str] = "mean"
    title: ClassVar[str] = "Centred mean over the record"
    law: ClassVar[str] = "recorded y(t) = mean of x from t - width/2 to t + width/2"
    source: ClassVar[str] = (
        "Oppenheim and Schafer, Discrete-Time Signal Processing, 3rd ed. 2010, §2.2"
    )
    amplitude: ClassVar[str] = "width"
    essential: ClassVar[tuple[str, ...]] = ("width",)

    def parameters(self, scale: Scale) -> ParameterSet:
        """The width of the window."""
        return ParameterSet((_time("width", scale, "width of the window", self.source),))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """From a fraction of the motion's own time to more than it."""
        return tuple({"width": time_s} for time_s in _start_times(scale))

    def alike_within(self, values: Mapping[str, float]) -> float:
        """The window: two means further apart have no sample in common."""
        return values["width"]

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Means over the window, of which the ends of the log cut off a part."""
        del scale
        return _centred_means(time_s, y, float(eta[0]))


@dataclass(frozen=True)
class PastSmoothing(MeanSmoothing):
    """A moving average, y(t) = mean of x from t − width to t.

    A sensor or its converter forms it. Before the first sample the motion rests. It is a delay
    by width/2 and a centred mean.

    Source: Oppenheim and Schafer, *Discrete-Time Signal Processing*, 3rd ed. 2010, §2.2, the moving
    average that is causal.
    """

    variant: ClassVar[str] = "past"
    title: ClassVar[str] = "Moving average of the reading"
    law: ClassVar[str] = "recorded y(t) = mean of x from t - width to t"
    meaning: ClassVar[str] = (
        "The sensor, or what reads it, averages over the last samples: the reading follows the "
        "motion late, has arrived when the window has passed, and has lost edges and fast noise."
    )
    signature: ClassVar[str] = (
        "The residual is in proportion to the speed of the motion, with the same factor at every "
        "level and in both directions, and ends at once when the window has passed."
    )
    remedy: ClassVar[str] = "record without the average, or shorten it; a fit needs no smoothing"
    shown_by: ClassVar[str] = "fast steps"

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Means over what has passed."""
        del scale
        window_s = float(eta[0])
        if window_s <= 0.0 or y.size < 2:
            return np.array(y, np.float64)
        begin_s = time_s - window_s
        area = _areas(time_s, y)
        before = _area_at(np.maximum(begin_s, time_s[0]), time_s, y, area)
        before += np.minimum(begin_s - time_s[0], 0.0) * y[0]
        means: Array = (area - before) / window_s
        return means


def _time(name: str, scale: Scale, meaning: str, source: str) -> Parameter:
    start = SHARES[1] * scale.motion_s
    return Parameter(name, start, "s", 0.0, _longest(scale), meaning=meaning, source=source)


def _longest(scale: Scale) -> float:
    return max(LONGEST * scale.duration_s, scale.motion_s)


def _start_times(scale: Scale) -> list[float]:
    times_s: list[float] = np.minimum(np.array(SHARES) * scale.motion_s, _longest(scale)).tolist()
    return list(dict.fromkeys(times_s))


def _turned_about_its_ends(y: Array) -> Array:
    """One period of a record that ends at zero and goes on turned by half a turn about each end."""
    return np.concatenate((y, -y[-2:0:-1]))


def _centred_means(time_s: Array, y: Array, window_s: float) -> Array:
    """Means of straight lines over a window about each time, of which the ends cut off a part."""
    if y.size < 2:
        return np.array(y, np.float64)
    area = _areas(time_s, y)
    begin_s, end_s = (
        np.clip(time_s + side * window_s, time_s[0], time_s[-1]) for side in (-0.5, 0.5)
    )
    width_s = end_s - begin_s
    narrow = width_s <= 0.0
    means = (_area_at(end_s, time_s, y, area) - _area_at(begin_s, time_s, y, area)) / np.where(
        narrow, 1.0, width_s
    )
    return np.where(narrow, y, means)


def _areas(time_s: Array, y: Array) -> Array:
    """The integral of straight lines through some samples up to each of them."""
    found: Array = np.concatenate(([0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(time_s))))
    return found


def _area_at(at_s: Array, time_s: Array, y: Array, area: Array) -> Array:
    """The integral of straight lines through some samples up to some times."""
    k = np.clip(np.searchsorted(time_s, at_s, side="right") - 1, 0, time_s.size - 2)
    since_s = at_s - time_s[k]
    slope = (y[k + 1] - y[k]) / (time_s[k + 1] - time_s[k])
    found: Array = area[k] + since_s * (y[k] + 0.5 * slope * since_s)
    return found
