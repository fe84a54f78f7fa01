"""Columns of derivatives beside each other, against linear algebra by hand."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.residual.projection import (
    added_basis,
    basis_of,
    project_out,
    rows_of,
    span_of,
)

BOTH = np.array([[1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])


def test_a_basis_is_orthonormal_and_spans() -> None:
    """Columns of very different size count alike; one that is zero or a double adds nothing."""
    columns = np.column_stack((BOTH * [1e9, 1e-9], np.zeros(3), BOTH[:, 0]))
    basis = basis_of(columns)
    assert basis.shape == (3, 2)
    np.testing.assert_allclose(basis.T @ basis, np.eye(2), atol=1e-12)
    np.testing.assert_allclose(
        project_out(basis, np.array([3.0, 4.0, 5.0])), [0.0, 0.0, 5.0], atol=1e-9
    )
    assert basis_of(np.zeros((3, 2))).shape == (3, 0)


def test_combinations_make_the_basis_of_the_columns() -> None:
    """By the definition of both; a direction that counts no more is in neither."""
    columns = np.column_stack((BOTH * [1e3, 1e-3], np.zeros(3)))
    span = span_of(columns, 1e-10)
    np.testing.assert_allclose(columns @ span.combinations, span.basis, atol=1e-12)
    assert span.combinations.shape == (3, 2)
    assert not span.combinations[2].any()
    nearly = np.array([[1.0, 1.0], [0.0, 1e-7]])
    assert span_of(nearly, 1e-6).combinations.shape == (2, 1)
    assert span_of(nearly, 1e-8).combinations.shape == (2, 2)


def test_what_columns_add_stands_beside_the_basis() -> None:
    """Of (1, 1, 0) beside the first axis the second one stays; of the first axis itself nothing."""
    first = BOTH[:, :1]
    np.testing.assert_allclose(
        np.abs(added_basis(first, BOTH[:, 1:])), [[0.0], [1.0], [0.0]], atol=1e-9
    )
    assert added_basis(first, 5.0 * first).shape == (3, 0)


def test_rows_are_those_of_the_problem() -> None:
    """The used samples of every segment, with the motion at all of them."""
    log = linear_log(noise=0.01)
    masked = np.zeros(len(log), bool)
    masked[300:340] = True
    problem = linear_problem([log.with_masked(masked), linear_log(seed=1)])
    candidate = standing(problem, problem.unknowns(TRUTH), SIGMA)
    rows = rows_of(candidate)
    assert [row.place.log for row in rows] == [0, 1]
    assert rows[0].residual.size == len(log) - 40 == int(rows[0].used.sum())
    assert rows[0].jacobian.shape == (len(log) - 40, problem.size)
    assert rows[0].motion.x.size == len(log)
    squares = sum(float(row.residual @ row.residual) for row in rows)
    assert squares / SIGMA["angle"] ** 2 == pytest.approx(candidate.squares, rel=1e-6)
