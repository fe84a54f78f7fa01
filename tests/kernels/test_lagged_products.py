"""Lagged products of two series against numpy's, over more than one chunk and beyond the end."""

from __future__ import annotations

import numpy as np
import pytest

from softid.kernels.lagged_products import CHUNK, add_lagged_products


@pytest.mark.parametrize("n", [1, 3, CHUNK - 1, 2 * CHUNK + 5])
def test_they_are_the_sums_at_every_lag(n: int) -> None:
    """To rounding of n terms; where a lag is longer than the series nothing is added."""
    a, b = np.random.default_rng(n).standard_normal((2, n))
    found = np.ones(6)
    add_lagged_products(a + 3.0, b + 3.0, 3.0, found)
    expected = [1.0 + a[: max(n - k, 0)] @ b[k:] for k in range(6)]
    np.testing.assert_allclose(found, expected, atol=1e-12 * n)
