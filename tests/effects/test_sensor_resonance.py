"""Resonance of the sensor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from muscle_rig import SCALE, extended, response, segment, times

from softid.effects.sensor_resonance import SensorResonance


@pytest.mark.parametrize("zeta", [0.15, 0.8, 2.0])
@pytest.mark.parametrize("sampling", ["100 Hz", "50 Hz", "irregular"])
def test_a_ramp_from_rest(sampling: str, zeta: float) -> None:
    """t − 2ζ/ω + transient from the settled start, with the roots of s² + 2ζω s + ω², to 1e-9."""
    time_s, period = times(sampling), 0.5
    found = SensorResonance().apply(np.array([period, zeta]), time_s, 2.0 * time_s, SCALE)
    omega = 2.0 * np.pi / period
    roots = np.roots([1.0, 2.0 * zeta * omega, omega**2]).astype(complex)
    late_s = 2.0 * zeta / omega
    # e = y − t + late obeys the free law with e(0) = late and ė(0) = −1.
    shares = np.linalg.solve(np.vstack((np.ones(2), roots)), np.array([late_s, -1.0]))
    transient = np.real(np.exp(np.outer(time_s, roots)) @ shares)
    np.testing.assert_allclose(found, 2.0 * (time_s - late_s + transient), rtol=0.0, atol=1e-9)


def test_a_swing_at_its_own_frequency() -> None:
    """A motion at ω comes out a quarter period late and 1/(2ζ) times as large, to 3e-3.

    At 6 Hz and 100 Hz; what is left is the motion that counts as straight in quarter intervals.
    """
    time_s, omega, zeta = times("100 Hz"), 2.0 * np.pi * 6.0, 0.25
    eta = np.array([2.0 * np.pi / omega, zeta])
    found = SensorResonance().apply(eta, time_s, np.sin(omega * time_s), SCALE)
    expected = np.sin(omega * time_s - np.pi / 2.0) / (2.0 * zeta)
    late = time_s > 4.0
    np.testing.assert_allclose(found[late][:-2], expected[late][:-2], rtol=0.0, atol=3e-3 * 2.0)


def test_behind_a_linear_actuator_order_does_not_matter() -> None:
    """A resonance of the sensor is one of the line, within 1 % of the range.

    The muscle is nearly linear in 2 kPa; what is left is the rest of its bend and the motion that
    counts as straight between samples.
    """
    s = replace(segment(), input=100.0 + segment().input / 70.0)
    before, after = (response(*extended(key), s) for key in ("line_resonance", "sensor_resonance"))
    np.testing.assert_allclose(after, before, rtol=0.0, atol=1e-2 * np.ptp(before))


def test_what_is_well_damped_is_not_told_to_ring() -> None:
    """From a damping ratio of 0.7 on it is a lag."""
    lightly, well = (SensorResonance().wording({"period": 0.5, "zeta": z}) for z in (0.69, 0.71))
    assert "swings on its mount" in lightly.meaning
    assert lightly.title == SensorResonance.title
    assert "without ringing" in well.meaning
    assert well.title.startswith("Lag of second order")
