"""The polynomial exp and tanh by exp against numpy's."""

from __future__ import annotations

import numpy as np
from numba import njit

from softid.kernels.exponential import exponential, hyperbolic_tangent


def test_exponential_is_exact_to_two_units() -> None:
    """|exp(x)/numpy.exp(x) − 1| ≤ 4.5e-16, two units of the last place, from −700 to 700."""

    @njit
    def over(x, out):
        for i in range(x.size):
            out[i] = exponential(x[i])

    x = np.concatenate([np.linspace(-700.0, 700.0, 100_001), np.linspace(-1.0, 1.0, 10_001)])
    found = np.empty_like(x)
    over(x, found)
    assert np.abs(found / np.exp(x) - 1.0).max() <= 4.5e-16
    over(np.array([0.0, 1e9, -1e9, np.nan]), found[:4])
    assert found[0] == 1.0
    assert found[1] == found[3] == np.inf
    assert 0.0 <= found[2] < 1e-307


def test_hyperbolic_tangent_is_exact_to_roundings_of_one() -> None:
    """|found − numpy.tanh(x)| ≤ 4.5e-16, its ends are ±1 without overflow, and NaN stays NaN."""
    x = np.concatenate([np.linspace(-30.0, 30.0, 60_001), np.linspace(-1e-6, 1e-6, 2001)])
    found = np.array([hyperbolic_tangent(value) for value in x])
    assert np.abs(found - np.tanh(x)).max() <= 4.5e-16
    assert hyperbolic_tangent(1e9) == 1.0
    assert hyperbolic_tangent(-1e9) == -1.0
    assert np.isnan(hyperbolic_tangent(np.nan))
