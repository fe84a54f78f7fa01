"""Forward and backward prediction errors of a series, order by order."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.decorators import SUMMING, kernel

Array = npt.NDArray[np.float64]


@njit(nogil=True, error_model="numpy", fastmath=SUMMING, forceinline=True)
def _products(f: Array, b: Array) -> tuple[float, float]:
    cross, power = 0.0, 0.0
    for t in range(f.size):
        cross += f[t] * b[t]
        power += f[t] * f[t] + b[t] * b[t]
    return cross, power


@kernel
def raise_order(forward: Array, backward: Array, k: float) -> tuple[float, float]:
    """Errors of the next order, f_t − k b_{t−1} and b_{t−1} − k f_t, and products of their pairs.

    Parameters
    ----------
    forward, backward
        f_t and b_{t−1} of all pairs, each of shape (n,), which receive the new ones; of those the
        first forward and the last backward one are in no pair any more.
    k
        Reflection coefficient of the order; 0 for the samples themselves.

    Returns
    -------
    cross, power
        Σ f_t b_{t−1} and Σ (f_t² + b_{t−1}²) over the new pairs.
    """
    for t in range(forward.size):
        f, b = forward[t], backward[t]
        forward[t], backward[t] = f - k * b, b - k * f
    return _products(forward[1:], backward[: backward.size - 1])
