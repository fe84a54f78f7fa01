"""Stiffening: the cubic at rest, and the free oscillation of Duffing's spring."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ellipj
from textbook_effects import oscillation, round_scale, segment, settled

from softid.effects.stiffening import Stiffening


@pytest.mark.parametrize("k3", [2.0, -1.0])
def test_position_at_rest_solves_the_cubic(k3: float) -> None:
    """Q x + k3 x³ = u, with u computed from x."""
    x = np.array([0.1, 0.25, 0.4])
    found = settled(Stiffening(), {"k3": k3}, 2.0 * x + k3 * x**3, 2.0)
    np.testing.assert_allclose(found, x, atol=1e-10)


def test_free_oscillation_is_the_elliptic_cosine() -> None:
    """M x'' + Q x + k3 x³ = 0 from (A, 0): x = A cn(Ω t, m), Ω² = (Q + k3 A²)/M, to 2e-4 A.

    m = k3 A²/(2 (Q + k3 A²)); without damping the errors of 2 s of steps add up.
    """
    mass, spring, k3, amplitude = 0.02, 2.0, 10.0, 0.4
    time_s = np.arange(400) * 0.005
    drive = segment(time_s, np.zeros(400))
    found = oscillation(
        Stiffening(), {"k3": k3}, drive, (mass, 0.0, spring), start=(amplitude, 0.0)
    )
    stiff = spring + k3 * amplitude**2
    _, cn, _, _ = ellipj(np.sqrt(stiff / mass) * time_s, k3 * amplitude**2 / (2 * stiff))
    np.testing.assert_allclose(found, amplitude * cn, atol=2e-4 * amplitude)


def test_softest_spring_still_holds() -> None:
    """At the lower bound Q + 3 k3 x² stays positive up to the largest position."""
    scale = round_scale()
    lowest = Stiffening().parameters(scale)["k3"].lower
    assert lowest < 0.0
    assert scale.force / scale.x_span + 3 * lowest * scale.x_high**2 > 0.0
