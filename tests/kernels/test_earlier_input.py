"""Courses read at other times, against `numpy.interp` and integrals in closed form."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from softid.kernels.earlier_input import largest_between, means_between, read_at

Array = npt.NDArray[np.float64]


def course(seed: int, n: int = 300) -> tuple[Array, Array]:
    """Irregular times and values that jump."""
    random = np.random.default_rng(seed)
    return np.cumsum(random.uniform(0.001, 0.05, n)), 100.0 * random.uniform(size=n).round(1)


@pytest.mark.parametrize("shift", [0.0, 0.013, 0.7, -0.4, 50.0, -50.0])
@pytest.mark.parametrize("seed", range(3))
def test_a_course_is_read_as_numpy_does(shift: float, seed: int) -> None:
    """The same numbers, also at the course's own times and beyond its ends."""
    time_s, values = course(seed)
    found = np.empty(time_s.size)
    read_at(time_s - shift, time_s, values, found)
    assert np.array_equal(found, np.interp(time_s - shift, time_s, values))


def test_another_number_of_times() -> None:
    time_s, values = course(5)
    at_s = np.linspace(time_s[0], time_s[-1], 7)
    found = np.empty(7)
    read_at(at_s, time_s, values, found)
    assert found == pytest.approx(np.interp(at_s, time_s, values), rel=1e-14)


@pytest.mark.parametrize("shift", [0.0, 0.013, 0.7])
def test_means_are_those_of_fine_sums(shift: float) -> None:
    """A thousand points between two edges; before the beginning the first value holds."""
    time_s, values = course(1)
    middle = 0.5 * (time_s[1:] + time_s[:-1])
    edges = np.concatenate((time_s[:1], middle, time_s[-1:])) - shift
    found = np.empty(time_s.size)
    means_between(edges, time_s, values, found)
    shares = (np.arange(1000) + 0.5) / 1000
    points = edges[:-1, None] + np.diff(edges)[:, None] * shares
    assert found == pytest.approx(np.interp(points, time_s, values).mean(axis=1), abs=0.05)


def test_a_mean_by_hand() -> None:
    """From 0 to 10 in one second: the means of its halves are 2.5 and 7.5; at rest before it 0."""
    found = np.empty(3)
    means_between(
        np.array([-1.0, 0.0, 0.5, 1.0]), np.array([0.0, 1.0]), np.array([0.0, 10.0]), found
    )
    assert found.tolist() == [0.0, 2.5, 7.5]


def test_the_largest_of_a_stretch_lies_at_its_ends_or_at_a_corner_within() -> None:
    """By hand: between 1.5 and 2.5 s it is the corner at 2 s, elsewhere the higher end."""
    time_s, values = np.arange(5.0), np.array([0.0, 1.0, 3.0, 0.0, -1.0])
    found = np.empty(4)
    largest_between(
        np.array([-1.0, 0.25, 1.5, 3.25]), np.array([-0.5, 0.75, 2.5, 9.0]), time_s, values, found
    )
    np.testing.assert_allclose(found, [0.0, 0.75, 3.0, -0.25])
