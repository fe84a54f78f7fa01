"""Normal equations from products of columns and the weights with which they make up a Jacobian."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.intp]


@kernel
def add_equations(
    gram: Array,
    weights: Array,
    residual: Array,
    at: Index,
    weight: float,
    gradient: Array,
    matrix: Array,
) -> tuple[float, bool]:
    """Add w·JᵀJ and w·Jᵀr with J = Cᵀ T and r = Cᵀ t, of which the products G = C Cᵀ are known.

    Parameters
    ----------
    gram
        G, shape (C, C).
    weights
        T, shape (C, P).
    residual
        t, shape (C,).
    at
        Where the P unknowns stand among all, shape (P,).
    weight
        w.
    gradient, matrix
        Receive what is added, shapes (U,) and (U, U).

    Returns
    -------
    squares, is_finite
        rᵀr, and whether that and all that was added is finite.
    """
    size, count = weights.shape
    pushed, columns = np.zeros(size), np.zeros((size, count))
    squares = 0.0
    for i in range(size):
        for j in range(size):
            g = gram[i, j]
            pushed[i] += g * residual[j]
            for p in range(count):
                columns[i, p] += g * weights[j, p]
        squares += residual[i] * pushed[i]
    total = squares
    for p in range(count):
        slope = 0.0
        for i in range(size):
            slope += weights[i, p] * pushed[i]
        gradient[at[p]] += weight * slope
        total += slope
        for q in range(p + 1):
            product = 0.0
            for i in range(size):
                product += weights[i, p] * columns[i, q]
            total += product
            matrix[at[p], at[q]] += weight * product
            if q < p:
                matrix[at[q], at[p]] += weight * product
    return squares, np.isfinite(total)
