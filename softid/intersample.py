"""What the input does between its samples: straight from one to the next, or held.

A recorded command, or an input that was written as steps, changes within one sampling interval and
is flat before and after. Taken as straight it comes half an interval early, which looks like a
delay of the actuator. It may be held at its jumps alone, where the rest of it is a measured course,
or at every sample, as a digital controller holds it (zero-order hold).
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

Intersample = Literal["straight", "held", "zoh"]
"""Straight (first-order hold), held where it jumps, or held at every sample (zero-order hold)."""

HELD: tuple[Intersample, ...] = ("held", "zoh")

FLAT = 0.1
"""Before and after a jump the input moves by less than this share of it."""

ABOVE_NOISE = 8.0
"""A jump is so many times as large as the median change between two samples."""

SMALLEST = 0.005
"""And at least this share of the input's range: smaller ones move nothing that could be seen."""

BEFORE = 1e-3
"""A held input jumps this share of the interval before the next sample."""


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
    moves = np.abs(np.diff(values))
    if moves.size < 2:
        return np.empty(0, np.int64)
    before = np.concatenate(([0.0], moves[:-1]))
    after = np.concatenate((moves[1:], [0.0]))
    least = max(SMALLEST * float(np.ptp(values)), ABOVE_NOISE * float(np.median(moves)))
    found = (moves > 0.0) & (moves >= least) & (np.maximum(before, after) <= FLAT * moves)
    return np.flatnonzero(found)


def knots(time_s: Array, values: Array, intersample: Intersample) -> tuple[Array, Array]:
    """Times and values to be put in just before the samples at which a held input changes.

    Parameters
    ----------
    time_s, values
        Sample times and input, each of shape (n,).
    intersample
        ``"zoh"`` for every change, ``"held"`` for the jumps, ``"straight"`` for none.

    Returns
    -------
    Array, Array
        In order of time, each of shape (m,) for m changes.
    """
    if intersample == "straight":
        return np.empty(0), np.empty(0)
    at = np.flatnonzero(np.diff(values)) if intersample == "zoh" else jumps(values)
    stop_s = time_s[at + 1]
    return stop_s - BEFORE * (stop_s - time_s[at]), values[at]
