"""Depths of excursions against their definition by moves."""

from __future__ import annotations

import numpy as np

from softid.kernels.excursions import measure_depths


def test_depths_are_the_lesser_moves_of_what_turns_back() -> None:
    """Up and down again by 3 and 2, on along a slope, a plateau, and noise against numpy."""
    found = np.empty(6)
    measure_depths(np.array([0.0, 3.0, 1.0, 2.0, 4.0, 4.0, 1.0, 7.0]), found)
    assert found.tolist() == [2.0, 1.0, 0.0, 0.0, 0.0, 3.0]
    values = np.random.default_rng(4).standard_normal(500)
    found, move = np.empty(498), np.diff(values)
    measure_depths(values, found)
    lesser = np.minimum(np.abs(move[:-1]), np.abs(move[1:]))
    np.testing.assert_array_equal(found, np.where(move[:-1] * move[1:] < 0.0, lesser, 0.0))
