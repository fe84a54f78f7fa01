"""Where a course jumps between two samples."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@kernel
def find_jumps(values: Array, least: float, flat: float, found: IntArray) -> int:
    """Intervals that hold a large change with hardly any before and after it.

    Parameters
    ----------
    values
        The course, shape (n,).
    least
        Smallest change that counts.
    flat
        Largest change before and after, as a share of it.
    found
        Receives the intervals in order, shape (n // 2,) or more: no two of them are neighbours.

    Returns
    -------
    int
        How many they are.
    """
    count, last, before = 0, values.size - 2, 0.0
    for k in range(last + 1):
        change = abs(values[k + 1] - values[k])
        if change >= least and before <= flat * change:
            after = abs(values[k + 2] - values[k + 1]) if k < last else 0.0
            if after <= flat * change:
                found[count] = k
                count += 1
        before = change
    return count


@kernel
def count_changes(values: Array, least: float) -> int:
    """Intervals in which a course, shape (n,), changes so much."""
    count = 0
    for k in range(values.size - 1):
        count += abs(values[k + 1] - values[k]) >= least
    return count
