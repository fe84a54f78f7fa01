"""Cycles of an input, so that loops can be compared by their rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from softid.excitation.motion import turning_points
from softid.plots.traces import segment_spans

Array = npt.NDArray[np.float64]

SWING = 0.25
"""A turn counts when the input comes back by this share of its range; a cycle closes within it."""

SAME_RATE = 1.25
"""Cycles whose rates differ by less than this factor are one family."""

MOST_FAMILIES = 4
_MOST_SAMPLES = 20_000


@dataclass(frozen=True)
class Cycle:
    """One rise and fall of the input.

    Attributes
    ----------
    start, stop
        Half-open range of the samples.
    rate_hz
        One over its duration.
    """

    start: int
    stop: int
    rate_hz: float


@dataclass(frozen=True)
class RateFamily:
    """Members of similar rate.

    Attributes
    ----------
    slowest_hz, fastest_hz
        Their range of rates.
    members
        Positions in the list of rates that was given.
    """

    slowest_hz: float
    fastest_hz: float
    members: tuple[int, ...]

    @property
    def label(self) -> str:
        """Rate and number of cycles, for a legend."""
        count = f"{len(self.members)} cycle{'s' if len(self.members) > 1 else ''}"
        low, high = f"{self.slowest_hz:.2g}", f"{self.fastest_hz:.2g}"
        return f"{low} Hz, {count}" if low == high else f"{low} to {high} Hz, {count}"


def find_cycles(
    time_s: Array,
    input_values: Array,
    segment_starts: Sequence[int] = (0,),
    *,
    smallest_span: float = 0.0,
) -> tuple[Cycle, ...]:
    """Cut an input into cycles from low to low.

    The rate of a cycle is taken between its upward crossing of the middle and the next cycle's:
    where in a hold the low lies is a matter of noise.

    Parameters
    ----------
    time_s, input_values
        Samples, shape (n,), finite.
    segment_starts
        Index of each segment's first sample; no cycle crosses a stall.
    smallest_span
        Range of the input below which it counts as standing still.

    Examples
    --------
    >>> t = np.arange(0.0, 10.0, 0.01)
    >>> [round(c.rate_hz, 2) for c in find_cycles(t, -np.cos(2 * np.pi * 0.25 * t))]
    [0.25, 0.25]
    """
    span = float(np.ptp(input_values))
    if span <= smallest_span:
        return ()
    found: list[Cycle] = []
    for segment in segment_spans(segment_starts, time_s.size):
        start, values = segment.start, input_values[segment]
        thinning = max(-(-values.size // _MOST_SAMPLES), 1)
        turns = turning_points(values[::thinning], SWING * span) * thinning
        lows = [
            (first, last)
            for first, last in pairwise(_lows(values, turns))
            # One that ends in a stall or at the end of the log must close to be a cycle.
            if abs(values[last] - values[first]) <= SWING * span
        ]
        rates = _rates_hz(time_s[segment], values, lows)
        found += [
            Cycle(start + first, start + last + 1, rate)
            for (first, last), rate in zip(lows, rates, strict=True)
        ]
    return tuple(found)


def _lows(values: Array, turns: npt.NDArray[np.intp]) -> list[int]:
    """The low turning points, the ends included where the input rises from or falls to them."""
    anchors = [0, *turns.tolist(), values.size - 1]
    rises_first = len(anchors) > 2 and values[anchors[1]] > values[anchors[0]]
    return anchors[0 if rises_first else 1 :: 2] if len(anchors) > 2 else []


def _rates_hz(time_s: Array, values: Array, lows: Sequence[tuple[int, int]]) -> list[float]:
    """Rate of each cycle, from the upward crossings of the middle level."""
    crossings = []
    for first, last in lows:
        cycle = values[first : last + 1]
        middle = 0.5 * float(cycle.min() + cycle.max())
        crossings.append(float(time_s[first + int(np.argmax(cycle > middle))]))
    rates = []
    for k, (first, last) in enumerate(lows):
        follows = k + 1 < len(lows) and lows[k + 1][0] == last
        led = k > 0 and lows[k - 1][1] == first
        if follows:
            rates.append(1.0 / (crossings[k + 1] - crossings[k]))
        elif led:
            rates.append(rates[-1])
        else:
            rates.append(1.0 / float(time_s[last] - time_s[first]))
    return rates


def families_by_rate(rates_hz: Sequence[float]) -> tuple[RateFamily, ...]:
    """Group rates, slowest first; at most `MOST_FAMILIES` groups.

    Examples
    --------
    >>> [f.label for f in families_by_rate([0.5, 0.1, 0.51])]
    ['0.1 Hz, 1 cycle', '0.5 to 0.51 Hz, 2 cycles']
    """
    if not rates_hz:
        return ()
    rates = np.asarray(rates_hz, dtype=np.float64)
    order = np.argsort(rates, kind="stable")
    groups: list[list[int]] = []
    for k in order.tolist():
        if groups and rates[k] <= SAME_RATE * rates[groups[-1][0]]:
            groups[-1].append(k)
        else:
            groups.append([k])
    if len(groups) > MOST_FAMILIES:
        edges = np.geomspace(rates.min(), rates.max() * (1 + 1e-9), MOST_FAMILIES + 1)
        place = np.searchsorted(edges, rates, side="right") - 1
        groups = [np.flatnonzero(place == g).tolist() for g in range(MOST_FAMILIES)]
    return tuple(
        RateFamily(float(rates[g].min()), float(rates[g].max()), tuple(g)) for g in groups if g
    )
