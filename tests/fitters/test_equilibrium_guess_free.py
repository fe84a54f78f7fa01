"""Fits of drawn bending actuators without any start value."""

from __future__ import annotations

from math import exp, log

import numpy as np
import pytest

from softid.fitters.output_error import Objective, output_error
from softid.fitters.problem import Problem
from softid.log import Log
from softid.models.equilibrium import NAMES, Equilibrium

MODEL = Equilibrium()
TIME_S = np.arange(1001) / 200.0


def drawn_truth(rng: np.random.Generator, level_kpa: float) -> dict[str, float]:
    """Stiffness 0.6–2.5, C_m 0.4–4 at rest and bent both ways, damping ratio 0.02–0.7."""
    scale, c = exp(rng.uniform(log(0.6), log(2.5))), exp(rng.uniform(log(0.4), log(4.0)))
    ratio = exp(rng.uniform(log(0.02), log(0.7)))
    b, a = rng.uniform(-0.5, 0.5) * c, rng.uniform(0.0, 0.5) * c
    truth = dict.fromkeys(NAMES, 0.0) | {"C_d": 1.0, "a": a, "b": b, "c": c, "drive": 1.0}
    truth["stiffness"] = scale
    found = MODEL.derived(truth, (0.0, level_kpa))
    at_one = next(v for name, (v, _) in found.items() if name.startswith("damping_ratio"))
    return truth | {"C_d": ratio / at_one}


def arrives(seed: int) -> bool:
    """CONVERGED at a cost within 1e-4 of that reached from the truth: two steps, 0.3° of noise."""
    rng = np.random.default_rng(seed)
    levels = (rng.uniform(8.0, 35.0), -rng.uniform(8.0, 35.0))
    truth = drawn_truth(rng, levels[0])
    theta = np.array([truth[name] for name in NAMES])
    logs = []
    for k, level in enumerate(levels):
        pressure = level * (1.0 - np.exp(-np.maximum(TIME_S - 0.5, 0.0) / 0.03))
        blank = Log.from_arrays(TIME_S, {"pressure": pressure, "angle": TIME_S}).segments()[0]
        response = MODEL.response(theta, blank, ("angle",), start=None, derivatives=False)
        noise = np.deg2rad(0.3) * rng.standard_normal(TIME_S.size)
        angle = response.outputs["angle"] + noise + 0.05
        logs.append(Log.from_arrays(TIME_S, {"pressure": pressure, "angle": angle}, name=f"{k}"))
    segments = [segment for made in logs for segment in made.segments()]
    starts = [guess.values_dict() for guess in MODEL.guess(segments, "angle")]
    problem = Problem(MODEL, MODEL.parameters(), logs)
    found = output_error(problem, starts, rng=np.random.default_rng(0))
    known = Objective(problem, found.sigma).solve(problem.unknowns(truth), 400)
    return found.status.success and found.cost <= known.normal.cost * (1 + 1e-4)


@pytest.mark.parametrize("seed", [500, 510])
def test_an_actuator_needs_no_start(seed: int) -> None:
    """Two of the thirty below."""
    assert arrives(seed)


@pytest.mark.slow
def test_actuators_need_no_start() -> None:
    """At least 29 of 30 drawn actuators reach the optimum that a start at the truth gives."""
    lost = [seed for seed in range(500, 530) if not arrives(seed)]
    assert len(lost) <= 1, lost
