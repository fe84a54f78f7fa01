"""Burg's recursion and the autocovariance of an autoregression."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]

_SUMMING = {"contract", "arcp", "nsz", "reassoc"}
_LOOK = 64
"""Lags between two looks whether the rest is rounding."""


@njit(nogil=True, error_model="numpy", fastmath=_SUMMING)
def _products(forward: Array, backward: Array) -> tuple[float, float]:
    cross, power = 0.0, 0.0
    for i in range(forward.size):
        cross += forward[i] * backward[i]
        power += forward[i] * forward[i] + backward[i] * backward[i]
    return cross, power


@njit(nogil=True, error_model="numpy", fastmath={"contract"})
def _reflect(forward: Array, backward: Array, k: float) -> None:
    for i in range(forward.size):
        f, b = forward[i], backward[i]
        forward[i], backward[i] = f - k * b, b - k * f


@kernel
def reflections(values: Array, edges: Index, max_order: int, least: float) -> Array:
    """Reflection coefficients of several stretches by Burg's recursion.

    Parameters
    ----------
    values
        The stretches one after the other, shape (N,).
    edges
        Where each begins, and N, shape (S + 1,).
    max_order
        How many coefficients.
    least
        Share of the power below which no prediction is believed; zeros follow.

    Returns
    -------
    Array
        Shape (max_order,).
    """
    found = np.zeros(max_order)
    ahead, behind = values.copy(), values.copy()
    left = 1.0
    for m in range(max_order):
        cross, power = 0.0, 0.0
        for s in range(edges.size - 1):
            count = edges[s + 1] - edges[s] - m - 1
            if count > 0:
                a = edges[s]
                more = _products(ahead[a + m + 1 : a + m + 1 + count], behind[a : a + count])
                cross += more[0]
                power += more[1]
        if power <= 0.0 or left <= 2.0 * least:
            break
        most = np.sqrt(1.0 - least / left)
        k = min(max(2.0 * cross / power, -most), most)
        found[m] = k
        left *= 1.0 - k * k
        for s in range(edges.size - 1):
            count = edges[s + 1] - edges[s] - m - 1
            if count > 0:
                a = edges[s]
                _reflect(ahead[a + m + 1 : a + m + 1 + count], behind[a : a + count], k)
    return found


@njit(nogil=True, error_model="numpy")
def _step_down(phi: Array, table: Array) -> None:
    """Coefficients of the predictors of all orders up to p, row m holding m of them."""
    p = phi.size
    for j in range(p):
        table[p, j] = phi[j]
    for m in range(p, 1, -1):
        k = table[m, m - 1]
        for j in range(m - 1):
            table[m - 1, j] = (table[m, j] + k * table[m, m - 2 - j]) / (1.0 - k * k)


@kernel
def autocovariances(phi: Array, n: int, faded: float) -> Array:
    """Autocovariance for unit innovations, exactly; zero once all is ``faded`` of the first.

    Parameters
    ----------
    phi
        Coefficients of a stable model, shape (p,).
    n
        Number of lags, from 0 on.
    faded
        Share of the first below which what follows is rounding.
    """
    p = phi.size
    table = np.zeros((p + 1, p + 1))
    _step_down(phi, table)
    gamma = np.zeros(n)
    first = 1.0
    for m in range(1, p + 1):
        first /= 1.0 - table[m, m - 1] * table[m, m - 1]
    left = first
    gamma[0] = first
    for m in range(1, min(p, n - 1) + 1):
        k = table[m, m - 1]
        total = k * left
        for j in range(m - 1):
            total += table[m - 1, j] * gamma[m - 1 - j]
        gamma[m] = total
        left *= 1.0 - k * k
    for lag in range(p + 1, n if p else 0):
        total, most = 0.0, 0.0
        for j in range(p):
            total += phi[j] * gamma[lag - 1 - j]
            most = max(most, abs(gamma[lag - 1 - j]))
        if lag % _LOOK == 0 and most < faded * first:
            break
        gamma[lag] = total
    return gamma
