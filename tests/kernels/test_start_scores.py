"""Products by which many starts are scored in one pass."""

from __future__ import annotations

import numpy as np

from softid.models.division import undivided
from softid.models.muscle import MuscleLaw
from softid.models.second_order import simulate_law
from softid.models.starts import Stretch, scores

THETAS = [
    np.array([0.0, 1.0, 2.2, 30.0, 0.0, 0.0, 6.0]),
    np.array([0.02, 1.0, 3.0, 60.0, 0.1, 1.5, 4.0]),
    np.array([0.0, 1.0, 2.2, np.inf, 0.0, 0.0, 6.0]),
]


def test_it_is_the_regression_on_each_motion() -> None:
    """Residual squares and gain of the line through both, by `numpy.polyfit`; inf without one."""
    rng = np.random.default_rng(1)
    time_s = 0.01 * np.arange(400)
    u = 100.0 + 80.0 * np.sin(2.0 * time_s)
    y = 3.0 * simulate_law(MuscleLaw(THETAS[1]), time_s, u, None, derivatives=False).x
    y += 0.05 * rng.standard_normal(y.size)
    used = rng.random(y.size) < 0.9
    found = scores([Stretch(time_s, u, y, used)], MuscleLaw, THETAS)
    for (squares, gain), theta in zip(found[:2], THETAS, strict=False):
        law, plan = MuscleLaw(theta), undivided(time_s, u)
        x = simulate_law(law, time_s, u, None, derivatives=False, plan=plan).x[used]
        slope, level = np.polyfit(x, y[used], 1)
        left = y[used] - slope * x - level
        np.testing.assert_allclose((squares, gain), (left @ left, slope), rtol=1e-6)
    assert found[2][0] == np.inf
