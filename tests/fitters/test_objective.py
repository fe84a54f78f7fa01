"""Runs over more samples than keep their columns, against runs that keep all."""

from __future__ import annotations

import numpy as np
import pytest

from softid.fitters import objective as module
from softid.fitters.normal_equations import Linearised
from softid.fitters.objective import CHEAP_ENTRIES, RESTING_OFFSET, Objective
from softid.fitters.problem import Problem
from softid.models.muscle import Muscle
from softid.synthesis import muscle_log, random_muscle_truth
from softid.synthesis.waveforms import Steps

LEVELS = (0.0, 60.0, 180.0, 300.0, 210.0, 90.0, 0.0)
TRUTH = random_muscle_truth(np.random.default_rng(1))


def problem_of(levels: tuple[float, ...]) -> Problem:
    noise_mm = 0.005 / TRUTH["a1"]
    made = muscle_log(TRUTH, Steps(levels, 1.5), noise_mm=noise_mm, rate_hz=200.0)
    model = Muscle()
    return Problem(model, model.parameters(), [made.to_log()])


def test_columns_that_are_kept_late_change_no_optimum(monkeypatch: pytest.MonkeyPatch) -> None:
    """Costs agree to 1e-9, as offsets below a thousandth of a standard error do over 6,000 samples,
    and both ends lie within a hundredth of one of each other."""
    problem = problem_of(LEVELS * 3)
    assert problem.n_samples * problem.size > CHEAP_ENTRIES
    start = problem.unknowns({name: 1.4 * value for name, value in TRUTH.items()})
    late = Objective(problem, {"contraction": 1.0})
    found = late.with_columns(late.solve(start, 400))
    monkeypatch.setattr(module, "CHEAP_ENTRIES", 10**9)
    early = Objective(problem, {"contraction": 1.0}).solve(start, 400)
    assert isinstance(found.normal, Linearised)
    assert found.normal.kept
    assert max(found.offset, early.offset) <= RESTING_OFFSET
    assert found.normal.cost == pytest.approx(early.normal.cost, rel=1e-9)
    variance = 2.0 * early.normal.cost / early.normal.n
    errors = np.sqrt(variance * np.diag(np.linalg.inv(early.normal.matrix)))
    np.testing.assert_array_less(np.abs(found.point - early.point), 0.01 * errors)


def test_columns_are_asked_for_once() -> None:
    """An end that keeps them is given back as it is, and one that does not takes one evaluation."""
    problem = problem_of(LEVELS * 3)
    start = problem.unknowns(TRUTH)
    objective = Objective(problem, {"contraction": 1.0})
    rough = objective.solve(start, 2)
    before = objective.evaluations
    kept = objective.with_columns(rough)
    assert objective.evaluations == before + 1
    assert objective.with_columns(kept) is kept
    assert kept.normal.cost <= rough.normal.cost
