"""Inverses of small matrices, written out for the compiler."""

from __future__ import annotations

import numpy as np
import pytest

from softid.kernels.small_matrix import LANES, groups, invert, multiply, multiply_columns


def inverse_of(matrix: np.ndarray) -> np.ndarray:
    n = matrix.shape[0]
    work = np.zeros((n, LANES * groups(n)))
    work[:, :n] = matrix
    invert(work, np.empty(n, np.int64))
    return work


@pytest.mark.parametrize("n", [3, 6, 9, 12])
def test_inverse_and_products(n: int) -> None:
    """Against numpy.linalg, to rounding; a zero at the first place asks for an exchange of rows."""
    rng = np.random.default_rng(n)
    matrix = rng.normal(size=(n, n))
    matrix[0, 0] = 0.0
    work = inverse_of(matrix)
    np.testing.assert_allclose(work[:, :n], np.linalg.inv(matrix), rtol=1e-9, atol=1e-11)
    assert not work[:, n:].any()
    b, found = rng.normal(size=n), np.empty(n)
    multiply(work, b, found)
    np.testing.assert_allclose(found, np.linalg.solve(matrix, b), rtol=1e-9, atol=1e-11)
    columns = rng.normal(size=(n, 2, LANES))
    solved = np.empty_like(columns)
    multiply_columns(work, columns, solved)
    expected = np.linalg.solve(matrix, columns.reshape(n, -1)).reshape(columns.shape)
    np.testing.assert_allclose(solved, expected, rtol=1e-9, atol=1e-11)


def test_rows_of_very_different_size() -> None:
    """Rows scaled by 1e±12, as of a light and of a stiff law: the same inverse, scaled back."""
    rng = np.random.default_rng(0)
    matrix, size = rng.normal(size=(6, 6)), 10.0 ** np.array([12, -12, 0, 6, -6, 3])
    work = inverse_of(matrix * size[:, None])
    np.testing.assert_allclose(work[:, :6] * size, np.linalg.inv(matrix), rtol=1e-8, atol=1e-10)
