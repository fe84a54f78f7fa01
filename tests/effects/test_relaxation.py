"""A reading that returns by a share of every change."""

from __future__ import annotations

import numpy as np
import pytest
from muscle_rig import SCALE, times

from softid.effects.relaxation import Relaxation


@pytest.mark.parametrize("sampling", ["100 Hz", "irregular"])
def test_a_step_returns_by_its_share(sampling: str) -> None:
    """Settled before, 1 − c of it; behind a step of 1 the reading is 1 − c (1 − e^{−t/τ}).

    To 1e-3 c: between two samples the step counts as straight, which is late by half an interval.
    """
    time_s = times(sampling)
    jump = np.flatnonzero(time_s > 2.0)[0]
    y = np.where(np.arange(time_s.size) < jump, 3.0, 4.0)
    found = Relaxation().apply(np.array([0.2, 4.0]), time_s, y, SCALE)
    np.testing.assert_allclose(found[:jump], 3.0 * 0.8, rtol=1e-12)
    since_s = time_s[jump:] - time_s[jump - 1 : jump + 1].mean()
    expected = 3.0 * 0.8 + 1.0 + 0.2 * np.expm1(-since_s / 4.0)
    np.testing.assert_allclose(found[jump:], expected, rtol=0.0, atol=1e-3 * 0.2)


def test_with_all_of_it_no_standstill_is_seen() -> None:
    """c = 1 is a high-pass: of a sine of ω its gain is ωτ/√(1 + ω²τ²), to 1e-3 once settled."""
    time_s, omega, tau = np.arange(6000) * 0.01, 2.0, 0.5
    found = Relaxation().apply(np.array([1.0, tau]), time_s, np.sin(omega * time_s), SCALE)
    gain = omega * tau / np.hypot(1.0, omega * tau)
    assert np.max(np.abs(found[3000:])) == pytest.approx(gain, rel=1e-3)
