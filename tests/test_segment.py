"""Rows that are put into a stretch of a log."""

from __future__ import annotations

import numpy as np
import pytest

from softid.intersample import BEFORE
from softid.log import Log
from softid.segment import APART, absent_times, with_added, with_knots


def test_a_sample_is_a_row_beside_one_just_before_it() -> None:
    """Where a held input changes both are nearer to each other than rounding may tell."""
    time_s = np.array([2.9, 3.0 - BEFORE * 0.1, 3.0, 3.1])
    knot_s = np.array([[2.9, 2.925, 2.975, 3.0000000000000004]])
    absent = absent_times(time_s, knot_s, APART * np.diff(knot_s[:, [0, -1]]))
    assert absent.tolist() == [2.925, 2.975]


@pytest.mark.parametrize("rate_hz", [10.0, 30.0, 100.0])
def test_what_is_added_to_a_held_input_leaves_times_that_rise(rate_hz: float) -> None:
    """A pulse in every interval; at its ends nothing is added."""
    time_s = np.arange(400) / rate_hz
    u = np.repeat(np.random.default_rng(0).uniform(0.0, 100.0, 40), 10)
    (whole,) = Log.from_arrays(time_s, {"pressure": u, "angle": u}).segments()
    held = with_knots(whole, "held")
    knot_s = time_s[:-1, None] + np.diff(time_s)[:, None] * (0.0, 0.25, 0.75, 1.0)
    pulsed = with_added(held, knot_s, np.tile([0.0, 1.0, 1.0, 0.0], (knot_s.shape[0], 1)))
    assert np.all(np.diff(pulsed.time_s) > 0.0)
    assert pulsed.samples_of(pulsed.input) == pytest.approx(u)
