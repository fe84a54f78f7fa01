"""Clock-rate error between input and output."""

from __future__ import annotations

import numpy as np
import pytest
from muscle_rig import SCALE, times

from softid.effects.clock_rate import ClockRate


def motion(time_s: np.ndarray) -> np.ndarray:
    """Two tones, the faster one of 3 Hz."""
    return np.sin(1.7 * time_s) + 0.3 * np.sin(6.0 * np.pi * time_s)


@pytest.mark.parametrize(
    ("sampling", "tolerance"), [("100 Hz", 1e-4), ("50 Hz", 1e-3), ("irregular", 3e-4)]
)
@pytest.mark.parametrize("rate", [-0.01, 0.003])
def test_the_motion_at_other_times(sampling: str, tolerance: float, rate: float) -> None:
    """y((1 + ε) t) within the log; the error of a cubic is (ωh)⁴/43 of its tone."""
    time_s = times(sampling)
    found = ClockRate().apply(np.array([rate]), time_s, motion(time_s), SCALE)
    inside = (1.0 + rate) * time_s <= time_s[-1]
    expected = motion((1.0 + rate) * time_s)
    np.testing.assert_allclose(found[inside], expected[inside], rtol=0.0, atol=2.0 * tolerance)


def test_the_end_runs_out() -> None:
    """Beyond the last sample a ramp goes on at its speed and stops within speed × motion time."""
    time_s = times("100 Hz")
    found = ClockRate().apply(np.array([0.05]), time_s, 2.0 * time_s, SCALE)
    beyond_s = 1.05 * time_s - time_s[-1]
    outside = beyond_s > 0.0
    expected = 2.0 * time_s[-1] - 2.0 * 0.2 * np.expm1(-beyond_s[outside] / 0.2)
    np.testing.assert_allclose(found[outside], expected, rtol=0.0, atol=1e-9)
    assert found.max() < 2.0 * (time_s[-1] + 0.2)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_samples(count: int) -> None:
    """Too few for a cubic: a straight line, still finite."""
    time_s = np.arange(count) * 0.01
    found = ClockRate().apply(np.array([-0.01]), time_s, time_s, SCALE)
    expected = time_s if count == 1 else 0.99 * time_s
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12)
