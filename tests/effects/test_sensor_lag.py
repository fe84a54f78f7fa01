"""Lag of the sensor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from muscle_rig import SCALE, extended, response, segment, times

from softid.effects.sensor_lag import SensorLag


@pytest.mark.parametrize("sampling", ["100 Hz", "50 Hz", "irregular"])
def test_a_ramp_from_rest(sampling: str) -> None:
    """t − τ (1 − e^{−t/τ}) from the settled start, on the samples, to 1e-9."""
    time_s = times(sampling)
    found = SensorLag().apply(np.array([0.15]), time_s, 2.0 * time_s, SCALE)
    expected = 2.0 * (time_s + 0.15 * np.expm1(-time_s / 0.15))
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9)


def test_a_swing_within_sixteen_samples() -> None:
    """A motion at 6 Hz, 100 Hz: in the end sin(ωt − atan ωτ)/√(1 + ω²τ²), to 1e-3; lines from
    sample to sample would miss by 1.2e-2, (ωh)²/12."""
    time_s, omega, tau = times("100 Hz"), 2.0 * np.pi * 6.0, 0.004
    found = SensorLag().apply(np.array([tau]), time_s, np.sin(omega * time_s), SCALE)
    expected = np.sin(omega * time_s - np.arctan(omega * tau)) / np.hypot(1.0, omega * tau)
    late = time_s > 10.0 * tau
    np.testing.assert_allclose(found[late][:-2], expected[late][:-2], rtol=0.0, atol=1e-3)
    two = SensorLag().apply(np.array([tau]), time_s[:2], np.zeros(2), SCALE)
    np.testing.assert_array_equal(two, 0.0)


def test_behind_a_lag_order_does_not_matter() -> None:
    """A lag of the sensor is one before a linear actuator, within 2e-3 of the range.

    The muscle is nearly linear in 2 kPa; what is left, 1.1e-3, is the rest of its bend and the
    motion that counts as straight between samples.
    """
    s = replace(segment(), input=100.0 + segment().input / 70.0)
    before, after = response(*extended("pneumatic_lag"), s), response(*extended("sensor_lag"), s)
    np.testing.assert_allclose(after, before, rtol=0.0, atol=2e-3 * np.ptp(before))
