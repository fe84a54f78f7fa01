"""Delay of the input."""

from __future__ import annotations

import numpy as np
import pytest
from muscle_rig import (
    SCALE,
    extended,
    fine_times,
    pressure,
    response,
    segment,
)

from softid.effects.delay import Delay
from softid.log import Log


def test_a_delayed_ramp() -> None:
    """The input τ earlier, its kinks at kinks of the times: a straight line to rounding."""
    time_s = fine_times()
    found = Delay().apply(np.array([0.25]), time_s, 3.0 * time_s, SCALE)
    expected = 3.0 * np.maximum(time_s - 0.25, 0.0)
    before = time_s < 0.26  # the kink at 0.25 s lies between two times
    np.testing.assert_allclose(found[~before], expected[~before], rtol=0.0, atol=1e-12)
    np.testing.assert_array_equal(found[time_s <= 0.25], 0.0)


def test_a_delay_of_whole_samples_shifts_the_response() -> None:
    """Seven samples later the same, within 1e-4 of the range, which is the integrator's."""
    model, theta = extended("delay")
    theta[-1] = 0.07
    s = segment()
    base = response(*extended(), s)
    found = response(model, theta, s)
    np.testing.assert_allclose(found[7:], base[:-7], rtol=0.0, atol=1e-4 * np.ptp(base))


def test_a_delay_of_a_part_of_a_sample() -> None:
    """A log at 1 kHz, where the delay is whole, within 5e-4 of the range.

    A step of 140 kPa within 20 ms bends inside the integrator's steps.
    """
    model, theta = extended("delay")
    theta[-1] = 0.043
    s = segment()
    base, by_theta = extended()
    fine_s = np.arange(s.time_s.size * 10 - 9) * 1e-3
    moved = Log.from_arrays(
        fine_s,
        {"pressure": pressure(fine_s - 0.043), "angle": np.zeros(fine_s.size)},
        units={"angle": "rad"},
    ).segments()[0]
    expected = response(base, by_theta, moved)[::10]
    found = response(model, theta, s)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=5e-4 * np.ptp(expected))


def test_delays_add_up() -> None:
    """p(t − τ1 − τ2) away from the kinks, to rounding."""
    time_s = fine_times()
    once = Delay().apply(np.array([0.1]), time_s, 2.0 * time_s, SCALE)
    twice = Delay().apply(np.array([0.2]), time_s, once, SCALE)
    late = time_s > 0.31
    np.testing.assert_allclose(twice[late], 2.0 * (time_s[late] - 0.3), rtol=0.0, atol=1e-12)


def test_a_held_jump_arrives_smoothly_in_the_delay() -> None:
    """Closed form: what arrives adds up to the jump's level times the time since it arrived, for
    any delay. Single times would have it arrive up to half of their distance off."""
    ticks = np.arange(0.0, 1.0, 0.01)
    time_s = np.sort(np.append(ticks, 0.3 - 1e-5))
    u = np.where(time_s >= 0.3 - 1e-9, 100.0, 0.0)
    for tau in (0.0, 0.0523, 0.1, 0.1071):
        found = Delay().apply(np.array([tau]), time_s, u, SCALE)
        cells = np.diff(np.concatenate((time_s[:1], 0.5 * (time_s[1:] + time_s[:-1]), time_s[-1:])))
        arrived = float(np.sum(found * cells))
        assert arrived == pytest.approx(100.0 * (0.99 - 0.3 - tau), abs=1e-3)
