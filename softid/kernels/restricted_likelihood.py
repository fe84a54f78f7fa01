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


@kernel
def weigh_products(
    reflection: Array, when: Index, first: Index, second: Index, weights: Array, ratios: Array
) -> None:
    """With what weights lagged products make up those of the prediction errors of several models.

    Parameters
    ----------
    reflection
        Reflection coefficients of B models, shape (B, q) with q at most p.
    when, first, second
        Order t and two places i and j in its filter, each of shape (T,).
    weights
        Receives those of the products at these places, shape (B, T).
    ratios
        Receives the error variance of every order over the innovation's, shape (B, p + 1).
    """
    size = ratios.shape[1]
    filters = np.zeros((size, size))
    for b in range(reflection.shape[0]):
        ratio = ratios[b]
        _filters(reflection[b], filters, ratio)
        for row in range(when.size):
            t = when[row]
            weights[b, row] = filters[t, first[row]] * filters[t, second[row]] / ratio[t]


@njit(nogil=True, error_model="numpy")
def _factorise(forms: Array, width: int) -> None:
    """Cholesky's factors in lower triangles, row by row, of many matrices side by side.

    Where one is not definite, its last pivot is not positive.
    """
    row = 0
    for i in range(width):
        other = 0
        for j in range(i + 1):
            entry = forms[row + j]
            for k in range(j):
                mine, theirs = forms[row + k], forms[other + k]
                for b in range(entry.size):
                    entry[b] -= mine[b] * theirs[b]
            pivot = forms[other + j]
            for b in range(entry.size):
                entry[b] = entry[b] / pivot[b] if j < i else np.sqrt(entry[b])
            other += j + 1
        row += i + 1


@kernel
def reduce_forms(
    forms: Array, ratios: Array, counts: Array, determinant: Array, left: Array
) -> None:
    """log|V| + log|QᵀV⁻¹Q| and rᵀP r of several autoregressions for unit innovations.

    P = V⁻¹ − V⁻¹Q(QᵀV⁻¹Q)⁻¹QᵀV⁻¹, with Q what the parameters reach and r the residual. The products
    of both in V⁻¹ are those of their prediction errors.

    Parameters
    ----------
    forms
        Products in V⁻¹ of the m columns of Q and r, the lower triangle row by row, shape
        ((m + 1)(m + 2)/2, B); receives its factor by Cholesky.
    ratios
        From `weigh_products`, shape (B, p + 1).
    counts
        Number of samples that are predicted by every order, shape (p + 1,).
    determinant, left
        Receive the two, each of shape (B,); the second is not positive where the products are not
        definite.
    """
    width = int(np.sqrt(2.0 * forms.shape[0]))  # of a triangle of width·(width + 1)/2 entries
    _factorise(forms, width)
    for b in range(left.size):
        determinant[b], left[b] = 0.0, forms[-1, b] ** 2
        for t in range(counts.size):
            determinant[b] += counts[t] * np.log(ratios[b, t])
        corner = -1
        for i in range(width - 1):
            corner += i + 1
            determinant[b] += 2.0 * np.log(forms[corner, b])
