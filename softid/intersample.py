"""What the input does between its samples: straight from one to the next, smooth, or held.

A recorded command, or an input that was written as steps, changes within one sampling interval and
is flat before and after. Taken as straight it comes half an interval early, which looks like a
delay of the actuator. It may be held at its jumps alone, where the rest of it is a measured course,
or at every sample, as a digital controller holds it (zero-order hold). Where samples were lost it
changed at any of them: held over the gap it would come late.

A measured course that swings within a few samples is cut short by straight lines: a sine of ω by
(ω h)²/12 of its amplitude, at an interval of h. What is taken from it grows with the frequency, as
behind a resonance or a lag. Where it bends at both ends of an interval alike, it is known better.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.even_times import even_interval_s

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

Intersample = Literal["straight", "smooth", "held", "zoh"]
"""Straight (first-order hold), smooth where it bends, that and held where it jumps, or held at
every sample (zero-order hold)."""

INTERSAMPLE_CHOICES: tuple[Intersample, ...] = ("straight", "smooth", "held", "zoh")
"""What an input may do between its samples, the plainest first."""

HELD: tuple[Intersample, ...] = ("held", "zoh")

InputNoise = Literal["averaged"]
"""What is done about the noise of an input; None does nothing."""

AVERAGED: InputNoise = "averaged"
"""What the record of a fit says of an input whose noise was taken away."""

FLAT = 0.1
"""Before and after a jump the input moves by less than this share of it."""

ABOVE_NOISE = 8.0
"""Least size of a jump in times the median change between two samples."""

SMALLEST = 0.005
"""Least size of a jump as a share of the input's range: smaller ones move nothing that could be
seen."""

BEFORE = 1e-3
"""A held input jumps this share of the interval before the next sample."""

GAP_PERIODS = 1.5
"""An interval has lost a sample when it is so many sampling periods long."""

GAP_SPREADS = 3.0
"""Usual spreads by which an interval exceeds a sampling period where it has lost a sample: where a
clock trembles, long intervals are as usual as short ones."""

UNEVEN = 0.35
"""A clock keeps no period where a quarter of the intervals are shorter than the median by this
share of it: a long one has lost nothing. Trembling by a fifth of a period, either way, makes it
0.12, and samples at random times 0.58."""

MAD_TO_STD = 1.4826
"""Standard deviation over median absolute deviation, for a normal law."""

LEAST_ABRUPT = 0.05
"""Share of the input's range by which it changes abruptly at least."""

WITHIN = 0.6
"""An abrupt change is this share of that over three intervals: one that takes several samples is
drawn as it was."""

LEAST_BEND = 1e-3
"""Share of the input's range by which a cubic leaves the straight line at least: a lesser bend
moves nothing that could be seen."""

SAME_AREA = 4.0 / 3.0
"""Height of a triangle over that of a cubic above the same line and of the same area: an actuator
that is slow beside the interval feels the area alone."""

OF_THIRD_DIFFERENCE = 6.0 / (0.6745 * 20.0**0.5)
"""Standard deviation of white noise over the median size of its third divided difference times the
interval cubed; the third difference itself is six times that, and has 20 times the variance."""

ABOVE_ITS_NOISE = 0.25
"""Least bend in standard deviations of the input's noise: noise bends with an eighth of one; twice
as much is a bend."""

RESOLVED = 3.0
"""Largest ratio of the second derivatives at both ends of an interval: where a course is sampled
fast enough it bends there alike. A corner does not, nor does noise."""

LONGEST_BENT = 10.0
"""No cubic spans an interval of more periods: the slopes beside it say nothing of its middle."""

LEAST_READINGS = 4
"""Fewest readings between two jumps that make a cubic."""


