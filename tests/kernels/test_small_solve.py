"""Small systems against numpy."""

from __future__ import annotations

import numpy as np
import pytest

from softid.kernels.affine_work import HELD, MOVING, N_VECTORS, PULL, STEP
from softid.kernels.small_solve import damped_step, solve_in_place

RNG = np.random.default_rng(4)


@pytest.mark.parametrize("n", [1, 3, 9])
def test_solution_of_the_first_rows(n: int) -> None:
    """The same as numpy's to rounding, 1e-12, with a zero pivot on the way."""
    room = RNG.normal(size=(n + 3, n + 2))
    room[0, 0] = 0.0 if n > 1 else 2.0
    expected = np.linalg.solve(room[:n, :n], room[-1, :n])
    assert solve_in_place(room, n)
    np.testing.assert_allclose(room[-1, :n], expected, rtol=1e-12)


def test_a_singular_system_is_told() -> None:
    """Two equal rows of small integers leave an exact zero."""
    assert not solve_in_place(np.array([[1.0, 2.0], [1.0, 2.0], [1.0, 1.0]]), 2)
    assert not solve_in_place(np.array([[np.nan, 2.0], [np.nan, 2.0], [1.0, 1.0]]), 2)


def test_a_damped_step_moves_what_may_move() -> None:
    """(JᵀJ + λD²) s = g over the unknowns that move, 1e-12; zero for the one that is held."""
    jacobian, gradient = RNG.normal(size=(20, 4)), RNG.normal(size=4)
    matrix, scale = jacobian.T @ jacobian, np.array([1.0, 0.1, 3.0, 2.0])
    moving = np.array([True, False, True, True])
    vectors = np.full((N_VECTORS, 4), np.nan)
    vectors[HELD], vectors[MOVING], vectors[PULL] = scale, moving, gradient
    matrices = np.vstack([np.full((4, 4), np.nan), matrix])
    assert damped_step(matrices, 4, vectors, PULL, 0.7, np.empty((5, 4)), STEP)
    among = np.ix_(moving, moving)
    expected = np.linalg.solve(matrix[among] + 0.7 * np.diag(scale[moving] ** 2), gradient[moving])
    np.testing.assert_allclose(vectors[STEP, moving], expected, rtol=1e-12)
    assert vectors[STEP, 1] == 0.0
