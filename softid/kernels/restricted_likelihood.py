"""The restricted likelihood of autoregressions, from lagged products of what they may explain."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]


@njit(nogil=True, error_model="numpy")
def _filters(reflection: Array, filters: Array, ratio: Array) -> None:
    """Prediction-error filters 1, −φ^{(t)} of orders 0 … p, and their error variances.

    By Levinson's recursion; the variances are over the innovation's, and orders above that of the
    model repeat it.
    """
    order, size = reflection.size, ratio.size
    ratio[order:] = 1.0
    for t in range(order, 0, -1):
        k = reflection[t - 1]
        ratio[t - 1] = ratio[t] / ((1.0 - k) * (1.0 + k))
    filters[0, 0] = 1.0
    for t in range(1, size):
        k = reflection[t - 1] if t <= order else 0.0
        for i in range(t + 1):
            filters[t, i] = filters[t - 1, i] - k * filters[t - 1, t - i]


@njit(nogil=True, error_model="numpy")
def _factorise(form: Array) -> bool:
    """Cholesky's factor in the lower triangle; False where the matrix is not definite."""
    for i in range(form.shape[0]):
        for j in range(i + 1):
            left = form[i, j]
            for k in range(j):
                left -= form[i, k] * form[j, k]
            if j < i:
                form[i, j] = left / form[j, j]
            elif 0.0 < left < np.inf:
                form[i, i] = np.sqrt(left)
            else:
                return False
    return True


@kernel
def reduce_forms(
    reflection: Array,
    when: Index,
    first: Index,
    second: Index,
    packed: Array,
    counts: Array,
    determinant: Array,
    left: Array,
) -> None:
    """log|V| + log|QᵀV⁻¹Q| and rᵀP r of several autoregressions for unit innovations.

    P = V⁻¹ − V⁻¹Q(QᵀV⁻¹Q)⁻¹QᵀV⁻¹, with Q what the parameters reach and r the residual. The products
    of both in V⁻¹ are those of their prediction errors.

    Parameters
    ----------
    reflection
        Reflection coefficients of B models, shape (B, q) with q at most p.
    when, first, second
        Order t and two places i and j in its filter, each of shape (T,).
    packed
        Products of the m columns of Q and r at these places, summed over the samples that are
        predicted by order t, shape (T, (m + 1)²).
    counts
        Number of those samples, shape (p + 1,).
    determinant, left
        Receive the two, each of shape (B,); the second is negative where the products are not
        definite.
    """
    size, width = counts.size, int(np.sqrt(packed.shape[1]) + 0.5)
    filters, ratio, form = np.zeros((size, size)), np.empty(size), np.empty(width * width)
    for b in range(reflection.shape[0]):
        _filters(reflection[b], filters, ratio)
        form[:] = 0.0
        for row in range(when.size):
            t = when[row]
            weight = filters[t, first[row]] * filters[t, second[row]] / ratio[t]
            for entry in range(form.size):
                form[entry] += weight * packed[row, entry]
        square = form.reshape((width, width))
        determinant[b], left[b] = 0.0, -1.0
        if not _factorise(square):
            continue
        for t in range(size):
            determinant[b] += counts[t] * np.log(ratio[t])
        for i in range(width - 1):
            determinant[b] += 2.0 * np.log(square[i, i])
        left[b] = square[width - 1, width - 1] ** 2
