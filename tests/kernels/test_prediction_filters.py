"""The filters of an autoregression against those of its step-up recursion in Python."""

from __future__ import annotations

import numpy as np
import pytest

from softid.kernels.prediction_filters import weigh_products
from softid.uncertainty.autoregression import predictors, to_phi


@pytest.mark.parametrize("order", [0, 1, 3])
def test_products_of_filters_over_their_variances(order: int) -> None:
    """All i, j of orders 0 … 3 of two models, to rounding; a higher order repeats the last."""
    size = 4
    reflection = np.random.default_rng(order).uniform(-0.9, 0.9, (2, order))
    when, first, second = (part.ravel() for part in np.indices((size, size, size)))
    weights, ratio = np.empty((2, size**3)), np.empty((2, size))
    weigh_products(reflection, when, first, second, weights, ratio)
    for b, k in enumerate(reflection):
        coefficients, expected = predictors(to_phi(k))
        filters = np.zeros((size, size))
        for t in range(size):
            known = coefficients[min(t, order)]
            filters[t, : known.size + 1] = 1.0, *(-known)
        variances = expected[np.minimum(np.arange(size), order)]
        np.testing.assert_allclose(ratio[b], variances, rtol=1e-12)
        wanted = filters[:, :, None] * filters[:, None, :] / variances[:, None, None]
        np.testing.assert_allclose(weights[b], wanted.ravel(), rtol=1e-10, atol=1e-12)
