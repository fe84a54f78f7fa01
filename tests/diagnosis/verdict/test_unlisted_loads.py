"""Loads that move by themselves: the law in closed form, and logs that hide it."""

from __future__ import annotations

import numpy as np
import pytest
from extended_fits import scale_of as sizes_of
from scipy.signal import lsim

from softid.diagnosis import diagnose
from softid.diagnosis.verdict.unlisted_loads import SwingingLoad
from softid.diagnosis_results import Verdict
from softid.synthesis import hidden_pair

SPRING, DAMPER, MASS = 8.0, 0.05, 0.12
"""Of a load, in N/m, N·s/m and kg, on an actuator of 40 N/m, 1.5 N·s/m and 0.11 kg."""


def test_a_load_on_a_spring_is_a_share_a_swing_and_its_rate() -> None:
    """Against both equations of motion together, after a step and a ramp.

    Their four poles are those of an actuator and those of a swing; the load's own poles are zeros.
    """
    time_s = np.arange(0.0, 8.0, 0.002)
    u = np.where(time_s > 0.5, 30.0, 0.0) - np.clip(time_s - 4.0, 0.0, 1.0) * 20.0
    load = np.array([MASS, DAMPER, SPRING])
    own = np.array([0.11, 1.5, 40.0])
    whole = np.polyadd(np.polymul(own, load), np.polymul([MASS, 0.0, 0.0], [DAMPER, SPRING]))
    truth = lsim((load, whole), u, time_s)[1]

    fast, slow = np.sort_complex(np.roots(whole)).reshape(2, 2)
    w2, damping = float(np.prod(slow).real), -float(np.sum(slow).real)
    actuator = 40.0 * np.poly(fast).real / np.prod(fast).real
    kept_back = 1.0 - w2 * MASS / SPRING
    zeta = 0.5 * damping / np.sqrt(w2)
    d = 0.5 * np.sqrt(w2) * DAMPER / SPRING - (1.0 - kept_back) * zeta
    still = lsim(([1.0], actuator), u, time_s)[1]
    eta = np.array([kept_back, 2.0 * np.pi / np.sqrt(w2), zeta, d])
    found = SwingingLoad().apply(eta, time_s, still, sizes_of("oscillator"))
    assert 0.0 < kept_back < 0.5
    np.testing.assert_allclose(found, truth, atol=2e-4 * np.ptp(truth))


def test_without_a_share_and_a_rate_nothing_swings() -> None:
    y = np.sin(np.arange(50.0))
    none = np.array([0.0, 0.4, 0.1, 0.0])
    found = SwingingLoad().apply(none, 0.01 * np.arange(50.0), y, sizes_of("oscillator"))
    np.testing.assert_array_equal(found, y)


@pytest.mark.parametrize(
    "seed", [981011, *(pytest.param(981012 + k, marks=pytest.mark.slow) for k in range(5))]
)
def test_a_load_that_swings_is_told_and_no_pump(seed: int) -> None:
    """Over a linear actuator, with its period; what it has ring is no steady line."""
    pair = hidden_pair(["swinging_load"], seed=seed, model="oscillator")
    fitted, judge = pair.logs
    found = diagnose(fitted, hold_out=[judge], model="oscillator")
    assert found.verdict is Verdict.UNKNOWN
    assert "a load that swings on the actuator, or a flexible mount of what is read (once in " in (
        found.summary
    )
    assert "pump" not in found.summary
