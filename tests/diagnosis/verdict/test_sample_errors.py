"""Errors that are told of a search in averages, and those that anybody finds in the logs."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import TRUTH, linear_angle

import softid
from softid.log import Log


def slow_motion(seed: int) -> Log:
    """Steps of an overdamped actuator that drifts, at 500 Hz, under noise of 0.01 rad."""
    time_s = np.arange(13000) / 500.0
    levels = np.random.default_rng(seed).uniform(0.0, 80.0, 6)
    pressure = np.repeat(levels, 2500)[: time_s.size]
    angle = linear_angle(time_s, pressure, TRUTH | {"N": 100.0}) + 0.01 * time_s
    angle += 0.01 * np.random.default_rng(seed + 1).standard_normal(time_s.size)
    channels = {"pressure": pressure, "angle": angle}
    return Log.from_arrays(time_s, channels, name=f"steps {seed}").with_intersample("straight")


def test_the_errors_are_those_that_a_validation_finds() -> None:
    """Means of three samples have 0.58 times their noise, and would promise as much more."""
    hold_out = slow_motion(20)
    found = softid.diagnose(
        slow_motion(10), hold_out=[hold_out], model="oscillator", effects=["sensor_drift"]
    )
    assert "averaged" in {issue.code for issue in found.issues}
    assert found.extended is not None
    (gain,) = [gain for gain in found.gains if gain.held_out]
    errors = (gain.rmse_before, gain.rmse_after)
    for fit, error in zip((found.base, found.extended), errors, strict=True):
        (row,) = softid.validate(fit, [hold_out]).statistics
        (told,) = [r for r in fit.statistics if not r.in_sample]
        assert told.rmse == pytest.approx(row.rmse, rel=0.005)
        assert error == pytest.approx(row.rmse, rel=0.005)
