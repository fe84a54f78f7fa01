"""The readings that an interpolation was made of: its straight pieces meet where they were taken.

A sensor of 40 readings a second brought to a clock of 100 leaves two or three samples between two
readings. The lines through them meet at the times of the readings, whose clock is then known far
better than to a sample, and with the clock every reading is known as well.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.even_times import even_interval_s
from softid.identification.sensor_clock import SensorClock

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.intp]

LEAST_CORNERS = 20
"""Corners that a clock is found from."""

FIRST_CORNERS = 64
"""Corners that are looked at first, then twice as many, and so on: the period gets sharper."""

TIMED, AT_TIMES = 0.25, 0.5
"""A corner is at a time of the clock when it misses it by less than this share of a sampling
interval, and so many of them must be: where values are rounded lines meet a little beside it."""

SAMPLED = 0.02
"""Distance, as a share of the bends between readings, within which samples must lie of the
readings."""

LEAST_NEAR_READINGS = 0.98
"""Share of the samples that must lie within `SAMPLED` of the readings."""

TOLD = 0.05
"""A reading that samples beside it hold less of than this, all together, is unknown: squared
weights in an interpolation, at the ends of a log and across a gap."""


def reading_clock(time_s: Array, values: Array, straight: BoolArray) -> SensorClock | None:
    """The clock of the readings between which samples are straight; None where none explains them.

    Parameters
    ----------
    time_s, values
        The samples, each of shape (n,).
    straight
        Which of them lie on the line through their neighbours, shape (n,).

    Examples
    --------
    >>> time_s, readings = np.arange(200.0), np.random.default_rng(0).normal(size=80)
    >>> values = np.interp(time_s, 0.3 + 2.6 * np.arange(80.0), readings)
    >>> off = np.abs(np.diff(values, 2))
    >>> straight = np.concatenate(([False], off < 1e-9, [False]))
    >>> round(reading_clock(time_s, values, straight).period_s, 6)
    2.6
    """
    corners_s = _corners(time_s, values, straight)
    if corners_s.size < LEAST_CORNERS:
        return None
    row_s = even_interval_s(time_s)
    clock = _first_clock(corners_s[:FIRST_CORNERS], row_s)
    doublings = int(np.ceil(np.log2(max(corners_s.size / FIRST_CORNERS, 1.0))))
    for count in (FIRST_CORNERS * 2 ** np.arange(doublings + 2)).tolist():
        seen_s = corners_s[:count]
        number = np.round((seen_s - clock.first_s) / clock.period_s)
        missed_s = np.abs(seen_s - clock.first_s - clock.period_s * number)
        near = missed_s <= TIMED * row_s
        if near.mean() < AT_TIMES:
            return None
        near &= missed_s <= 3.0 * np.median(missed_s[near])  # others are beside it by chance
        period_s, first_s = np.polyfit(number[near], seen_s[near], 1)
        clock = SensorClock(float(first_s), float(period_s), 0.0)
    return clock


def _first_clock(corners_s: Array, row_s: float) -> SensorClock:
    """The clock with the longest period that a few corners have in common."""
    interval_s, span_s = np.diff(corners_s), float(np.ptp(corners_s))
    longest_s, shortest_s = np.quantile(interval_s, (0.5, 0.05))
    rates_hz = np.arange(0.8 / longest_s, 1.2 / max(shortest_s, 2.0 * row_s), 0.05 / span_s)
    together = np.exp(2j * np.pi * rates_hz[:, np.newaxis] * corners_s).mean(axis=1)
    size = np.abs(together)
    first = int(np.argmax(size >= 0.9 * size.max()))
    peak = slice(first, first + int(np.searchsorted(rates_hz, rates_hz[first] + 1.0 / span_s)))
    best = first + int(np.argmax(size[peak]))
    phase = float(np.angle(together[best])) / (2.0 * np.pi)
    return SensorClock(phase / float(rates_hz[best]), 1.0 / float(rates_hz[best]), 0.0)


def readings_at(taken_s: Array, time_s: Array, values: Array) -> Array | None:
    """What a sensor read at some times, whose lines go through samples; None where they do not.

    Solves min ‖B r − y‖² with the interpolation B_kj = max(0, 1 − |t_k − τ_j| / Δ). A reading that
    no sample tells is not a number.

    Parameters
    ----------
    taken_s
        Times of the readings, regular, shape (r,).
    time_s, values
        The samples, each of shape (n,).

    Examples
    --------
    >>> time_s, taken_s = np.arange(21.0), np.arange(0.0, 23.0, 2.5)
    >>> readings_at(taken_s, time_s, np.interp(time_s, taken_s, taken_s**2))[:3].round(6).tolist()
    [0.0, 6.25, 25.0]
    """
    from scipy.linalg import solveh_banded

    before = np.clip(np.searchsorted(taken_s, time_s, "right") - 1, 0, taken_s.size - 2)
    share = (time_s - taken_s[before]) / np.diff(taken_s)[before]
    weights = np.stack((1.0 - share, share))
    banded = np.zeros((2, taken_s.size))
    right = np.zeros(taken_s.size)
    for side, weight in enumerate(weights):
        np.add.at(banded[1], before + side, weight**2)
        np.add.at(right, before + side, weight * values)
    np.add.at(banded[0], before + 1, weights[0] * weights[1])
    is_told = banded[1] >= TOLD
    banded[1] += np.finfo(float).eps
    found: Array = solveh_banded(banded, right)
    missed = np.abs(weights[0] * found[before] + weights[1] * found[before + 1] - values)
    bend = float(np.median(np.abs(np.diff(found, 2))))
    if float(np.quantile(missed, LEAST_NEAR_READINGS)) > SAMPLED * bend:
        return None
    return np.where(is_told, found, np.nan)


def _corners(time_s: Array, values: Array, straight: BoolArray) -> Array:
    """Times at which two neighbouring lines meet between the samples that lie on them, shape (c,).

    A run of straight samples and its two neighbours lie on one line. Where such a line begins at
    the sample behind another, or at the next, they meet there; of two samples between them each
    lies on a third line, which has no sample of its own that is straight.
    """
    first, last = _lines(straight)
    lines = [(first, last)]
    alone = np.flatnonzero(first[1:] - last[:-1] == 3)
    lines.append((last[alone] + 1, last[alone] + 2))
    starts = np.concatenate([begin for begin, _ in lines])
    stops = np.concatenate([end for _, end in lines])
    order = np.argsort(starts, kind="stable")
    starts, stops = starts[order], stops[order]
    follow = (starts[1:] - stops[:-1] <= 1) & (starts[1:] >= stops[:-1])
    one, other = np.flatnonzero(follow), np.flatnonzero(follow) + 1
    slopes = (values[stops] - values[starts]) / (time_s[stops] - time_s[starts])
    with np.errstate(divide="ignore", invalid="ignore"):
        # from the first line's last sample
        ahead = values[starts[other]] - values[stops[one]]
        ahead -= slopes[other] * (time_s[starts[other]] - time_s[stops[one]])
        met_s = time_s[stops[one]] + ahead / (slopes[one] - slopes[other])
    slack_s = 0.1 * (time_s[starts[other]] - time_s[stops[one]])
    within = (met_s >= time_s[stops[one]] - slack_s) & (met_s <= time_s[starts[other]] + slack_s)
    within &= np.isfinite(met_s)
    found: Array = met_s[within]
    return found


def _lines(straight: BoolArray) -> tuple[IntArray, IntArray]:
    """First and last sample of every line that holds straight samples, its ends among them."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], straight, [False]))))
    return edges[::2] - 1, edges[1::2]
