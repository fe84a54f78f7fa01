"""Products of a series with itself some samples later, summed."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.decorators import SUMMING, kernel

Array = npt.NDArray[np.float64]

CHUNK = 2048
"""Samples that all lags are taken of before the next ones: they stay in the fastest cache."""


@njit(nogil=True, error_model="numpy", fastmath=SUMMING, forceinline=True)
def _sum(a: Array, b: Array, level: float) -> float:
    total = 0.0
    for t in range(a.size):
        total += (a[t] - level) * (b[t] - level)
    return total


@kernel
def add_lagged_products(a: Array, b: Array, level: float, sums: Array) -> None:
    """Add Σ_t (a_t − ℓ)(b_{t+k} − ℓ) at every lag k.

    Parameters
    ----------
    a, b
        Series, each of shape (n,).
    level
        What is taken from both, ℓ.
    sums
        Sums at lags from 0 on, shape (K,).
    """
    for first in range(0, a.size, CHUNK):
        for lag in range(sums.size):
            stop = min(first + CHUNK, a.size - lag)
            if stop > first:
                sums[lag] += _sum(a[first:stop], b[first + lag : stop + lag], level)
