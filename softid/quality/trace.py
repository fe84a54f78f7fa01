"""A channel as its faults are sought in it: with its sampling, and in runs of equal values."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.excitation import Quantisation, SampleHold

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

MIN_DISTINCT = 8
"""A channel with fewer runs is a constant with a few changes, of which none can be called odd."""

NOISE_STEPS = 0.6
"""Noise, in steps of the grid, below which a channel may well repeat a value for long: the longest
run in 100,000 samples of rounded noise of this size is one of 21, of half as much one of 115."""

NOISY_BENDS = 0.5
"""Share of the bends that go the other way than the one before from which noise makes them; white
noise turns in three of four, a smooth motion hardly ever."""

ROUNDING_BEND = 1e-9
"""Bends below this share of the range of slopes are rounding."""


@dataclass(frozen=True, eq=False)
class Trace:
    """A channel with what is known about its sampling.

    Attributes
    ----------
    time_s, values
        All samples of the log, shape (n,); values in the display unit may hold NaN.
    quantisation, hold, noise_std
        As found for the channel.
    display_factor
        Factor from ``values`` to the numbers in the file.
    kind
        ``"command"`` (set, not measured), ``"input"`` (what drives) or ``"output"``.
    """

    time_s: Array
    values: Array
    quantisation: Quantisation | None
    hold: SampleHold | None
    noise_std: float | None
    display_factor: float = 1.0
    kind: Literal["command", "input", "output"] = "output"

    @property
    def step(self) -> float:
        """Quantisation step, 0 when there is none."""
        return self.quantisation.step if self.quantisation else 0.0

    @property
    def repeats(self) -> float:
        """Mean number of samples for which the sensor repeats a value."""
        return self.hold.factor if self.hold else 1.0

    @cached_property
    def noisy(self) -> bool:
        """Whether noise moves the channel from sample to sample even at rest.

        Noise shows in slopes that rise and fall in turn more often than not.
        """
        sigma = self.noise_std or 0.0
        if sigma == 0.0 or sigma < NOISE_STEPS * self.step:
            return False
        runs = Runs.of(self.values)
        slopes = np.diff(runs.value) / np.diff(self.time_s[runs.start])
        bends = np.diff(slopes)
        bends = bends[np.abs(bends) > ROUNDING_BEND * float(np.ptp(slopes))]
        return bends.size > 1 and float(np.mean((bends[1:] > 0) != (bends[:-1] > 0))) >= NOISY_BENDS


@dataclass(frozen=True, eq=False)
class Runs:
    """Runs of equal finite values.

    Attributes
    ----------
    start, stop
        Half-open ranges of samples, each of shape (r,).
    value
        Their values, shape (r,).
    """

    start: IntArray
    stop: IntArray
    value: Array

    @property
    def length(self) -> IntArray:
        """Number of samples, shape (r,)."""
        lengths: IntArray = self.stop - self.start
        return lengths

    @classmethod
    def of(cls, values: Array) -> Runs:
        """Cut samples, some of which may be NaN, into runs."""
        finite = np.isfinite(values)
        changed = np.ones(values.size, bool)
        changed[1:] = (values[1:] != values[:-1]) | (finite[1:] != finite[:-1])
        if finite.all() and changed.all():
            start = np.arange(values.size)
            return cls(start, start + 1, values)
        start = np.flatnonzero(changed)
        stop = np.append(start[1:], values.size)
        kept = finite[start]
        return cls(start[kept], stop[kept], values[start[kept]])


def weighted_median(lengths: IntArray) -> float:
    """Length of the run in which the middle sample lies."""
    if not lengths.size:
        return 1.0
    ordered = np.sort(lengths)
    passed = np.cumsum(ordered)
    return float(ordered[int(np.searchsorted(passed, 0.5 * passed[-1]))])
