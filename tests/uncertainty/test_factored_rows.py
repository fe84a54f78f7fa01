"""Derivatives as a product of two factors, against the product itself."""

from __future__ import annotations

import numpy as np

from softid.uncertainty import FactoredRows, ResidualBlock, sandwich_covariance
from softid.uncertainty.linearisation import stretch_sums

RNG = np.random.default_rng(11)
COLUMNS, WEIGHTS = RNG.normal(size=(5, 1003)), RNG.normal(size=(5, 3))


def factored(columns: np.ndarray) -> FactoredRows:
    dense = columns.T @ WEIGHTS
    return FactoredRows(columns, WEIGHTS, dense.T @ dense)


def test_sums_and_products_are_those_of_the_rows() -> None:
    """To rounding; the last of the stretches of 4 holds 3 samples."""
    rows, dense = factored(COLUMNS), COLUMNS.T @ WEIGHTS
    assert rows.shape == dense.shape
    np.testing.assert_allclose(rows.dense, dense, atol=1e-13)
    for length in (4, 2000):  # and one stretch that is longer than all of them
        np.testing.assert_allclose(rows.sums(length), stretch_sums(dense, length), atol=1e-11)
    mix, values = RNG.normal(size=(3, 2)), RNG.normal(size=1003)
    np.testing.assert_allclose(rows @ mix, dense @ mix, atol=1e-12)
    np.testing.assert_allclose(rows.along(values), dense.T @ values, atol=1e-11)


def test_errors_are_those_of_the_rows() -> None:
    """White noise and a walk, which asks for other orders, with a gap; to 1e-9 of each other."""
    for residual in (RNG.normal(size=1003), np.cumsum(RNG.normal(size=1003))):
        residual[200:203] = np.nan
        columns = np.where(np.isfinite(residual), COLUMNS, 0.0)
        rows = factored(columns)
        found, plain = (
            sandwich_covariance([ResidualBlock("y", (j,), (residual,), 0.5)], list("abc"))
            for j in (rows, rows.dense)
        )
        np.testing.assert_allclose(found.matrix, plain.matrix, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(found.inflation, plain.inflation, rtol=1e-9)
