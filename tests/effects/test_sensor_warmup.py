"""Warm-up of the sensor."""

from __future__ import annotations

import numpy as np
import pytest
from muscle_rig import SCALE, times

from softid.effects.sensor_warmup import SensorWarmup


def test_it_approaches_its_size() -> None:
    """D (1 − 1/e) after T, and a share e^{−12/T} short of D at the end, to rounding."""
    time_s = times("50 Hz")
    found = SensorWarmup().apply(np.array([0.3, 2.0]), time_s, np.ones(time_s.size), SCALE) - 1.0
    assert found[0] == 0.0
    assert found[100] == pytest.approx(0.3 * (1.0 - np.exp(-1.0)), abs=1e-12)
    assert found[-1] == pytest.approx(0.3 * (1.0 - np.exp(-time_s[-1] / 2.0)), abs=1e-12)


def test_a_slow_warmup_is_a_drift() -> None:
    """For T ≫ t it is (D/T) t, off by t/2T."""
    time_s = times("100 Hz")
    found = SensorWarmup().apply(np.array([1e3, 1e6]), time_s, np.zeros(time_s.size), SCALE)
    np.testing.assert_allclose(found, 1e-3 * time_s, rtol=1e-5)
