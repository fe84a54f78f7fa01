"""Inverses and products of small matrices, written out for the compiler."""

from __future__ import annotations

import numpy as np
import pytest

from softid.kernels.decorators import kernel
from softid.kernels.small_matrix import LANES, invert_block, multiply_columns


@kernel
def products(matrix: np.ndarray, b: np.ndarray, found: np.ndarray) -> None:
    """From Python an address needs a compiled function around it."""
    multiply_columns(matrix, b, found)


def test_inverse_of_one_of_several() -> None:
    """Against numpy.linalg, to rounding; the others are left alone."""
    matrices = np.random.default_rng(3).normal(size=(4, 3, 3))
    found = np.zeros_like(matrices)
    invert_block(matrices, 2, found)
    np.testing.assert_allclose(found[2], np.linalg.inv(matrices[2]), rtol=1e-12)
    assert not found[[0, 1, 3]].any()


def test_rows_of_very_different_size() -> None:
    """Rows scaled by 1e±12, as of a light and of a stiff law: the same inverse, scaled back."""
    rng = np.random.default_rng(0)
    matrix, size = rng.normal(size=(3, 3)), 10.0 ** np.array([12, -12, 0])
    found = np.empty((1, 3, 3))
    invert_block((matrix * size[:, None])[None], 0, found)
    np.testing.assert_allclose(found[0] * size, np.linalg.inv(matrix), rtol=1e-10)


def test_a_singular_matrix_has_no_finite_inverse() -> None:
    """A step must see that its stages cannot be solved: two equal rows."""
    found = np.empty((1, 3, 3))
    invert_block(np.array([[[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [0.0, 1.0, 4.0]]]), 0, found)
    assert not np.isfinite(found).all()


@pytest.mark.parametrize("shape", [(3, 5), (2, 4), (6, 9)])
def test_products_with_many_columns(shape: tuple[int, int]) -> None:
    """Against numpy, to rounding, in two groups; numbers behind the result are left alone."""
    rng = np.random.default_rng(shape[0])
    matrix, b = rng.normal(size=shape), rng.normal(size=(shape[1], 2, LANES))
    found = np.full((shape[0] + 1, 2, LANES), 7.0)
    products(matrix, b, found[:-1])
    expected = (matrix @ b.reshape(shape[1], -1)).reshape(-1, 2, LANES)
    np.testing.assert_allclose(found[:-1], expected, rtol=0.0, atol=1e-13)
    assert (found[-1] == 7.0).all()
