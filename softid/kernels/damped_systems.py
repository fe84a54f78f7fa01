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


@kernel
def find_movable(z: Array, gradient: Array, lower: Array, upper: Array, moving: BoolArray) -> None:
    """Which unknowns are inside their bounds or pulled inward.

    Parameters
    ----------
    z, gradient
        Unknowns and the direction of descent there, each of shape (U,).
    lower, upper
        Bounds, each of shape (U,).
    moving
        Receives the answer, shape (U,).
    """
    for k in range(z.size):
        stuck = (z[k] <= lower[k] and gradient[k] < 0.0) or (z[k] >= upper[k] and gradient[k] > 0.0)
        moving[k] = not stuck and upper[k] > lower[k]


@kernel
def bounded_step(
    z: Array,
    step: Array,
    reach: Array,
    longest: float,
    lower: Array,
    upper: Array,
    matrix: Array,
    gradient: Array,
    trial: Array,
) -> tuple[float, float]:
    """Shorten a step and keep it within bounds, z⁺ = min(max(z + s·step, l), u).

    Parameters
    ----------
    z, step
        Unknowns and a step from them, which is multiplied by s, each of shape (U,).
    reach, longest
        How far each unknown may plausibly move, shape (U,), and most of it that a step may go.
    lower, upper
        Bounds, each of shape (U,).
    matrix, gradient
        JᵀJ and Jᵀr there, of shapes (U, U) and (U,).
    trial
        Receives z⁺, shape (U,).

    Returns
    -------
    length, predicted
        The longest part of the step in units of its reach before it was shortened, and by how much
        the cost should fall, dᵀJᵀr − ½ dᵀJᵀJ d with d = z⁺ − z.
    """
    length = 0.0
    for k in range(z.size):
        length = max(length, abs(step[k]) / reach[k])
    share = min(1.0, longest / length) if length > 0.0 else 1.0
    for k in range(z.size):
        step[k] *= share
        trial[k] = z[k] + step[k]
        if trial[k] < lower[k]:  # what is not a number stays so, and is no step
            trial[k] = lower[k]
        elif trial[k] > upper[k]:
            trial[k] = upper[k]
    predicted = 0.0
    for i in range(z.size):
        pushed = 0.0
        for j in range(z.size):
            pushed += matrix[i, j] * (trial[j] - z[j])
        predicted += (trial[i] - z[i]) * (gradient[i] - 0.5 * pushed)
    return length, predicted


@kernel
def is_still(z: Array, trial: Array, least: float) -> bool:
    """Whether no unknown moves by this share of itself, each of shape (U,)."""
    still = True
    for k in range(z.size):
        still = still and abs(trial[k] - z[k]) <= least * (abs(z[k]) + least)
    return still
