"""Autocovariances of several autoregressions, side by side."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]


@njit(nogil=True, error_model="numpy")
def _begin(reflection: Array, phi: Array, gamma: Array) -> None:
    """Coefficients and autocovariances up to the order of one model, by Levinson's recursion."""
    left = 1.0
    for k in reflection:
        left /= 1.0 - k * k
    gamma[0] = left
    for m in range(1, reflection.size + 1):
        k = reflection[m - 1]
        gamma[m] = k * left
        for j in range(m - 1):
            gamma[m] += phi[j] * gamma[m - 1 - j]
        for j in range(m // 2):
            ahead, behind = phi[j], phi[m - 2 - j]
            phi[j], phi[m - 2 - j] = ahead - k * behind, behind - k * ahead
        phi[m - 1] = k
        left *= 1.0 - k * k


@njit(nogil=True, error_model="numpy")
def _are_faded(values: Array, least: Array) -> bool:
    are_faded = True
    for b in range(values.size):
        are_faded = are_faded and abs(values[b]) < least[b]
    return are_faded


@kernel
def fill_autocovariances(reflection: Array, faded: float, gamma: Array) -> None:
    """γ_m = Σ_{j<m} φ^{(m−1)}_j γ_{m−j} + k_m·left up to the order, then γ_k = Σ φ_j γ_{k−j}.

    Parameters
    ----------
    reflection
        Reflection coefficients of B models, shape (B, p).
    faded
        Share of the variance below which they count as zero, and are not continued.
    gamma
        Zeros; receives the autocovariances for unit innovations, shape (n, B) with n above p.
    """
    count, order = reflection.shape
    phi = np.zeros((order, count))
    for b in range(count):
        _begin(reflection[b], phi[:, b], gamma[:, b])
    least = faded * gamma[0]
    k, run = order + 1, 0
    while k < gamma.shape[0] and run < order:
        for j in range(order):
            for b in range(count):
                gamma[k, b] += phi[j, b] * gamma[k - 1 - j, b]
        run = run + 1 if _are_faded(gamma[k], least) else 0
        k += 1
    for i in range(k):
        for b in range(count):
            if abs(gamma[i, b]) < least[b]:
                gamma[i, b] = 0.0
