"""The restricted likelihood of autoregressions against their covariance matrix."""

from __future__ import annotations

import numpy as np
import pytest

from softid.kernels.restricted_likelihood import reduce_forms, weigh_products
from softid.uncertainty.autoregression import autocovariances
from softid.uncertainty.moments import gather_moments

N, MOST = 40, 3


@pytest.mark.parametrize("order", [0, 1, 3])
def test_determinants_and_what_is_left(order: int) -> None:
    """Of three models, by V itself: to 1e-5, since 1e-6 of the residual's power is added to it.

    A model of a lower order than that of the products repeats its last filter.
    """
    rng = np.random.default_rng(order)
    basis, residual = np.linalg.qr(rng.standard_normal((N, 2)))[0], rng.standard_normal(N)
    moments = gather_moments([residual], [basis], MOST)
    reflection = rng.uniform(-0.9, 0.9, (3, order))
    determinant, left = np.empty(3), np.empty(3)
    weights, ratios = np.empty((3, len(moments.packed))), np.empty((3, MOST + 1))
    weigh_products(reflection, *moments.terms, weights, ratios)
    reduce_forms(moments.packed.T @ weights.T, ratios, moments.counts, determinant, left)
    places = np.abs(np.subtract.outer(np.arange(N), np.arange(N)))
    for k, gamma in enumerate(autocovariances(reflection, N)):
        inverse = np.linalg.inv(gamma[places])
        inner, cross = basis.T @ inverse @ basis, basis.T @ inverse @ residual
        expected = np.linalg.slogdet(gamma[places])[1] + np.linalg.slogdet(inner)[1]
        assert determinant[k] == pytest.approx(expected, abs=1e-6)
        rest = residual @ inverse @ residual - cross @ np.linalg.solve(inner, cross)
        assert left[k] == pytest.approx(rest, rel=1e-5)


def test_products_that_are_not_definite_leave_nothing() -> None:
    """Two equal columns: their second pivot is zero."""
    found, left = np.empty(1), np.empty(1)
    reduce_forms(np.ones((3, 1)), np.ones((1, 1)), np.ones(1), found, left)
    assert not left[0] > 0.0
