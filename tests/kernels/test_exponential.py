"""The polynomial exp against numpy's."""

from __future__ import annotations

import numpy as np
from numba import njit

from softid.kernels.exponential import exponential


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
