"""Resonance of the supply line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from muscle_rig import SCALE, fine_times

from softid.effects.line_resonance import LineResonance


def test_ringing_period_and_decrement() -> None:
    """After a step: extremes every T/(2√(1 − ζ²)), each e^{−πζ/√(1 − ζ²)} of the one before."""
    time_s = np.arange(0.0, 5.0, 5e-4)
    u = np.where(time_s > 1.0, 1.0, 0.0)
    period, zeta = 0.4, 0.1
    found = LineResonance().apply(np.array([period, zeta]), time_s, u, SCALE) - 1.0
    ringing = np.sqrt(1.0 - zeta**2)
    ups = np.diff(np.sign(np.diff(found)))
    extremes = np.flatnonzero(ups[2001:])[:8] + 2002
    np.testing.assert_allclose(np.diff(time_s[extremes]), period / 2.0 / ringing, atol=1.1e-3)
    decrement = np.exp(-np.pi * zeta / ringing)
    np.testing.assert_allclose(found[extremes[1:]] / found[extremes[:-1]], -decrement, rtol=1e-3)


@pytest.mark.parametrize("zeta", [0.02, 1.0, 3.0])
def test_a_ramp_is_followed_late(zeta: float) -> None:
    """In the long run by 2ζ/ω; after 12 s of light damping the ringing is below 1e-3."""
    time_s = fine_times()
    found = LineResonance().apply(np.array([0.2, zeta]), time_s, time_s, SCALE)
    late_s = 2.0 * zeta * 0.2 / (2.0 * np.pi)
    assert time_s[-1] - found[-1] == pytest.approx(late_s, abs=1e-3 * 0.2)


@pytest.mark.parametrize("samples", [100, 110, 240, 5000])
def test_nothing_rings_faster_than_four_samples(samples: int) -> None:
    """Two samples are the shortest period that samples can show, and a straight input between them
    passes for a ringing of three or a little more. In a short log, too, it begins within the
    bounds."""
    scale = replace(SCALE, duration_s=samples * SCALE.period_s)
    period = LineResonance().parameters(scale)["period"]
    assert period.lower == pytest.approx(4.0 * SCALE.period_s)
    for start in LineResonance().starts(scale):
        assert period.lower <= start["period"] <= period.upper


def test_what_is_well_damped_is_not_told_to_ring() -> None:
    """From a damping ratio of 0.7 on it is a lag, with another remedy."""
    lightly, well = (LineResonance().wording({"period": 0.5, "zeta": z}) for z in (0.69, 0.71))
    assert "overshoots and rings" in lightly.meaning
    assert lightly.title == LineResonance.title
    assert "without ringing" in well.meaning
    assert well.title.startswith("Lag of second order")
    assert well.remedy != lightly.remedy
