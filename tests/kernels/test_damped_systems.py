"""The damped linear system against numpy's, where there is no solution, and steps in bounds."""

from __future__ import annotations

import numpy as np
import pytest

from softid.kernels.damped_systems import bounded_step, find_movable, is_still, solve_damped

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


def test_a_step_is_shortened_kept_in_bounds_and_its_gain_predicted() -> None:
    """By hand: 8 and 2 reaches are shortened to 4 and 1, and the second unknown meets its bound."""
    z, step, reach = np.zeros(3), np.array([-8.0, 4.0, 0.0]), np.array([1.0, 2.0, 1.0])
    lower, upper = np.full(3, -10.0), np.array([10.0, 1.5, 10.0])
    matrix, gradient, trial = np.diag([1.0, 2.0, 3.0]), np.array([-5.0, 6.0, 7.0]), np.empty(3)
    found = bounded_step(z, step, reach, 4.0, lower, upper, matrix, gradient, trial)
    np.testing.assert_allclose(step, [-4.0, 2.0, 0.0])
    np.testing.assert_allclose(trial, [-4.0, 1.5, 0.0])
    assert found == pytest.approx((8.0, 20.0 + 9.0 - 0.5 * (16.0 + 2.0 * 1.5**2)))


def test_what_is_no_number_is_no_step() -> None:
    """A step beyond all numbers stays one that an optimiser refuses."""
    step, trial, one = np.array([np.inf, 1.0]), np.empty(2), np.ones(2)
    with np.errstate(all="ignore"):
        found = bounded_step(one, step, one, 3.0, -one, 2.0 * one, np.eye(2), one, trial)
    assert np.isnan(trial[0])
    assert not found[1] > 0.0
    assert not is_still(one, trial, 1e-9)


def test_which_unknowns_may_move() -> None:
    """At its lower and upper bound pulled outward and inward, inside, and held between equals."""
    lower, upper = (
        np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        np.array([1.0, 1.0, 1.0, 1.0, 1.0, 0.0]),
    )
    z, gradient = (
        np.array([0.0, 0.0, 1.0, 1.0, 0.5, 0.0]),
        np.array([-1.0, 1.0, 1.0, -1.0, 1.0, 1.0]),
    )
    moving = np.empty(6, bool)
    find_movable(z, gradient, lower, upper, moving)
    assert moving.tolist() == [False, True, False, True, True, False]


def test_a_move_by_rounding_is_none() -> None:
    assert is_still(np.array([1.0, 0.0]), np.array([1.0 + 1e-12, 1e-23]), 1e-11)
    assert not is_still(np.array([1.0, 0.0]), np.array([1.0 + 1e-10, 0.0]), 1e-11)
