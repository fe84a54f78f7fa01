"""Cycles of an input, so that loops can be compared by their rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.excitation.holds import turning_points

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
    time_s: Array, input_values: Array, segment_starts: Sequence[int] = (0,)
) -> tuple[Cycle, ...]:
    """Cut an input into cycles from low to low.

    Parameters
    ----------
    time_s, input_values
        Samples, shape (n,), finite.
    segment_starts
        Index of each segment's first sample; no cycle crosses a stall.

    Examples
    --------
    >>> t = np.arange(0.0, 10.0, 0.01)
    >>> [round(c.rate_hz, 2) for c in find_cycles(t, -np.cos(2 * np.pi * 0.25 * t))]
    [0.25, 0.25]
    """
    span = float(np.ptp(input_values))
    if span == 0.0:
        return ()
    found: list[Cycle] = []
    edges = [*segment_starts, time_s.size]
    for start, stop in zip(edges[:-1], edges[1:], strict=True):
        values = input_values[start:stop]
        thinning = max(-(-values.size // _MOST_SAMPLES), 1)
        turns = turning_points(values[::thinning], SWING * span) * thinning
        for first, last in zip(*_lows(values, turns), strict=True):
            # A cycle that ends in a stall or at the end of the log must close to be one.
            if abs(values[last] - values[first]) > SWING * span:
                continue
            duration = float(time_s[start + last] - time_s[start + first])
            found.append(Cycle(start + first, start + last + 1, 1.0 / duration))
    return tuple(found)


def _lows(values: Array, turns: npt.NDArray[np.intp]) -> tuple[list[int], list[int]]:
    """First and last sample of every stretch between neighbouring lows, the ends included."""
    anchors = [0, *turns.tolist(), values.size - 1]
    if len(anchors) < 3:
        return [], []
    rises_first = values[anchors[1]] > values[anchors[0]]
    lows = anchors[0 if rises_first else 1 :: 2]
    return lows[:-1], lows[1:]


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
