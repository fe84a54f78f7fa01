"""How far an input moves from sample to sample, looked at without an array of the moves."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import bare_kernel

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@bare_kernel
def moves_of_at_least(values: Array, least: float, at: IntArray) -> int:
    """Number of intervals over which a series moves so far.

    Parameters
    ----------
    values
        The series, shape (n,).
    least
        Smallest move that counts.
    at
        Receives the samples before those intervals, in order; of shape (0,) to count alone.
    """
    count = 0
    if at.size == 0:
        for k in range(values.size - 1):  # no branch, so that several are looked at at a time
            count += 1 if abs(values[k + 1] - values[k]) >= least else 0
        return count
    for k in range(values.size - 1):
        if abs(values[k + 1] - values[k]) >= least:
            at[count] = k
            count += 1
    return count
