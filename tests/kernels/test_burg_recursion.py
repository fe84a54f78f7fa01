"""Prediction errors of the next order against their definition."""

from __future__ import annotations

import numpy as np

from softid.kernels.burg_recursion import raise_order


def test_the_errors_of_two_orders() -> None:
    """f_t − k b_{t−1} and b_{t−1} − k f_t of all pairs, and the products of the new ones."""
    series, first, second = np.random.default_rng(2).standard_normal(40), 0.4, -0.7
    forward, backward = series.copy(), series.copy()
    cross, power = raise_order(forward, backward, 0.0)
    f, b = series[1:], series[:-1]
    np.testing.assert_allclose((cross, power), (f @ b, f @ f + b @ b), rtol=1e-12)
    for k in (first, second):
        forward, backward = forward[1:], backward[:-1]
        cross, power = raise_order(forward, backward, k)
        f, b = (f - k * b)[1:], (b - k * f)[:-1]
        np.testing.assert_allclose((cross, power), (f @ b, f @ f + b @ b), rtol=1e-12)
    np.testing.assert_allclose(forward[1:], f, rtol=1e-12)


def test_a_single_sample_has_no_pair() -> None:
    one = np.ones(1)
    assert raise_order(one.copy(), one.copy(), 0.0) == (0.0, 0.0)
    assert raise_order(one[1:], one[:0], 0.5) == (0.0, 0.0)
