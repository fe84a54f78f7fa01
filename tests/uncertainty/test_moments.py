"""Lagged products against sums written out."""

from __future__ import annotations

import numpy as np

from softid.uncertainty.burg import MIN_LEFT
from softid.uncertainty.moments import gather_moments


def test_products_are_sums_over_the_samples_with_so_many_predecessors() -> None:
    """Two runs of 5 and 2 samples about a gap; equal lags have a little white noise more."""
    rng = np.random.default_rng(7)
    basis, residual = rng.normal(size=(8, 2)), rng.normal(size=8)
    residual[5] = np.nan
    rows = np.column_stack((basis, residual))
    order = 2
    expected = np.zeros((order + 1, order + 1, order + 1, 3, 3))
    counts = np.zeros(order + 1)
    for begin, end in ((0, 5), (6, 8)):
        for s in range(begin, end):
            t = min(s - begin, order)
            counts[t] += 1
            for i in range(t + 1):
                for j in range(t + 1):
                    expected[t, i, j] += np.outer(rows[s - i], rows[s - j])
    found = gather_moments([residual], [basis], order)
    np.testing.assert_allclose(found.products, expected, atol=10.0 * MIN_LEFT)
    np.testing.assert_array_equal(found.counts, counts)
    assert (found.n, found.longest, found.reachable) == (7, 5, 2)


def test_products_that_are_known_stand_for_the_samples() -> None:
    """Order 0 needs no more than those of all samples in use, with a gap; to rounding."""
    rng = np.random.default_rng(5)
    basis, residual = rng.normal(size=(90, 3)), rng.normal(size=90)
    residual[30:33] = np.nan
    used = np.isfinite(residual)
    known = basis[used].T @ basis[used], basis[used].T @ residual[used]
    plain = gather_moments([residual], [basis], 0)
    made = gather_moments([residual], [], 0, known=known)
    np.testing.assert_allclose(made.products, plain.products, rtol=1e-12)
    np.testing.assert_array_equal(made.counts, plain.counts)
    assert made.longest == plain.longest == 57
