"""Products by which many starts are scored in one pass."""

from __future__ import annotations

import numpy as np

from softid.models.muscle_law import MuscleLaw
from softid.models.second_order import simulate_law
from softid.models.starts import scores
from softid.models.stretches import Stretch

THETAS = [
    np.array([0.0, 1.0, 2.2, 30.0, 0.0, 0.0, 6.0]),
    np.array([0.02, 1.0, 3.0, 60.0, 0.1, 1.5, 4.0]),
    np.array([0.0, 1.0, 2.2, np.inf, 0.0, 0.0, 6.0]),
]


def test_it_is_the_regression_on_each_motion() -> None:
    """Residual squares and gain of the line through both, by `numpy.polyfit`; inf without one.

    The motion is that of the fits' own rule to 1e-3, which the rule of second order misses it by.
    """
    rng = np.random.default_rng(1)
    time_s = 0.01 * np.arange(400)
    u = 100.0 + 80.0 * np.sin(2.0 * time_s)
    y = 3.0 * simulate_law(MuscleLaw(THETAS[1]), time_s, u, None, derivatives=False).x
    y += 0.05 * rng.standard_normal(y.size)
    used = rng.random(y.size) < 0.9
    found = scores([Stretch(time_s, u, y, used)], MuscleLaw, THETAS)
    for (squares, gain), theta in zip(found[:2], THETAS, strict=False):
        x = simulate_law(MuscleLaw(theta), time_s, u, None, derivatives=False).x[used]
        slope, level = np.polyfit(x, y[used], 1)
        left = y[used] - slope * x - level
        np.testing.assert_allclose((squares, gain), (left @ left, slope), rtol=2e-3)
    assert found[2][0] == np.inf


def test_halved_steps_quarter_the_error() -> None:
    """Second order: with half the step the gain errs 3.3 times less, with and without inertia."""
    gains = {}
    for rate in (50, 100, 800):
        time_s = np.arange(4 * rate + 1) / rate
        u = 100.0 + 80.0 * np.sin(4.0 * time_s)
        y = np.sin(4.0 * time_s - 0.3)
        stretch = Stretch(time_s, u, y, np.ones(y.size, bool))
        gains[rate] = np.array([gain for _, gain in scores([stretch], MuscleLaw, THETAS[:2])])
    ratio = (gains[50] - gains[800]) / (gains[100] - gains[800])
    assert np.all(np.abs(ratio) > 3.3)


def test_many_are_scored_as_each_alone() -> None:
    """Eleven sets of parameters, more than fit side by side, to the last digit."""
    rng = np.random.default_rng(2)
    time_s = 0.02 * np.arange(100)
    stretch = Stretch(time_s, 100.0 * rng.random(100), rng.random(100), np.ones(100, bool))
    thetas = np.array(THETAS[1]) * rng.uniform(0.5, 1.5, (11, 7))
    together = scores([stretch], MuscleLaw, thetas)
    assert together == [scores([stretch], MuscleLaw, [theta])[0] for theta in thetas]
