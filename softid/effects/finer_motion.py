"""The motion between its samples, for filters of the reading that are exact for straight pieces."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

PIECES = 4
"""Pieces of a sampling interval in which the motion counts as straight."""

LEAST_SAMPLES = 3
"""As many as a slope of second order takes."""


def finer_motion(time_s: Array, y: Array) -> tuple[Array, Array]:
    """Times and motion at the ends of `PIECES` equal pieces of every interval, by Hermite cubics.

    A motion that swings within ten samples bends so much between them that a straight line would
    miss by a hundredth of it, which is seen. Every `PIECES`-th of the values is a sample.

    Parameters
    ----------
    time_s
        Strictly increasing times of the samples, shape (n,).
    y
        Motion at these times, shape (n,).

    Returns
    -------
    tuple of Array
        Times and motion, each of shape ((n − 1) `PIECES` + 1,).
    """
    if time_s.size < LEAST_SAMPLES:
        share = np.linspace(0.0, 1.0, (time_s.size - 1) * PIECES + 1) * (time_s.size - 1)
        places = np.arange(float(time_s.size))
        return np.interp(share, places, time_s), np.interp(share, places, y)
    steps, slopes = np.diff(time_s), np.gradient(y, time_s, edge_order=2)
    s = np.arange(PIECES) / PIECES
    begin, rise = y[:-1, None], np.diff(y)[:, None]
    first, second = (steps * slopes[:-1])[:, None], (steps * slopes[1:])[:, None]
    curve = (first + second - 2.0 * rise) * s + (3.0 * rise - 2.0 * first - second)
    values = begin + first * s + curve * s**2
    between_s = time_s[:-1, None] + steps[:, None] * s
    return np.append(between_s, time_s[-1]), np.append(values, y[-1])
