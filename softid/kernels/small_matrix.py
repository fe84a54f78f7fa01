"""Inverses of matrices too small for a library call to pay.

Rows are padded with zeros to whole vectors of `LANES` numbers: a loop over a constant number of
lanes becomes one instruction, a loop over six numbers does not.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inlined

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]

LANES = 8


def groups(count: int) -> int:
    """How many groups of `LANES` hold so many numbers."""
    return -(-count // LANES)


@inlined
def _exchange(matrix: Array, order: Index, i: int) -> None:
    """Bring the largest number left in a column onto the diagonal."""
    best, row = abs(matrix[i, i]), i
    for r in range(i + 1, matrix.shape[0]):
        if abs(matrix[r, i]) > best:
            best, row = abs(matrix[r, i]), r
    order[i] = row
    if row != i:
        for c in range(matrix.shape[1]):
            matrix[i, c], matrix[row, c] = matrix[row, c], matrix[i, c]


@inlined
def invert(matrix: Array, order: Index) -> None:
    """Inverse by Gauss and Jordan with partial pivoting, in place.

    Parameters
    ----------
    matrix
        The matrix in its first n columns and zeros behind them, shape (n, a multiple of `LANES`);
        overwritten by its inverse.
    order
        Receives the row that was exchanged with each row, shape (n,).
    """
    n, width = matrix.shape
    for i in range(n):
        _exchange(matrix, order, i)
        inverse = 1.0 / matrix[i, i]
        matrix[i, i] = 1.0
        for c in range(width):
            matrix[i, c] *= inverse
        for r in range(n):
            if r != i:
                factor = matrix[r, i]
                matrix[r, i] = 0.0
                for c in range(width):
                    matrix[r, c] -= factor * matrix[i, c]
    for i in range(n - 1, -1, -1):
        row = order[i]
        if row != i:
            for r in range(n):
                matrix[r, i], matrix[r, row] = matrix[r, row], matrix[r, i]


@inlined
def multiply(inverse: Array, b: Array, found: Array) -> None:
    """Solution for one right-hand side.

    Parameters
    ----------
    inverse
        From `invert`.
    b
        Right-hand side, shape (n,).
    found
        Receives the solution, shape (n,).
    """
    for i in range(b.size):
        total = 0.0
        for c in range(b.size):
            total += inverse[i, c] * b[c]
        found[i] = total


@inlined
def multiply_columns(inverse: Array, b: Array, found: Array) -> None:
    """Solutions for many right-hand sides.

    Parameters
    ----------
    inverse
        From `invert`.
    b
        Right-hand sides as columns in groups of `LANES`, shape (n, groups, LANES).
    found
        Receives the solutions as columns, of the same shape.
    """
    n = b.shape[0]
    for f in range(b.shape[1]):
        for i in range(n):
            t0, t1, t2, t3, t4, t5, t6, t7 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for c in range(n):
                factor = inverse[i, c]
                t0 += factor * b[c, f, 0]
                t1 += factor * b[c, f, 1]
                t2 += factor * b[c, f, 2]
                t3 += factor * b[c, f, 3]
                t4 += factor * b[c, f, 4]
                t5 += factor * b[c, f, 5]
                t6 += factor * b[c, f, 6]
                t7 += factor * b[c, f, 7]
            found[i, f, 0], found[i, f, 1], found[i, f, 2], found[i, f, 3] = t0, t1, t2, t3
            found[i, f, 4], found[i, f, 5], found[i, f, 6], found[i, f, 7] = t4, t5, t6, t7
