"""Plots of the fit of an extended model."""

from __future__ import annotations

import numpy as np
from diagnosis_rig import MUSCLE, extended, fitted
from muscle_rig import THETA

from softid.plots.curves import common_zero, damping_curve, static_curve
from softid.plots.gallery import PER_OUTPUT, Subject, scored


def subject() -> Subject:
    """A fit with hysteresis, hidden and fitted."""
    result = fitted("hysteresis", "hysteresis")
    return Subject(result, extended("hysteresis"), "angle", scored(result))


def test_every_plot_is_drawn() -> None:
    """Effects take no plot away: the log has levels, cycles, residuals, and the muscle has N(p)."""
    one = subject()
    drawn = {kind for kind, draw in PER_OUTPUT.items() if draw(one) is not None}
    assert drawn >= {"static_curve", "damping", "loops", "residual_scatter"}


def test_damping_is_that_of_the_muscle() -> None:
    """N(p) takes the muscle's own parameters, whatever follows them."""
    one = subject()
    curve = damping_curve(MUSCLE, one.result)
    theta = np.array([p.value for p in one.result.parameters])[: THETA.size]
    np.testing.assert_allclose(curve.value, MUSCLE.damping_curve(theta, curve.input), rtol=1e-12)


def test_static_curve_has_the_effects() -> None:
    """The static curve is the extended model's own, moved by the common zero."""
    one = subject()
    curve = static_curve(one.model, one.result, "angle")
    theta = np.array([p.value for p in one.result.parameters])
    own = one.model.static_output(theta, curve.input, "angle")
    moved = own + common_zero(one.result, "angle")
    np.testing.assert_allclose(curve.value, moved, rtol=1e-12, atol=1e-12)
