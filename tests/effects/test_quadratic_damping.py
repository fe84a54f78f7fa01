"""Quadratic damping: a body that is pushed steadily comes to its terminal speed."""

from __future__ import annotations

import numpy as np
import pytest
from textbook_effects import oscillation, segment

from softid.effects.quadratic_damping import QuadraticDamping
from softid.models.oscillator import Oscillator


@pytest.mark.parametrize("push", [3.0, -3.0])
def test_fall_to_terminal_speed(push: float) -> None:
    """M v' = F − d2 v|v| from rest: x = ± (M/d2) ln cosh(t √(F d2)/M), to 1e-5 of the way."""
    mass, drag = 0.5, 2.0
    time_s = np.arange(200) * 0.01
    found = oscillation(
        QuadraticDamping(), {"d2": drag}, segment(time_s, np.full(200, push)), (mass, 0.0, 0.0),
        start=(0.0, 0.0), model=Oscillator(spring="none"),
    )  # fmt: skip
    expected = mass / drag * np.log(np.cosh(time_s * np.sqrt(abs(push) * drag) / mass))
    np.testing.assert_allclose(found, np.sign(push) * expected, atol=1e-5 * expected[-1])
