"""Normal equations from products, against the Jacobian itself."""

from __future__ import annotations

import numpy as np

from softid.kernels.equation_sums import add_equations


def test_equations_are_those_of_the_jacobian() -> None:
    """w·JᵀJ and w·Jᵀr at their places among all unknowns, beside what stood there: to 1e-12."""
    rng = np.random.default_rng(2)
    columns, weights, t = rng.normal(size=(5, 40)), rng.normal(size=(5, 3)), rng.normal(size=5)
    at = np.array([0, 3, 1])
    gradient, matrix = np.ones(4), np.ones((4, 4))
    gram = columns @ columns.T
    squares, is_finite = add_equations(gram, weights, t, at, 2.0, gradient, matrix)
    jacobian, r = columns.T @ weights, columns.T @ t
    wanted, wanted_matrix = np.ones(4), np.ones((4, 4))
    wanted[at] += 2.0 * jacobian.T @ r
    wanted_matrix[np.ix_(at, at)] += 2.0 * jacobian.T @ jacobian
    np.testing.assert_allclose(gradient, wanted, rtol=1e-12)
    np.testing.assert_allclose(matrix, wanted_matrix, rtol=1e-12)
    np.testing.assert_array_equal(matrix, matrix.T)
    np.testing.assert_allclose(squares, r @ r, rtol=1e-12)
    assert is_finite


def test_what_is_not_finite_is_told() -> None:
    """A single product beyond all numbers, which only the matrix sees."""
    gram = np.eye(3)
    gram[0, 0] = np.inf
    weights, t, at = np.eye(3, 2), np.array([0.0, 0.0, 1.0]), np.array([0, 1])
    assert not add_equations(gram, weights, t, at, 1.0, np.zeros(2), np.zeros((2, 2)))[1]
