"""Moves of a series, against numpy's differences."""

from __future__ import annotations

import numpy as np
import pytest

from softid.kernels.input_moves import moves_of_at_least


@pytest.mark.parametrize("n", [1, 2, 1000])
def test_moves_are_the_large_differences(n: int) -> None:
    """Exactly, one that is just as large among them."""
    values = np.cumsum(np.random.default_rng(n).normal(size=n))
    moves = np.abs(np.diff(values))
    least = float(np.median(moves)) if n > 2 else 0.0
    expected = np.flatnonzero(moves >= least)
    count = moves_of_at_least(values, least, np.empty(0, np.int64))
    at = np.empty(count, np.int64)
    assert moves_of_at_least(values, least, at) == count == expected.size
    np.testing.assert_array_equal(at, expected)
