"""Ageing: the stiffness at rest is a straight line in time."""

from __future__ import annotations

import numpy as np
import pytest
from textbook_effects import oscillation, round_scale, segment

from softid.effects.ageing import Ageing
from softid.models.oscillator import Oscillator


@pytest.mark.parametrize("rate", [0.05, -0.05])
def test_held_level_drifts_as_the_spring_does(rate: float) -> None:
    """x = u/(Q (1 + r t)) without inertia and damping, to 1e-8."""
    time_s = np.arange(1000) * 0.01
    x = oscillation(
        Ageing(), {"r": rate}, segment(time_s, np.full(1000, 0.8)), (0.0, 0.0, 2.0),
        model=Oscillator(order="static"),
    )  # fmt: skip
    np.testing.assert_allclose(x, 0.4 / (1.0 + rate * time_s), atol=1e-8)


def test_bounds_leave_stiffness_to_the_end_of_the_log() -> None:
    """1 + r t > 0 over the whole log at the lower bound."""
    scale = round_scale()
    assert 1.0 + Ageing().parameters(scale)["r"].lower * scale.duration_s > 0.0