def jumps(values: Array) -> IntArray:
    """Indices k such that the input jumps between samples k and k + 1 and is flat on both sides.

    Parameters
    ----------
    values
        Input samples without gaps, shape (n,).

    Examples
    --------
    >>> jumps(np.array([0.0, 0.0, 0.0, 50.0, 50.0, 50.0])).tolist()
    [2]
    >>> jumps(np.array([0.0, 0.0, 20.0, 50.0, 50.0, 50.0])).tolist()
    []
    """
    if values.size < 3:
        return np.empty(0, np.int64)
    from softid.kernels.input_jumps import count_changes, find_jumps

    values, room = np.ascontiguousarray(values, float).view(), np.empty(values.size // 2, np.int64)
    values.flags.writeable = False  # one type for the compiler, whatever came in
    least = max(SMALLEST * float(np.ptp(values)), np.finfo(float).tiny)
    found = room[: find_jumps(values, least, FLAT, room)].copy()
    if found.size == 0:
        return found
    moves, count = np.abs(values[found + 1] - values[found]), values.size - 1
    noise = np.nextafter(float(moves.min()) / ABOVE_NOISE, np.inf)
    if 2 * (count - count_changes(values, noise)) <= count + 1:  # else the median is less
        found = found[moves >= ABOVE_NOISE * float(np.median(np.abs(np.diff(values))))]
    return found


def is_abrupt(values: Array) -> npt.NDArray[np.bool_]:
    """Which intervals hold nearly all of a large change, shape (n − 1,).

    `jumps` asks for an input that is flat before and after, as a held one is; here the rest of a
    jump may be seen in the samples beside it.

    Parameters
    ----------
    values
        Input samples without gaps, shape (n,).

    Examples
    --------
    >>> is_abrupt(np.array([0.0, 1.0, 30.0, 36.0, 37.0])).tolist()
    [False, True, False, False]
    """
    change = np.abs(np.diff(values))
    if change.size == 0:
        return np.zeros(0, np.bool_)
    least = max(LEAST_ABRUPT * float(np.ptp(values)), ABOVE_NOISE * float(np.median(change)))
    beside = np.convolve(change, np.ones(3), "same")[: change.size]
    found: npt.NDArray[np.bool_] = (change > least) & (change > WITHIN * beside)
    return found


def course_at(time_s: Array, read_s: Array, read: Array) -> Array:
    """The input at some times: a cubic spline through the readings, but straight where it jumps.

    What a spline swings beside a jump is not on record.

    Parameters
    ----------
    time_s
        The times, shape (n,).
    read_s, read
        When the input was read, rising, and what it was then, each of shape (R,).

    Returns
    -------
    Array
        Shape (n,); before the first reading and after the last one it is as then.
    """
    from scipy.interpolate import CubicSpline

    course: Array = np.interp(time_s, read_s, read)
    ends = np.flatnonzero(is_abrupt(read)) + 1
    for first, stop in pairwise((0, *ends.tolist(), read.size)):
        if stop - first >= LEAST_READINGS:
            smooth = CubicSpline(read_s[first:stop], read[first:stop])
            inside = (time_s >= read_s[first]) & (time_s <= read_s[stop - 1])
            course[inside] = smooth(time_s[inside])
    return course


def recorded_intersample(told: object) -> Intersample | None:
    """The behaviour that a record tells, None where it tells none that is known."""
    return next((known for known in INTERSAMPLE_CHOICES if known == told), None)


def knots(time_s: Array, values: Array, intersample: Intersample) -> tuple[Array, Array]:
    """Times and values to be put in just before the samples at which a held input changes.

    Where samples were lost it changes at each of them, by as much every time.

    Parameters
    ----------
    time_s, values
        Sample times and input, each of shape (n,).
    intersample
        ``"zoh"`` for every change, ``"smooth"`` for the middle of every interval in which the input
        bends, ``"held"`` for those and the jumps, ``"straight"`` for none.

    Returns
    -------
    Array, Array
        In order of time, each of shape (m,) for m changes.
    """
    if intersample == "straight":
        return np.empty(0), np.empty(0)
    if intersample == "smooth":
        return _bends(time_s, values)
    at = np.flatnonzero(np.diff(values)) if intersample == "zoh" else jumps(values)
    is_lost = np.isin(at, lost_intervals(time_s))
    whole = at[~is_lost]
    stop_s = time_s[whole + 1]
    parts = [(stop_s - BEFORE * (stop_s - time_s[whole]), values[whole])]
    if is_lost.any():
        period_s = even_interval_s(time_s)
        parts += [_staircase(time_s[k : k + 2], values[k : k + 2], period_s) for k in at[is_lost]]
    if intersample == "held":
        parts.append(_bends(time_s, values))
    knot_s, level = (np.concatenate(each) for each in zip(*parts, strict=True))
    order = np.argsort(knot_s)
    return knot_s[order], level[order]


def lost_intervals(time_s: Array) -> IntArray:
    """Indices k such that samples were lost between k and k + 1; none where a clock has no period.

    Parameters
    ----------
    time_s
        Sample times, shape (n,).

    Examples
    --------
    >>> lost_intervals(np.array([0.0, 0.1, 0.2, 0.3, 0.5, 0.6])).tolist()
    [3]
    """
    interval_s = np.diff(time_s)
    if interval_s.max(initial=0.0) <= GAP_PERIODS * interval_s.min(initial=np.inf):
        return np.empty(0, np.int64)  # what follows would ask for more periods than that
    quarter_s, period_s = np.quantile(interval_s, (0.25, 0.5))
    if quarter_s < (1.0 - UNEVEN) * period_s:
        return np.empty(0, np.int64)
    spread_s = MAD_TO_STD * float(np.median(np.abs(interval_s - period_s)))
    longest_s = max(GAP_PERIODS * period_s, period_s + GAP_SPREADS * spread_s)
    found: IntArray = np.flatnonzero(interval_s > longest_s)
    return found


def _staircase(time_s: Array, values: Array, period_s: float) -> tuple[Array, Array]:
    """A step at each sample that was lost, as high as the next: what is expected of one somewhere.

    Parameters
    ----------
    time_s, values
        The samples before and after, each of shape (2,).
    """
    count = max(round((time_s[1] - time_s[0]) / period_s), 1)
    share = np.arange(1, count + 1) / count
    stop_s = time_s[0] + (time_s[1] - time_s[0]) * share
    stop = values[0] + (values[1] - values[0]) * share
    start = np.append(values[0], stop[:-1])
    before_s = stop_s - BEFORE * (time_s[1] - time_s[0]) / count
    knot_s = np.column_stack((before_s, stop_s)).ravel()
    level = np.column_stack((start, stop)).ravel()
    return knot_s[:-1], level[:-1]


def _bends(time_s: Array, values: Array) -> tuple[Array, Array]:
    """Middles of the intervals in which the input bends, above the cubic through four samples."""
    least = LEAST_BEND * float(np.ptp(values))
    if values.size < 4 or least == 0.0:
        return np.empty(0), np.empty(0)
    from softid.kernels.input_bends import bends_in_the_middle, third_steps

    time_s, values = np.ascontiguousarray(time_s), np.ascontiguousarray(values)
    nothing = np.empty(0, np.int64), np.empty(0)
    count = bends_in_the_middle(time_s, values, RESOLVED, least, *nothing)
    if count == 0:
        return np.empty(0), np.empty(0)
    at, bend = np.empty(count, np.int64), np.empty(count)
    bends_in_the_middle(time_s, values, RESOLVED, least, at, bend)
    steps = np.empty(values.size - 3)
    third_steps(time_s, values, steps)
    noise = float(np.median(steps)) * OF_THIRD_DIFFERENCE
    interval_s = np.diff(time_s)
    is_short = interval_s[at] <= LONGEST_BENT * float(np.median(interval_s))
    bends = is_short & (np.abs(bend) >= ABOVE_ITS_NOISE * noise)
    at, bend = at[bends], bend[bends]
    middle_s = time_s[at] + 0.5 * interval_s[at]
    return middle_s, 0.5 * (values[at] + values[at + 1]) + SAME_AREA * bend
