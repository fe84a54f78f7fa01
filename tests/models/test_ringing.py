"""Weak-form starts of a muscle that rings: near the truth although nothing was simulated."""

from __future__ import annotations

import numpy as np
import pytest

from softid.log import Log
from softid.models.muscle import Muscle
from softid.simulation import simulate

TRUTH = {"M": 0.02, "a1": 0.01, "b1": 2.0, "c1": 0.1, "a2": 1e-9, "b2": 0.0, "c2": 0.01}


def log(c2: float, *, noise: float = 0.2, constant: bool = False) -> Log:
    """Steps at 50 Hz, sensor zero 3 mm, noise of 0.2 % of the range."""
    time_s = np.arange(1200) * 0.02
    pressure = np.repeat([0.0, 90.0, 200.0, 60.0, 150.0, 30.0], 200)
    if constant:
        pressure = np.full(time_s.size, 50.0)
    channels = {"pressure": pressure, "contraction": time_s}
    blank = Log.from_arrays(time_s, channels, outputs=("contraction",))
    y = simulate(Muscle(), TRUTH | {"c2": c2}, blank).outputs["contraction"] + 3.0
    y = y + noise * np.random.default_rng(1).standard_normal(y.size)
    return Log.from_arrays(time_s, channels | {"contraction": y}, outputs=("contraction",))


def test_frequency_and_damping_are_near_the_truth() -> None:
    """b1 within 15 % (the grid's step is 38 %), √(c1/M) within 10 %, c2/M within 30 %."""
    best = Muscle().ringing(log(0.01).segments(), "contraction")[0].values_dict()
    assert best["b1"] == pytest.approx(TRUTH["b1"], rel=0.15)
    omega = (best["c1"] / best["M"]) ** 0.5
    assert omega == pytest.approx((TRUTH["c1"] / TRUTH["M"]) ** 0.5, rel=0.1)
    assert best["c2"] / best["M"] == pytest.approx(TRUTH["c2"] / TRUTH["M"], rel=0.3)


@pytest.mark.parametrize("order", ["first", "static"])
def test_nothing_rings_without_inertia(order) -> None:
    """The limits have no M, so there is nothing to offer."""
    assert Muscle(order=order).ringing(log(0.01).segments(), "contraction") == ()


def test_a_constant_pressure_offers_nothing() -> None:
    """A range of zero has no steepness."""
    assert Muscle().ringing(log(0.01, constant=True).segments(), "contraction") == ()


def test_alternatives_keep_curve_and_speed() -> None:
    """At the midpoint, where b1·p = log(c1/a1), the damping is the same in all three forms."""
    values = TRUTH | {"a2": 0.004, "b2": 1.0}
    middle = np.log(values["c1"] / values["a1"]) / values["b1"]
    wanted = values["a2"] * np.exp(middle) + values["c2"]
    shapes = Muscle().alternatives(values)
    assert sorted(np.sign(s["b2"].value) for s in shapes) == [-1.0, 0.0, 1.0]
    for shape in shapes:
        v = shape.values_dict()
        assert [v[n] for n in ("M", "a1", "b1", "c1")] == pytest.approx(
            [values[n] for n in ("M", "a1", "b1", "c1")]
        )
        damping = v["a2"] * np.exp(v["b2"] * middle) + v["c2"]
        assert damping == pytest.approx(wanted, rel=2e-3)
