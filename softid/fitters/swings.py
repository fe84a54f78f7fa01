"""Swings of a step response about its final level: how many, and how long each takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

FINAL_SHARE = 0.25
"""Last part of the record whose median is the final level."""

FEWEST_SAMPLES = 3
"""Samples of a record at least; the parabola through an extreme takes one more than so many, as it
has three coefficients."""


@dataclass(frozen=True)
class Swings:
    """What an eye reads off an oscillating step response.

    Attributes
    ----------
    count
        Number of extremes beyond and short of the final level that stand out.
    period_s
        Twice the mean time between successive extremes, or None with fewer than two.
    """

    count: int
    period_s: float | None


def count_swings(time_s: Array, angle: Array, pressure: Array, *, least: float) -> Swings:
    """Count the extremes of a step response.

    The response is cut where it crosses its final level; the largest deviation of every piece is an
    extreme. Pieces that deviate by less than ``least`` of the step are noise and end the count.

    Parameters
    ----------
    time_s
        Times of the record of one step (s), shape (n,).
    angle
        Its angle (rad), shape (n,); NaN where it is missing.
    pressure
        Its pressure (kPa), shape (n,).
    least
        Smallest deviation that counts, as a share of the step.

    Examples
    --------
    >>> t = np.linspace(0.0, 10.0, 2001)
    >>> y = 1.0 - np.exp(-0.5 * t) * np.cos(2 * np.pi * t)
    >>> found = count_swings(t, y, np.ones_like(t), least=0.05)
    >>> found.count, round(found.period_s, 2)
    (11, 1.0)
    """
    there = np.isfinite(angle)
    time, y = time_s[there], angle[there]
    if y.size < FEWEST_SAMPLES:
        return Swings(0, None)
    moved = np.flatnonzero(np.abs(pressure[there] - pressure[there][0]) > 0.5 * np.ptp(pressure))
    begin = int(moved[0]) if moved.size else 0
    final = float(np.median(y[-max(1, int(FINAL_SHARE * (y.size - begin))) :]))
    step = abs(final - float(np.median(y[: max(begin, 1)])))
    if step == 0.0:
        return Swings(0, None)
    away = (y[begin:] - final) / step
    sides = _sides(away, least)
    times = []
    for first, stop in sides[1:]:  # the first is the way to the final level
        peak = first + int(np.argmax(np.abs(away[first:stop])))
        times.append(float(_vertex(time[begin:], away, peak)))
    if len(times) < 2:
        return Swings(len(times), None)
    return Swings(len(times), 2.0 * (times[-1] - times[0]) / (len(times) - 1))


def _sides(away: Array, least: float) -> list[tuple[int, int]]:
    """Stretches on one side of the final level that reach the threshold, in turns."""
    found: list[tuple[int, int]] = []
    side = 0.0
    for k in np.flatnonzero(np.abs(away) > least).tolist():
        sign = float(np.sign(away[k]))
        if sign == side:
            found[-1] = (found[-1][0], k + 1)
        else:
            found.append((k, k + 1))
            side = sign
    return found


def _vertex(time: Array, away: Array, peak: int) -> float:
    """Time of an extreme from a parabola through its neighbourhood."""
    height = abs(away[peak])
    low, high = peak, peak + 1
    while low > 0 and away[low - 1] * np.sign(away[peak]) > 0.7 * height:
        low -= 1
    while high < away.size and away[high] * np.sign(away[peak]) > 0.7 * height:
        high += 1
    if high - low < FEWEST_SAMPLES + 1:
        return float(time[peak])
    centred = time[low:high] - time[peak]
    bent, slope, _ = np.polyfit(centred, away[low:high], 2)
    shift = -slope / (2.0 * bent) if bent != 0.0 else 0.0
    return float(time[peak] + np.clip(shift, centred[0], centred[-1]))
