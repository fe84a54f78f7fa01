"""Contact: two springs in turn, with a rounded corner, on either side."""

from __future__ import annotations

import numpy as np
import pytest
from textbook_effects import round_scale, settled

from softid.effects.contact import Contact, LowerContact

VALUES = {"kw": 6.0, "xw": 0.3}


def test_two_straight_branches_at_rest() -> None:
    """x = u/Q below, (u + kw xw)/(Q + kw) above: the corner has gone 20 widths away, to 1e-8."""
    low, high = np.array([0.0, 0.2, 0.39]), np.array([1.5, 3.0, 9.0])
    below = settled(Contact(), VALUES, low, 2.0)
    above = settled(Contact(), VALUES, high, 2.0)
    np.testing.assert_allclose(below, low / 2.0, atol=1e-8)
    np.testing.assert_allclose(above, (high + 6.0 * 0.3) / 8.0, atol=1e-8)


def test_force_at_the_corner() -> None:
    """At x = xw the softplus is w ln 2, with w = 1 % of the range 0.5 over 1 + kw/Q."""
    scale = round_scale()
    width = 0.005 / (1.0 + 6.0 * scale.x_span / scale.force)
    u = np.array([2.0 * 0.3 + 6.0 * width * np.log(2.0)])
    np.testing.assert_allclose(settled(Contact(), VALUES, u, 2.0), 0.3, atol=1e-10)


def test_a_wall_is_felt_at_the_wall() -> None:
    """By hand, for a wall at 0.3 a hundred times as stiff as the actuator, and a drive to 0.29.

    It lies 200 widths ahead, so nothing is felt; a corner of 1 % of the range, two widths ahead,
    would push back with 200·0.005·ln(1 + e⁻²) = 0.13, a fifth of the drive. A drive to 0.45 ends
    at (u + kw xw)/(Q + kw), without a trace of the corner.
    """
    scale = round_scale()
    stiff = 100.0 * scale.force / scale.x_span
    u = np.array([2.0 * 0.29, 2.0 * 0.45])
    before, behind = settled(Contact(), {"kw": stiff, "xw": 0.3}, u, 2.0)
    assert before == pytest.approx(0.29, abs=1e-3 * scale.x_span)
    assert behind == pytest.approx((u[1] + stiff * 0.3) / (stiff + 2.0), abs=1e-6)


def test_nothing_overflows_far_from_the_obstacle() -> None:
    """Thousands of widths on either side give the straight branches, not infinity."""
    found = settled(Contact(), VALUES, np.array([-100.0, 40.0]), 2.0)
    np.testing.assert_allclose(found, [-50.0, (40.0 + 1.8) / 8.0], rtol=1e-10)


def test_an_obstacle_below_is_one_above_upside_down() -> None:
    """x → −x, u → −u and xw → −xw leave the equation of motion as it is."""
    scale = round_scale()
    u = np.linspace(-2.0, 2.0, 9)
    below = settled(LowerContact(), {"kw": 6.0, "xw": -0.3}, u, 2.0)
    np.testing.assert_allclose(below, -settled(Contact(), VALUES, -u, 2.0), atol=1e-12)
    assert scale.x_low <= LowerContact().starts(scale)[-1]["xw"] < scale.x_low + 0.1 * scale.x_span


def test_an_arm_rests_on_a_table() -> None:
    """By hand: at u = 0 the spring would be at 0, and a hard table at 0.3 holds it there."""
    stiff = {"kw": 100.0 * 2.0, "xw": 0.3}
    (low, high) = settled(LowerContact(), stiff, np.array([0.0, 1.2]), 2.0)
    assert low == pytest.approx(stiff["kw"] * 0.3 / (stiff["kw"] + 2.0), abs=1e-4)
    assert high == pytest.approx(0.6, abs=1e-6)
