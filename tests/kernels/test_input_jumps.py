"""Jumps of a course in one pass, against numpy's differences of all of it."""

from __future__ import annotations

import numpy as np
import pytest

from softid.kernels.input_jumps import count_changes, find_jumps


@pytest.mark.parametrize("n", [2, 3, 400])
@pytest.mark.parametrize("flat", [0.0, 0.1, 0.6])
def test_jumps_are_large_changes_between_small_ones(n: int, flat: float) -> None:
    """Exactly, at both ends too: every third change is two to four, the others are below one."""
    rng = np.random.default_rng(n)
    sizes = np.where(np.arange(n - 1) % 3 == 0, rng.uniform(2.0, 4.0, n - 1), rng.random(n - 1))
    values = np.concatenate(([0.0], np.cumsum(sizes * rng.choice([-1.0, 1.0], n - 1))))
    changes = np.abs(np.diff(values))
    beside = np.concatenate(([0.0], changes, [0.0]))
    is_flat = np.maximum(beside[:-2], beside[2:]) <= flat * changes
    found = np.empty(n // 2, np.int64)
    count = find_jumps(values, 2.5, flat, found)
    expected = np.flatnonzero(is_flat & (changes >= 2.5))
    np.testing.assert_array_equal(found[:count], expected)


def test_changes_are_counted_with_those_that_are_just_as_large() -> None:
    values = np.array([0.0, 0.5, 0.0, 2.0, 2.5])
    assert [count_changes(values, least) for least in (0.4, 0.5, 0.6, 3.0)] == [4, 4, 1, 0]
    assert count_changes(values[:1], 0.0) == 0
