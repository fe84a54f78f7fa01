"""Dead zone of the input."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from muscle_rig import SCALE

from softid.effects.dead_zone import DeadZone

TIME_S = np.linspace(0.0, 1.0, 401)


def test_nothing_below_and_the_rest_above() -> None:
    """Far from the threshold 0 and p − p0; at it w ln 2, for w = softness p0."""
    u = np.linspace(0.0, 100.0, 401)
    found = DeadZone().apply(np.array([20.0, 0.05]), TIME_S, u, SCALE)
    np.testing.assert_allclose(found[u <= 5.0], 0.0, atol=1e-6)
    np.testing.assert_allclose(found[u >= 35.0], u[u >= 35.0] - 20.0, rtol=0.0, atol=1e-6)
    assert found[u == 20.0][0] == pytest.approx(1.0 * np.log(2.0), abs=1e-9)
    assert (np.diff(found) > 0.0).all()


def test_either_sign() -> None:
    """The law is odd: pa(−p) = −pa(p), and nothing arrives at zero."""
    u = np.linspace(-100.0, 100.0, 401)
    found = DeadZone().apply(np.array([20.0, 0.5]), TIME_S, u, SCALE)
    np.testing.assert_allclose(found, -found[::-1], rtol=0.0, atol=1e-12)
    assert found[200] == 0.0


@pytest.mark.parametrize(
    ("low", "high", "largest"), [(0.0, 100.0, 60.0), (50.0, 150.0, 110.0), (-80.0, 100.0, 60.0)]
)
def test_the_threshold_lies_within_the_inputs(low: float, high: float, largest: float) -> None:
    """Up to 0.6 of the way from the input nearest to zero to the farthest one."""
    scale = replace(SCALE, u_low=low, u_high=high)
    declared = DeadZone().parameters(scale)["p0"]
    assert declared.upper == pytest.approx(largest)
    for start in DeadZone().starts(scale):
        assert max(low, 0.0) < start["p0"] < largest
