"""The small linear system of every step of a fit: normal equations with a ridge."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.decorators import SUMMING, kernel

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


@njit(nogil=True, error_model="numpy", fastmath=SUMMING, forceinline=True)
def _along(rows: Array, i: int, j: int, count: int) -> float:
    """Σ rows[i]·rows[j] over their first entries."""
    total = 0.0
    for k in range(count):
        total += rows[i, k] * rows[j, k]
    return total


@kernel
def solve_damped(
    matrix: Array, ridge: Array, vector: Array, moving: BoolArray, solution: Array
) -> bool:
    """Solution of (A + diag(ridge))·x = b over some of the unknowns, by Cholesky's factors.

    Parameters
    ----------
    matrix
        A, symmetric and semidefinite, shape (U, U).
    ridge, vector
        What is added to its diagonal, and b, each of shape (U,).
    moving
        Which unknowns are solved for, shape (U,).
    solution
        Receives x, zero for the others, shape (U,).

    Returns
    -------
    bool
        False where rounding leaves no positive definite matrix; there is no solution then.
    """
    size = vector.size
    lower = np.zeros((size, size))
    for i in range(size):
        if not moving[i]:
            lower[i, i], solution[i] = 1.0, 0.0
            continue
        for j in range(i):
            if moving[j]:
                lower[i, j] = (matrix[i, j] - _along(lower, i, j, j)) / lower[j, j]
        pivot = matrix[i, i] + ridge[i] - _along(lower, i, i, i)
        if not 0.0 < pivot < np.inf:
            return False
        lower[i, i] = np.sqrt(pivot)
        left = vector[i]
        for k in range(i):
            left -= lower[i, k] * solution[k]
        solution[i] = left / lower[i, i]
    for i in range(size - 1, -1, -1):
        solution[i] /= lower[i, i]
        for k in range(i):
            solution[k] -= lower[i, k] * solution[i]
    return True
