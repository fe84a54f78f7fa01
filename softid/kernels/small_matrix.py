"""LU factors of matrices too small for a library call to pay."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inlined

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]


@inlined
def factorise(matrix: Array, order: Index) -> None:
    """LU factors with partial pivoting, in place; the diagonal is inverted.

    Parameters
    ----------
    matrix
        The matrix, shape (n, n); overwritten by its factors.
    order
        Receives the row that was exchanged with each row, shape (n,).
    """
    n = matrix.shape[0]
    for i in range(n):
        best, row = abs(matrix[i, i]), i
        for r in range(i + 1, n):
            if abs(matrix[r, i]) > best:
                best, row = abs(matrix[r, i]), r
        order[i] = row
        if row != i:
            for c in range(n):
                matrix[i, c], matrix[row, c] = matrix[row, c], matrix[i, c]
        inverse = 1.0 / matrix[i, i]
        matrix[i, i] = inverse
        for r in range(i + 1, n):
            factor = matrix[r, i] * inverse
            matrix[r, i] = factor
            for c in range(i + 1, n):
                matrix[r, c] -= factor * matrix[i, c]


@inlined
def solve(factors: Array, order: Index, b: Array) -> None:
    """Solve in place with what `factorise` left.

    Parameters
    ----------
    factors, order
        From `factorise`.
    b
        Right-hand side, shape (n,); overwritten by the solution.
    """
    n = b.size
    for i in range(n):
        row = order[i]
        b[i], b[row] = b[row], b[i]
    for i in range(n):
        left = b[i]
        for c in range(i):
            left -= factors[i, c] * b[c]
        b[i] = left
    for back in range(n):
        i = n - 1 - back
        left = b[i]
        for c in range(i + 1, n):
            left -= factors[i, c] * b[c]
        b[i] = left * factors[i, i]


@inlined
def solve_columns(factors: Array, order: Index, b: Array) -> None:
    """Solve for many right-hand sides in place; the loops along a row of ``b`` vectorise.

    Parameters
    ----------
    factors, order
        From `factorise`.
    b
        Right-hand sides as columns, shape (n, C); overwritten by the solutions.
    """
    n, columns = b.shape
    for i in range(n):
        row = order[i]
        if row != i:
            for p in range(columns):
                b[i, p], b[row, p] = b[row, p], b[i, p]
    for i in range(n):
        for c in range(i):
            factor = factors[i, c]
            for p in range(columns):
                b[i, p] -= factor * b[c, p]
    for i in range(n - 1, -1, -1):
        for c in range(i + 1, n):
            factor = factors[i, c]
            for p in range(columns):
                b[i, p] -= factor * b[c, p]
        factor = factors[i, i]
        for p in range(columns):
            b[i, p] *= factor
