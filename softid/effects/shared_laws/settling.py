"""What goes on after the motion has settled, with a time constant of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import OutputEffect
from softid.effects.scale import Scale
from softid.effects.shared_laws.time_constants import SETTLING_PERIODS, start_times, time_bounds
from softid.kernels.filters import lag
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

LONGEST_SHARE = 1.0
"""Longest time constant as a share of the log: what takes longer is a drift in it."""

TIMES = (0.03, 0.1, 0.3)
"""Starts of the time constant, as shares of the log."""

SHARE = 0.1
"""Start of the share of a change by which a reading goes on or returns."""


@dataclass(frozen=True)
class SettlingShare(OutputEffect):
    """A reading that goes on or returns by a share of every change, y = x ± c z with τ ż + z = x.

    Attributes
    ----------
    shares
        Bounds of the share c.
    meanings
        What c and τ are.
    direction
        1 where it goes on, −1 where it returns.
    """

    amplitude: ClassVar[str] = "c"
    before_sensor: ClassVar[bool] = True
    begins_with_log: ClassVar[bool] = True
    is_linear: ClassVar[bool] = True
    essential: ClassVar[tuple[str, ...]] = ("tau",)
    shares: ClassVar[tuple[float, float]]
    meanings: ClassVar[tuple[str, str]]
    direction: ClassVar[float]

    def parameters(self, scale: Scale) -> ParameterSet:
        """The share c, and the time constant τ."""
        of_share, of_time = self.meanings
        share = Parameter(
            "c", SHARE, "1", *self.shares, "log", meaning=of_share, source=self.source
        )
        return ParameterSet((share, settling_time(scale, of_time, self.source)))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Times from a thirtieth to a third of the log."""
        return settling_starts("c", self.parameters(scale), scale)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """The reading, settled at the first sample."""
        del scale
        late = np.array(y, np.float64)
        lag(np.diff(time_s), late, float(eta[1]), float(eta[1]))
        read: Array = y + self.direction * float(eta[0]) * late
        return read


def settling_time(scale: Scale, meaning: str, source: str) -> Parameter:
    """The time constant τ of what goes on after the motion has settled, in s.

    Parameters
    ----------
    scale
        Sizes of the base fit.
    meaning, source
        What it is the time of, and where that is found.
    """
    shortest, longest = time_bounds(scale, periods=SETTLING_PERIODS, share=LONGEST_SHARE)
    start = (shortest * longest) ** 0.5
    return Parameter("tau", start, "s", shortest, longest, "log", meaning=meaning, source=source)


def settling_starts(
    amplitude: str, declared: ParameterSet, scale: Scale
) -> tuple[Mapping[str, float], ...]:
    """Starts of an amplitude and a time τ: times from a thirtieth to a third of the log.

    Parameters
    ----------
    amplitude
        Name of the amplitude, which begins at its declared value.
    declared
        The parameters.
    scale
        Sizes of the base fit.
    """
    times = start_times(declared["tau"], scale, TIMES)
    return tuple({amplitude: declared[amplitude].value, "tau": tau} for tau in times)
