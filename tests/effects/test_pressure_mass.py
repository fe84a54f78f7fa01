"""Pressure mass: the natural frequency goes by the input."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from textbook_effects import oscillation, round_scale, segment

from softid.effects.pressure_mass import PressureMass


@pytest.mark.parametrize(("m", "u"), [(0.8, 1.0), (-0.6, 1.0), (0.8, 0.0)])
def test_free_oscillation_has_the_frequency_of_its_mass(m: float, u: float) -> None:
    """x = u/Q + A cos(ω t) with ω² = Q/(M (1 + m u)), to 1e-3 A after 2 s."""
    mass, spring, amplitude = 0.02, 2.0, 0.1
    time_s = np.arange(400) * 0.005
    x = oscillation(
        PressureMass(), {"m": m}, segment(time_s, np.full(400, u)), (mass, 0.0, spring),
        start=(u / spring + amplitude, 0.0),
    )  # fmt: skip
    frequency = np.sqrt(spring / (mass * (1.0 + m * u)))
    expected = u / spring + amplitude * np.cos(frequency * time_s)
    np.testing.assert_allclose(x, expected, atol=1e-3 * amplitude)


@pytest.mark.parametrize(("low", "high"), [(0.0, 200.0), (-30.0, 50.0), (-80.0, -10.0), (-0.1, 9)])
def test_bounds_keep_the_inertia_positive(low: float, high: float) -> None:
    """1 + m u > 0 at both ends of the input's range, for every m between the bounds."""
    scale = replace(round_scale(), u_low=low, u_high=high)
    m = PressureMass().parameters(scale)["m"]
    assert m.lower < 0.0 < m.upper
    for bound in (m.lower, m.upper):
        assert min(1.0 + bound * low, 1.0 + bound * high) > 0.0
