"""When an optimum needs no rival: white residual, and parameters that the log determines."""

from __future__ import annotations

import numpy as np

from softid.fitters.noise_level import at_noise_level
from softid.fitters.objective import Objective
from softid.fitters.problem import Problem
from softid.log import Log
from softid.models.muscle import Muscle
from softid.models.muscle_law import MuscleLaw
from softid.models.second_order import simulate_law

NAMES = ("M", "a1", "b1", "c1", "a2", "b2", "c2")
TRUTH = (3e-3, 0.0143, 3.0, 0.95, 5e-3, 2.0, 0.28)


def problem(*, highest: float = 240.0, sway: float = 0.0) -> Problem:
    """A muscle through random levels up to ``highest`` kPa, with white noise and a slow sway."""
    rng = np.random.default_rng(3)
    time_s = 0.005 * np.arange(6000)
    u = np.repeat(rng.uniform(0.0, highest, 60), 100)
    u[:100] = 0.0
    x = simulate_law(MuscleLaw(np.array(TRUTH)), time_s, u, None, derivatives=False).x
    x += 0.2 * rng.standard_normal(x.size) + sway * np.sin(0.7 * time_s)
    log = Log.from_arrays(
        time_s,
        {"pressure": u, "contraction": x},
        outputs=("contraction",),
        units={"contraction": "mm"},
    )
    model = Muscle()
    return Problem(model, model.parameters(), [log])


def verdict(of: Problem) -> bool:
    z = of.unknowns(dict(zip(NAMES, TRUTH, strict=True)))
    return at_noise_level(of, Objective(of, {"contraction": 1.0}).solve(z, 60))


def test_a_right_model_under_white_noise_is_at_the_noise_level() -> None:
    """By construction the truth leaves white noise, and sixty levels show every parameter."""
    assert verdict(problem())


def test_structure_of_a_tenth_of_the_noise_is_noticed() -> None:
    """A sway of 0.1 mm has an eighth of the noise's power: n Σρ² is about 6000 · 20/81, not 20."""
    assert not verdict(problem(sway=0.1))


def test_a_parameter_that_the_log_does_not_show_is_noticed() -> None:
    """Below 20 kPa neither the saturation a1 nor the growth of the damping acts on the motion."""
    assert not verdict(problem(highest=20.0))
