"""Which samples of a pressure record are on the way up, and which on the way down."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.errors import UsageError

Array = npt.NDArray[np.float64]

REVERSAL_SHARE = 0.05
"""A turn of the pressure counts when it comes back by this share of the range."""

SMALLEST_CHANGE = float(np.nextafter(0.0, 1.0))
"""No two different numbers are closer: a turn of this size is any change."""


def branches(
    pressure_kpa: npt.ArrayLike, *, reversal_kpa: float | None = None
) -> npt.NDArray[np.int8]:
    """Tell rising from falling pressure, blind to noise smaller than ``reversal_kpa``.

    Parameters
    ----------
    pressure_kpa
        Samples in the order recorded, shape (n,); NaN is skipped.
    reversal_kpa
        How far the pressure must come back to count as a turn; 5 % of its range by default. With 0
        every change counts, as in data without noise.

    Returns
    -------
    ndarray
        1 where the pressure is on its way up, −1 on its way down, 0 where it never moved or is
        missing, shape (n,). A plateau belongs to the branch that led to it.

    Raises
    ------
    UsageError
        ``reversal_kpa`` is negative or no number.

    Examples
    --------
    >>> branches([0.0, 1.0, 0.99, 2.0, 1.0, 0.0]).tolist()
    [1, 1, 1, 1, -1, -1]
    """
    if reversal_kpa is not None and not reversal_kpa >= 0.0:
        raise UsageError(
            "the pressure cannot come back by less than nothing",
            where="reversal_kpa",
            value=reversal_kpa,
            remedy="give 0 or more, or leave it out",
        )
    p = np.asarray(pressure_kpa, dtype=np.float64)
    direction = np.zeros(p.size, np.int8)
    there = np.flatnonzero(np.isfinite(p))
    if there.size == 0:
        return direction
    span = float(np.ptp(p[there]))
    reversal = REVERSAL_SHARE * span if reversal_kpa is None else reversal_kpa
    if span == 0.0 or span < reversal:
        return direction
    direction[there] = _directions(p[there], max(reversal, SMALLEST_CHANGE))
    return direction


def turning_samples(values: Array, reversal: float) -> list[tuple[int, int]]:
    """Alternating extremes of a record that comes back by at least ``reversal`` after each.

    Parameters
    ----------
    values
        Samples without NaN, shape (n,).
    reversal
        Swing that an extreme needs before and after it.

    Returns
    -------
    list of (index, direction)
        The sample of each extreme and where the record heads from there, 1 or −1. The first is the
        extreme that the first swing leaves; the last sample is none.

    Examples
    --------
    >>> turning_samples(np.array([0.0, 2.0, 1.9, 3.0, 0.0]), 1.0)
    [(0, 1), (3, -1)]
    """
    turns = []
    low = high = heading = 0
    for k, value in enumerate(values.tolist()):
        if value > values[high]:
            high = k
        if value < values[low]:
            low = k
        if heading <= 0 and value - values[low] >= reversal > 0.0:
            turns.append((low, 1))
            heading, high = 1, k
        elif heading >= 0 and values[high] - value >= reversal > 0.0:
            turns.append((high, -1))
            heading, low = -1, k
    return turns


def _directions(values: Array, reversal: float) -> npt.NDArray[np.int8]:
    turns = turning_samples(values, reversal)
    turned = [_end_of_plateau(values, start) + 1 for start, _ in turns[1:]]
    lengths = np.diff([0, *turned, values.size])
    return np.repeat(np.array([way for _, way in turns], np.int8), lengths)


def _end_of_plateau(values: Array, start: int) -> int:
    """The last of the samples from ``start`` on that are equal."""
    end = start
    while end + 1 < values.size and values[end + 1] == values[start]:
        end += 1
    return end
