"""Drift of the sensor's gain."""

from __future__ import annotations

import numpy as np
import pytest
from muscle_rig import SCALE, THETA, segment, times

from softid.effects import EFFECTS, ExtendedModel
from softid.effects.sensor_gain_drift import SensorGainDrift
from softid.models.muscle import Muscle


def test_the_gain_grows_with_time() -> None:
    """Closed form: after 10 s at 2 % in a second a reading is 1.2 times the motion."""
    time_s = times("100 Hz")
    motion = np.sin(time_s) + 2.0
    found = SensorGainDrift().apply(np.array([0.02]), time_s, motion, SCALE)
    assert found[0] == motion[0]
    assert found[1000] == pytest.approx(1.2 * motion[1000], rel=1e-12)


def test_at_rest_it_is_what_ageing_does() -> None:
    """At the end of a hold of 2.5 s the gain 1/(1 + r t) differs by what the stiffness changes in a
    time constant, r τ x with τ below 0.3 s; while it moves they differ by more, for ageing changes
    the time constant."""
    drive = segment()
    r = -0.02
    times_s = drive.time_s
    factor = 1.0 / (1.0 + r * times_s)
    model = ExtendedModel(Muscle(), (EFFECTS["ageing"](),), SCALE)
    theta = np.array([*THETA, r])
    aged = model.response(theta, drive, ("angle",), start=None, derivatives=False).outputs["angle"]
    plain = Muscle().response(THETA, drive, ("angle",), start=None, derivatives=False)
    read = plain.outputs["angle"] * factor
    apart = np.abs(aged - read)
    assert apart[times_s > 7.9][0] < abs(r) * 0.3 * 1.8
    assert apart.max() > 2.0 * abs(r) * 0.3 * 1.8
