"""The motion between its samples, for filters of the reading that are exact for straight pieces."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.filters import hermite

Array = npt.NDArray[np.float64]

PIECES = 4
"""Pieces of a sampling interval in which the motion counts as straight."""

LEAST_SAMPLES = 3
"""Fewest samples whose motion is refined: as many as a slope of second order takes."""


def finer_motion(time_s: Array, y: Array) -> tuple[Array, Array]:
    """Lengths of `PIECES` equal pieces of every interval, and the motion by Hermite cubics.

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
        Lengths of the pieces, shape ((n − 1) `PIECES`,), and the motion at their ends, which has
        one value more.
    """
    step_s = np.diff(time_s)
    count = step_s.size * PIECES
    if time_s.size < LEAST_SAMPLES:
        share = np.linspace(0.0, step_s.size, count + 1)
        return np.repeat(step_s / PIECES, PIECES), np.interp(share, np.arange(y.size), y)
    finer_s, finer = np.empty(count), np.empty(count + 1)
    hermite(step_s, np.ascontiguousarray(y, np.float64), finer_s, finer)
    return finer_s, finer
