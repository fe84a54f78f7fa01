"""The damped linear system against numpy's, and where there is no solution."""

from __future__ import annotations

import numpy as np
import pytest

from softid.kernels.damped_systems import solve_damped

SIZES = (1, 3, 10, 60)


@pytest.mark.parametrize("size", SIZES)
def test_it_is_the_solution_over_what_moves(size: int) -> None:
    """Of numpy's LU factors; a random tall matrix has a condition far below 1e4."""
    rng = np.random.default_rng(size)
    jacobian = rng.standard_normal((3 * size, size))
    matrix, ridge, vector = jacobian.T @ jacobian, rng.random(size), rng.standard_normal(size)
    moving = np.arange(size) % 4 != 1
    found = np.full(size, np.nan)
    assert solve_damped(matrix, ridge, vector, moving, found)
    among = (matrix + np.diag(ridge))[np.ix_(moving, moving)]
    expected = np.zeros(size)
    expected[moving] = np.linalg.solve(among, vector[moving])
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12)


def test_no_solution_of_a_matrix_that_is_not_positive_definite() -> None:
    vector, moving, found = np.ones(2), np.ones(2, bool), np.empty(2)
    for matrix in (np.ones((2, 2)), np.diag([1.0, -1.0]), np.full((2, 2), np.nan)):
        assert not solve_damped(matrix, np.zeros(2), vector, moving, found)
    assert solve_damped(np.ones((2, 2)), np.full(2, 1e-3), vector, moving, found)
