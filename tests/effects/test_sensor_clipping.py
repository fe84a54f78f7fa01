"""Clipping of the sensor."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem, standing
from muscle_rig import SCALE, THETA, extended, jacobian_error, response, segment

from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search.effect_starts import candidate_at
from softid.effects.sensor_clipping import BothSensorClipping, LowerSensorClipping, SensorClipping
from softid.log import Log

KEYS = ("sensor_clipping", "sensor_clipping.lower", "sensor_clipping.both")
LIMITS = {"upper": 0.9, "lower": 0.5}
"""Both inside the motion of the rig, which runs from 0.33 rad to above 1.5 rad."""


def clipped(key: str, limits: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    model, theta = extended(key)
    for k, name in enumerate(model.parameters()):
        if k >= THETA.size:
            theta[k] = limits[name.removeprefix("sensor_clipping_")]
    return response(model, theta, segment()), response(*extended(), segment())


def test_flat_ends_at_exact_values() -> None:
    """min(y, ys), max(y, yl) and both, bit for bit."""
    upper, base = clipped(KEYS[0], LIMITS)
    np.testing.assert_array_equal(upper, np.minimum(base, 0.9))
    lower, _ = clipped(KEYS[1], LIMITS)
    np.testing.assert_array_equal(lower, np.maximum(base, 0.5))
    both, _ = clipped(KEYS[2], LIMITS)
    np.testing.assert_array_equal(both, np.clip(base, 0.5, 0.9))
    assert (both == 0.9).sum() > 100
    assert (both == 0.5).sum() > 100


def test_the_limit_is_told_without_the_zero_of_the_log() -> None:
    """A reading that ends at 1 rad on a sensor that is mounted 0.2 rad off: recorded is 1.2 rad at
    most, and the limit is 1. The steps of the search leave less than 1e-3 rad rms."""
    clean = linear_log()
    angle = np.minimum(clean.channels["angle"].values, 1.0) + 0.2
    pressure = clean.channels["pressure"].values
    log = Log.from_arrays(clean.time_s, {"pressure": pressure, "angle": angle}, name="clipped")
    problem = linear_problem([log])
    z = problem.unknowns(TRUTH)
    base, scale = standing(problem, z), scale_of(problem, z)
    right, wrong = (
        candidate_at(base, SensorClipping(), {"upper": upper}, scale, SIGMA)[0]
        for upper in (1.0, 1.2)
    )
    assert right < len(log) * (1e-3 / SIGMA["angle"]) ** 2
    assert wrong > 100.0 * right
    for effect in (SensorClipping(), LowerSensorClipping(), BothSensorClipping()):
        assert effect.law.endswith(" + sensor zero of the log")
        for limit in effect.parameters(scale).values():
            assert limit.meaning.endswith(", less the sensor zero of the log")


@pytest.mark.parametrize("key", KEYS)
def test_a_limit_beyond_the_motion_is_none(key: str) -> None:
    """The base response, bit for bit."""
    found, base = clipped(key, {"upper": 10.0, "lower": -10.0})
    np.testing.assert_array_equal(found, base)


def test_the_starts_reach_into_the_range() -> None:
    """A limit that is never met has no derivative, so a search could not move it."""
    for effect in (SensorClipping(), LowerSensorClipping(), BothSensorClipping()):
        assert effect.amplitude is None
        for start in effect.starts(SCALE):
            assert SCALE.y_low < start.get("upper", 1.0) < SCALE.y_high
            assert SCALE.y_low < start.get("lower", 1.0) < SCALE.y_high


@pytest.mark.parametrize("sampling", ["100 Hz", "50 Hz", "irregular"])
@pytest.mark.parametrize("key", KEYS)
def test_sensor_clipping_derivatives(key: str, sampling: str) -> None:
    """By the limit 1 where it is met, and by all else 0 there: central differences, within 1e-4.

    Steps of 1e-6 so that no sample passes the limit between them.
    """
    model, theta = extended(key)
    for k, name in enumerate(model.parameters()):
        if k >= THETA.size:
            theta[k] = LIMITS[name.removeprefix("sensor_clipping_")]
    assert jacobian_error(model, theta, segment(sampling), step=1e-6) < 1e-4
