"""Solutions of small symmetric systems inside compiled loops.

numba's own linear algebra would load scipy's, which takes longer than a fit.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inner

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


@inner
def solve_in_place(matrix: Array, vector: Array, n: int) -> bool:
    """Solve by elimination with partial pivoting; False where the matrix is singular.

    Parameters
    ----------
    matrix
        Its first n rows and columns are overwritten.
    vector
        Right-hand side in its first n entries; overwritten by the solution.
    n
        Number of unknowns.
    """
    for i in range(n):
        best, row = abs(matrix[i, i]), i
        for r in range(i + 1, n):
            if abs(matrix[r, i]) > best:
                best, row = abs(matrix[r, i]), r
        if not best > 0.0:
            return False
        if row != i:
            vector[i], vector[row] = vector[row], vector[i]
            for c in range(i, n):
                matrix[i, c], matrix[row, c] = matrix[row, c], matrix[i, c]
        for r in range(i + 1, n):
            factor = matrix[r, i] / matrix[i, i]
            vector[r] -= factor * vector[i]
            for c in range(i + 1, n):
                matrix[r, c] -= factor * matrix[i, c]
    for i in range(n - 1, -1, -1):
        total = vector[i]
        for c in range(i + 1, n):
            total -= matrix[i, c] * vector[c]
        vector[i] = total / matrix[i, i]
    return True


@inner
def damped_step(
    matrix: Array,
    gradient: Array,
    moving: BoolArray,
    scale: Array,
    damping: float,
    room: Array,
    step: Array,
) -> bool:
    """Step of (JᵀJ + λD²) s = g over the unknowns that move; False where that is singular.

    Parameters
    ----------
    matrix, gradient
        JᵀJ and g, shapes (U, U) and (U,).
    moving
        Which unknowns move, shape (U,).
    scale, damping
        Diagonal of D, shape (U,), and λ.
    room
        Overwritten, shape (U + 1, U).
    step
        Receives s, zero where nothing moves, shape (U,).
    """
    u = gradient.size
    m = 0
    right = room[u]
    for i in range(u):
        if not moving[i]:
            continue
        k = 0
        for j in range(u):
            if moving[j]:
                room[m, k] = matrix[i, j] / scale[j] / scale[i]
                k += 1
        room[m, m] += damping
        right[m] = gradient[i] / scale[i]
        m += 1
    if not solve_in_place(room, right, m):
        return False
    m = 0
    for i in range(u):
        step[i] = 0.0
        if moving[i]:
            step[i] = right[m] / scale[i]
            m += 1
    return True
