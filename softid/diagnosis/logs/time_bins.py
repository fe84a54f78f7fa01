"""Averages over stretches of time, however the samples lie in them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.intersample import HELD, Intersample, knots
from softid.log import Log

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.intp]

LEAST_MEANS = 3
"""A slope is taken from the neighbours on both sides, so fewer means have none."""

MOST_KNOWN = 0.5
"""A mean counts when more than this share of the samples that it should hold are known."""

APART = 1e-6
"""Share of a sampling interval within which a knot is a sample."""


@dataclass(frozen=True, eq=False)
class TimeBins:
    """Stretches of time of one width, over each of which samples are averaged.

    Those without a sample are left out.

    Attributes
    ----------
    time_s
        Times of the samples, shape (n,).
    count
        Median sampling intervals in a bin.
    width_s
        Its width.
    owner
        The bin of each sample, shape (n,), or the number of bins for one that is in none.
    centre_s
        Middles of the bins, shape (g,).
    """

    time_s: Array
    count: int
    width_s: float
    owner: IntArray
    centre_s: Array

    @classmethod
    def of(cls, log: Log, count: int) -> TimeBins:
        """Those of a log, which begin anew behind every stall.

        Parameters
        ----------
        log
            A log.
        count
            Median sampling intervals in a bin.
        """
        width_s = count * log.period_s
        owner, centres, known = np.full(len(log), -1), [], 0
        for segment in log.segments():
            rows = slice(segment.start, segment.stop)
            begin_s = log.time_s[rows][0] - 0.5 * log.period_s
            end_s = log.time_s[rows][-1] + 0.5 * log.period_s
            whole = int((end_s - begin_s) / width_s + APART)
            place = ((log.time_s[rows] - begin_s) / width_s).astype(np.intp)
            owner[rows] = np.where(place < whole, known + place, -1)
            centres.append(begin_s + width_s * (np.arange(whole) + 0.5))
            known += whole
        held = np.unique(owner[owner >= 0])
        owner = np.where(owner >= 0, np.searchsorted(held, owner), held.size)
        middle_s = np.concatenate(centres)[held]
        mean_s = np.bincount(owner, log.time_s)[: held.size] / np.bincount(owner)[: held.size]
        is_same = np.abs(mean_s - middle_s) < APART * log.period_s  # but for rounding
        centre_s = np.where(is_same, mean_s, middle_s)
        return cls(log.time_s, count, width_s, owner, centre_s)

    def _sums(self, values: Array) -> Array:
        """Sums of values at the samples, over each bin, shape (g,)."""
        return np.bincount(self.owner, values, self.centre_s.size + 1)[:-1].astype(np.float64)

    def hold_any(self, marked: BoolArray) -> BoolArray:
        """Which bins hold a marked sample, shape (g,)."""
        held: BoolArray = self._sums(marked.astype(np.float64)) > 0.0
        return held

    def are_known(self, known: BoolArray) -> BoolArray:
        """Which bins hold enough known samples, shape (g,)."""
        enough: BoolArray = self._sums(known.astype(np.float64)) > MOST_KNOWN * self.count
        return enough

    def at_centres(self, values: Array, used: BoolArray) -> Array:
        """Values at the centres of the bins, NaN where too few samples are known, shape (g,).

        The mean of y(c) + d ẏ + d² ÿ/2 over samples at distances d, with ẏ and ÿ from the means
        beside.
        """
        known = used & np.isfinite(values)
        weight = known.astype(np.float64)
        aside_s = self.time_s - np.append(self.centre_s, 0.0)[self.owner]
        counts = np.maximum(self._sums(weight), 1.0)
        mean, first, second = (
            self._sums(part) / counts
            for part in (np.where(known, values, 0.0), weight * aside_s, weight * aside_s**2)
        )
        mean = np.where(self.are_known(known), mean, np.nan)
        slope, bend = np.zeros(mean.size), np.zeros(mean.size)
        if mean.size >= LEAST_MEANS:
            beside = np.abs(np.diff(self.centre_s) / self.width_s - 1.0) < APART * self.count
            even = beside[:-1] & beside[1:] & np.isfinite(np.diff(mean, 2))
            slope[1:-1][even] = (mean[2:] - mean[:-2])[even] / (2.0 * self.width_s)
            bend[1:-1][even] = np.diff(mean, 2)[even] / self.width_s**2
        found: Array = mean - first * slope - 0.5 * second * bend
        return found

    def nodes(self, values: Array, reading: Intersample) -> Array:
        """Input at the centres, whose straight lines have the means of what it did, shape (g,)."""
        knot_s, level = knots(self.time_s, values, reading)
        places = np.searchsorted(self.time_s, knot_s)
        course_s, course = np.insert(self.time_s, places, knot_s), np.insert(values, places, level)
        if reading not in HELD:
            course_s, course = _gone_on(course_s, course, self.width_s)
        edges_s = self.centre_s + 0.5 * self.width_s * np.array([[-1.0], [1.0]])
        begin, end = _integral(course_s, course, edges_s)
        return _straight((end - begin) / self.width_s, np.diff(self.centre_s) / self.width_s)


def _gone_on(course_s: Array, course: Array, further_s: float) -> tuple[Array, Array]:
    """A course that goes straight on at both ends for some time."""
    first, last = (
        np.diff(course[at]) / np.diff(course_s[at]) for at in (slice(2), slice(-2, None))
    )
    return (
        np.concatenate((course_s[:1] - further_s, course_s, course_s[-1:] + further_s)),
        np.concatenate((course[:1] - further_s * first, course, course[-1:] + further_s * last)),
    )


def _integral(course_s: Array, course: Array, at_s: Array) -> Array:
    """∫ of a course that goes straight between its knots, from the first one to some times."""
    areas = 0.5 * (course[1:] + course[:-1]) * np.diff(course_s)
    sums = np.concatenate(([0.0], np.cumsum(areas)))
    last = np.clip(np.searchsorted(course_s, at_s, side="right") - 1, 0, course_s.size - 1)
    there = np.interp(at_s, course_s, course)
    found: Array = sums[last] + 0.5 * (course[last] + there) * (at_s - course_s[last])
    return found


def _straight(means: Array, apart: Array) -> Array:
    """Nodes of a line whose mean over a width of one about each is given.

    A neighbour at a distance h takes 1/(8 h) of the mean from the node itself; the line goes
    straight on at both ends.

    Parameters
    ----------
    means
        The means, shape (g,).
    apart
        Distances between neighbouring nodes, in widths, shape (g − 1,).
    """
    from scipy.linalg import solve_banded

    if means.size < LEAST_MEANS or not np.isfinite(means).all():
        return means
    beside = 0.125 / apart
    bands = np.ones((3, means.size))
    bands[1, 1:-1] -= beside[:-1] + beside[1:]
    bands[0, 2:], bands[0, 1] = beside[1:], 0.0
    bands[2, :-2], bands[2, -2] = beside[:-1], 0.0
    nodes: Array = solve_banded((1, 1), bands, means)
    return nodes
