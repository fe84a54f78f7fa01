"""Sums over long series, a part of them at a time: no array of their length is made.

A page of fresh memory takes longer than the arithmetic on it, and a part stays in the processor's
cache from one operation to the next.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

PART = 8192
"""Samples of a part: with all that is made of them they take less than the second fastest cache,
and their arithmetic takes several times what numpy needs to begin it."""


def _parts(first: int, stop: int) -> Iterator[slice]:
    for begin in range(first, stop, PART):
        yield slice(begin, min(begin + PART, stop))


def power_about(values: Array, level: float) -> float:
    """Σ (v − ℓ)².

    Parameters
    ----------
    values
        A series, shape (n,).
    level
        ℓ.

    Examples
    --------
    >>> power_about(np.array([1.0, 3.0]), 2.0)
    2.0
    """
    total = 0.0
    for part in _parts(0, values.size):
        apart = values[part] - level
        total += float(apart @ apart)
    return total


def joint_powers(a: Array, b: Array) -> tuple[float, float, float]:
    """Σ ab, Σ a² and Σ b², all less their means.

    Parameters
    ----------
    a, b
        Series, each of shape (n,) with n ≥ 1.

    Examples
    --------
    >>> joint_powers(np.array([0.0, 2.0]), np.array([5.0, 9.0]))
    (4.0, 2.0, 8.0)
    """
    a_mean, b_mean = a.mean(), b.mean()
    cross = a_power = b_power = 0.0
    for part in _parts(0, a.size):
        x, y = a[part] - a_mean, b[part] - b_mean
        cross, a_power, b_power = cross + x @ y, a_power + x @ x, b_power + y @ y
    return float(cross), float(a_power), float(b_power)


def difference_powers(a: Array, b: Array) -> tuple[float, float]:
    """Σ (a − b)², and the same less the mean difference.

    Parameters
    ----------
    a, b
        Series, each of shape (n,) with n ≥ 1.

    Examples
    --------
    >>> difference_powers(np.array([3.0, 5.0]), np.array([2.0, 2.0]))
    (10.0, 2.0)
    """
    mean = float(a.mean() - b.mean())
    whole = apart = 0.0
    for part in _parts(0, a.size):
        left = a[part] - b[part]
        whole += float(left @ left)
        left -= mean
        apart += float(left @ left)
    return whole, apart


def innovation_power(values: Array, phi: Array) -> float:
    """Σ (y_t − Σ φ_j y_{t−j})² over all samples that have as many before them.

    Parameters
    ----------
    values
        A series, shape (n,).
    phi
        Coefficients of an autoregression, that of the sample before first, shape (p,).

    Examples
    --------
    >>> innovation_power(np.array([4.0, 3.0]), np.array([0.5]))
    1.0
    """
    total = 0.0
    for part in _parts(phi.size, values.size):
        left = values[part]
        for j, coefficient in enumerate(phi, 1):
            left = left - coefficient * values[part.start - j : part.stop - j]
        total += float(left @ left)
    return total
