"""Solutions of small symmetric systems inside compiled loops.

numba's own linear algebra would load scipy's, which takes longer than a fit.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.affine_work import HELD, MOVING
from softid.kernels.decorators import inner

Array = npt.NDArray[np.float64]


@inner
def solve_in_place(room: Array, n: int) -> bool:
    """Solve by elimination with partial pivoting; False where the matrix is singular.

    Parameters
    ----------
    room
        The matrix in its first n rows and columns, and the right-hand side in the first n entries
        of its last row, which the solution replaces; shape (U + 1, U).
    n
        Number of unknowns, at most U.
    """
    right = room.shape[0] - 1
    for i in range(n):
        best, row = abs(room[i, i]), i
        for r in range(i + 1, n):
            if abs(room[r, i]) > best:
                best, row = abs(room[r, i]), r
        if not best > 0.0:
            return False
        if row != i:
            room[right, i], room[right, row] = room[right, row], room[right, i]
            for c in range(i, n):
                room[i, c], room[row, c] = room[row, c], room[i, c]
        for r in range(i + 1, n):
            factor = room[r, i] / room[i, i]
            room[right, r] -= factor * room[right, i]
            for c in range(i + 1, n):
                room[r, c] -= factor * room[i, c]
    for i in range(n - 1, -1, -1):
        total = room[right, i]
        for c in range(i + 1, n):
            total -= room[i, c] * room[right, c]
        room[right, i] = total / room[i, i]
    return True


@inner
def damped_step(
    matrices: Array, first: int, vectors: Array, pull: int, damping: float, room: Array, step: int
) -> bool:
    """Step of (JᵀJ + λD²) s = g over the unknowns that move; False where that is singular.

    Parameters
    ----------
    matrices, first
        JᵀJ stands from this row on; U columns.
    vectors, pull, step
        Rows of `softid.kernels.affine_work`, with `MOVING`, D's diagonal `HELD`, g, and s to be
        written, zero where nothing moves.
    damping
        λ.
    room
        Overwritten, shape (U + 1, U).
    """
    u = room.shape[1]
    m = int(np.int64(0))  # a literal would have what it is given to compiled once more
    for i in range(u):
        if vectors[MOVING, i] == 0.0:
            continue
        k = 0
        for j in range(u):
            if vectors[MOVING, j] != 0.0:
                room[m, k] = matrices[first + i, j] / vectors[HELD, j] / vectors[HELD, i]
                k += 1
        room[m, m] += damping
        room[u, m] = vectors[pull, i] / vectors[HELD, i]
        m += 1
    if not solve_in_place(room, m):
        return False
    m = 0
    for i in range(u):
        vectors[step, i] = 0.0
        if vectors[MOVING, i] != 0.0:
            vectors[step, i] = room[u, m] / vectors[HELD, i]
            m += 1
    return True
