"""The static curve: a natural spline, straight through values on a line, level far outside."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline
from textbook_effects import settled

from softid.effects.static_curve import StaticCurve

KNOTS = np.linspace(0.0, 1.0, 6)


def values(shifts: np.ndarray) -> dict[str, float]:
    """Those of the knots behind the first, which is zero."""
    assert shifts[0] == 0.0
    return {f"k{i + 1}": float(shift) for i, shift in enumerate(shifts) if i > 0}


def test_positions_at_rest_go_through_the_knots() -> None:
    """x = u/Q + s(u), and s is scipy's natural cubic spline through the knots, to rounding."""
    shifts = np.array([0.0, -0.01, 0.03, 0.02, -0.04, 0.01])
    u = np.linspace(0.0, 1.0, 41)
    found = settled(StaticCurve(), values(shifts), u, 2.0) - u / 2.0
    np.testing.assert_allclose(found, CubicSpline(KNOTS, shifts, bc_type="natural")(u), atol=1e-10)
    np.testing.assert_allclose(found[::8], shifts, atol=1e-10)


def test_values_on_a_line_make_a_line_that_levels_off() -> None:
    """A natural spline through a line is that line; outside it gains half a knot more at most."""
    found = settled(StaticCurve(), values(0.1 * KNOTS), np.array([0.33, 5.0, -4.0]), 2.0)
    expected = np.array([0.033, 0.1 + 0.1 * 0.1, -0.1 * 0.1])
    np.testing.assert_allclose(found - np.array([0.33, 5.0, -4.0]) / 2.0, expected, atol=1e-9)


def test_smooth_at_the_ends() -> None:
    """Value, slope and curvature meet at both ends: third-order differences stay of one size."""
    effect, h = StaticCurve(), 1e-3
    shifts = values(np.array([0.0, -0.01, 0.03, 0.02, -0.04, 0.01]))
    for end in (0.0, 1.0):
        u = end + h * np.arange(-10, 11)
        bend = np.diff(settled(effect, shifts, u, 2.0) - u / 2.0, 2) / h**2
        assert np.max(np.abs(np.diff(bend))) < 0.2
        assert np.max(np.abs(bend)) < 1.0


def test_vanishes_with_all_its_amplitudes() -> None:
    """The effect is linear in its values, so all are amplitudes; the first knot is no parameter."""
    assert StaticCurve().amplitudes == ("k2", "k3", "k4", "k5", "k6")
