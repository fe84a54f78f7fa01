"""Sums over a long series that need no other array."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.decorators import SUMMING, kernel

Array = npt.NDArray[np.float64]

CHUNK = 1024
"""Samples that are worked on at a time: they stay in the fastest cache."""


@njit(nogil=True, error_model="numpy", fastmath=SUMMING, forceinline=True)
def _sum(values: Array) -> float:
    total = 0.0
    for t in range(values.size):
        total += values[t]
    return total


@njit(nogil=True, error_model="numpy", fastmath=SUMMING, forceinline=True)
def _squares(values: Array, level: float) -> float:
    total = 0.0
    for t in range(values.size):
        total += (values[t] - level) * (values[t] - level)
    return total


@kernel
def mean_and_power(values: Array) -> tuple[float, float]:
    """Mean m and Σ (v − m)².

    Parameters
    ----------
    values
        A series, shape (n,) with n ≥ 1.
    """
    mean = _sum(values) / values.size
    return mean, _squares(values, mean)


@njit(nogil=True, error_model="numpy", fastmath=SUMMING, forceinline=True)
def _product(a: Array, b: Array, a_level: float, b_level: float) -> float:
    total = 0.0
    for t in range(a.size):
        total += (a[t] - a_level) * (b[t] - b_level)
    return total


@kernel
def joint_powers(a: Array, b: Array) -> tuple[float, float, float]:
    """Σ ab, Σ a² and Σ b², all less their means.

    Parameters
    ----------
    a, b
        Series, each of shape (n,) with n ≥ 1.
    """
    a_mean, b_mean = _sum(a) / a.size, _sum(b) / b.size
    return _product(a, b, a_mean, b_mean), _squares(a, a_mean), _squares(b, b_mean)


@kernel
def difference_powers(a: Array, b: Array) -> tuple[float, float]:
    """Σ (a − b)², and the same less the mean difference.

    Parameters
    ----------
    a, b
        Series, each of shape (n,) with n ≥ 1.
    """
    mean = (_sum(a) - _sum(b)) / a.size
    whole, apart = 0.0, 0.0
    left = np.empty(CHUNK)
    for first in range(0, a.size, CHUNK):
        count = min(CHUNK, a.size - first)
        for t in range(count):
            left[t] = a[first + t] - b[first + t]
        whole += _squares(left[:count], 0.0)
        apart += _squares(left[:count], mean)
    return whole, apart


@kernel
def innovation_power(values: Array, phi: Array) -> float:
    """Σ (y_t − Σ φ_j y_{t−j})² over all samples that have as many before them.

    Parameters
    ----------
    values
        A series, shape (n,).
    phi
        Coefficients of an autoregression, that of the sample before first, shape (p,).
    """
    total = 0.0
    left = np.empty(CHUNK)
    for first in range(phi.size, values.size, CHUNK):
        count = min(CHUNK, values.size - first)
        for t in range(count):
            left[t] = values[first + t]
        for j in range(phi.size):
            for t in range(count):
                left[t] -= phi[j] * values[first + t - j - 1]
        total += _squares(left[:count], 0.0)
    return total
