"""Which logs hold a single step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from linear_motion import linear_problem

from softid.diagnosis.residual.one_step import is_one_step
from softid.log import Log

UP = ([2.0, 2.5], [0.0, 60.0])


def pulse(height: float, end: float) -> tuple[list[float], list[float]]:
    """Up or down for 1 s, and where a noisy reading ends."""
    return [1.0, 1.1, 2.0, 2.1, 19.9, 19.98], [0.0, height, height, 0.0, 0.0, end]


def log_of(corners_s: Sequence[float], levels: Sequence[float], noise: float = 0.0) -> Log:
    time_s = np.arange(1000) / 50.0
    pressure = np.interp(time_s, corners_s, levels)
    pressure += noise * np.random.default_rng(1).standard_normal(time_s.size)
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": 0.02 * pressure})


@pytest.mark.parametrize(
    ("courses", "is_one"),
    [
        ([UP], True),
        ([([2.0, 2.5], [60.0, 0.0])], True),
        ([([2.0, 2.2, 2.4], [0.0, 63.0, 60.0])], True),
        ([UP, UP], True),
        ([UP, ([2.0, 2.5], [0.0, 40.0])], False),
        ([([2.0, 2.5, 9.0, 9.5], [0.0, 60.0, 60.0, 0.0])], False),
        ([([2.0, 2.5, 9.0, 9.5], [0.0, 30.0, 30.0, 60.0])], False),
        ([pulse(60.0, 0.01)], False),
        ([pulse(60.0, -0.01)], False),
        ([pulse(-60.0, 0.01)], False),
        ([pulse(-60.0, -0.01)], False),
        ([([2.0, 9.0], [0.0, 60.0])], False),
        ([([2.0, 9.0], [0.0, 0.0])], False),
    ],
    ids=[
        "up",
        "down",
        "that overshoots",
        "twice",
        "to two levels",
        "up and down",
        "a staircase",
        "a pulse",
        "a pulse that ends below",
        "a pulse downward",
        "a pulse downward that ends below",
        "a ramp",
        "nothing moves",
    ],
)
def test_a_step_is_one_change_that_stays(courses: list, is_one: bool) -> None:
    assert is_one_step(linear_problem([log_of(*course) for course in courses])) is is_one


def test_noise_of_the_pressure_makes_no_steps() -> None:
    assert is_one_step(linear_problem([log_of(*UP, noise=0.5)]))
