"""A problem over block averages that leads the fit of a long log to its basin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from softid.fitters import thinned
from softid.fitters.objective import Objective
from softid.fitters.output_error import output_error
from softid.fitters.problem import Problem
from softid.fitters.thinned import (
    LONGEST,
    SAMPLES,
    WINDOWED,
    WINDOWS,
    ThinnedProblem,
    WindowedProblem,
    leads,
    led,
    rough_problem,
    thinning,
)
from softid.log import Log
from softid.models.muscle import Muscle
from softid.models.muscle_law import NAMES
from softid.synthesis import muscle_log, random_muscle_truth
from softid.synthesis.waveforms import Steps

LEVELS = (0.0, 60.0, 180.0, 300.0, 210.0, 90.0, 0.0)
TRUTH = random_muscle_truth(np.random.default_rng(1))


def staircase(rate_hz: float) -> Log:
    noise_mm = 0.005 / TRUTH["a1"]
    made = muscle_log(TRUTH, Steps(LEVELS, 1.5), noise_mm=noise_mm, rate_hz=rate_hz)
    return made.to_log()


def problem_of(log: Log) -> Problem:
    model = Muscle()
    return Problem(model, model.parameters(), [log])


def test_blocks_are_means_and_count_when_all_samples_do() -> None:
    """Means of 4 by numpy; the block of the one masked sample, the eleventh, is left out."""
    log = staircase(100.0)
    left_out = np.zeros(len(log), bool)
    left_out[10] = True
    whole = problem_of(log.with_masked(left_out))
    (segment,), (full,) = ThinnedProblem(whole, 4).segments, whole.segments
    count = len(log) // 4
    means = full.input[: 4 * count].reshape(count, 4).mean(axis=1)
    np.testing.assert_allclose(segment.input, means, rtol=1e-14)
    assert np.flatnonzero(~segment.used["contraction"]).tolist() == [2]
    assert ThinnedProblem(whole, 4).size == whole.size


def test_short_problems_stay_whole() -> None:
    """Up to twice the samples that are left, and where a segment would lose its transients."""
    log = staircase(100.0)
    assert len(log) < 2 * SAMPLES
    assert thinning(problem_of(log)) == 1
    long = problem_of(staircase(1000.0))
    assert thinning(long) == long.n_samples // SAMPLES > 1
    longer = problem_of(staircase(4000.0))
    assert thinning(longer) == LONGEST < longer.n_samples // SAMPLES
    first = long.segments[0]
    long.segments.append(replace(first, time_s=first.time_s[:30]))
    assert thinning(long) == 1


def test_the_optimum_is_that_of_all_samples() -> None:
    """Same cost to 1e-6 as the optimiser started at the truth and run over all samples."""
    problem = problem_of(staircase(1000.0))
    guesses = Muscle().guess(problem.segments, "contraction")
    starts = [guess.values_dict() for guess in guesses]
    found = output_error(problem, starts, rng=np.random.default_rng(0))
    at_truth = problem.unknowns({name: TRUTH[name] for name in NAMES})
    best = Objective(problem, found.sigma).solve(at_truth, 400)
    assert found.status.success
    assert found.cost == pytest.approx(best.normal.cost, rel=1e-6)


FAST = {"M": 1e-4, "a1": 0.014, "b1": 3.0, "c1": 1.0, "a2": 1e-3, "b2": 2.0, "c2": 0.1}


def test_the_best_start_goes_on_where_all_samples_cost_much(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """From far too large a mass, hardly damped, windows lead to a false optimum.

    Of such a start and a near one the near one leads, and nothing is asked of the other.
    """
    made = muscle_log(FAST, Steps(LEVELS * 20, 0.2), noise_mm=0.3, rate_hz=1000.0)
    problem = problem_of(made.to_log())
    far = problem.unknowns(FAST | {"M": 3.0, "a2": 1e-9, "b2": 9.0})
    near = problem.unknowns({name: 1.3 * value for name, value in FAST.items()})
    windows = rough_problem(problem, near)
    assert isinstance(windows, WindowedProblem)
    objective = Objective(problem, {"contraction": 1.0})
    assert leads(objective, [far, near], windows, 60) is None
    monkeypatch.setattr(thinned, "MANY", 8)
    found = leads(objective, [far, near], windows, 60)
    assert found is not None
    assert [lead.start is near for lead in found] == [True, False]
    assert found[1].cost > 1.1 * found[0].cost
    starts = [problem.values(far), problem.values(near)]
    whole = output_error(problem, starts, rng=np.random.default_rng(0))
    assert problem.values(whole.start) == problem.values(near)
    assert whole.status.success


def test_a_fast_motion_is_led_through_windows() -> None:
    """A log of 28,000 samples that steps every 0.2 s; a slow start goes through blocks.

    One window of 2,500 samples holds the range of the input, and leads to a hundredth of the
    start's cost.
    """
    made = muscle_log(FAST, Steps(LEVELS * 20, 0.2), noise_mm=0.3, rate_hz=1000.0)
    problem = problem_of(made.to_log())
    start = problem.unknowns({name: 1.3 * value for name, value in FAST.items()})
    windows = rough_problem(problem, start)
    assert isinstance(windows, WindowedProblem)
    assert [s.time_s.size for s in windows.segments] == [WINDOWED]
    objective = Objective(problem, {"contraction": 1.0})
    reached = led(objective, start, windows, 30).point
    assert objective(reached).cost < 0.01 * objective(start).cost
    slow = problem.unknowns(FAST | {"c2": 30.0})
    assert isinstance(rough_problem(problem, slow), ThinnedProblem)


def test_two_windows_lead_where_the_middle_rests() -> None:
    """The middle third holds the lowest level; the begin and the end cover the whole range."""
    levels = LEVELS * 6 + (0.0,) * 42 + LEVELS * 6
    made = muscle_log(FAST, Steps(levels, 0.2), noise_mm=0.3, rate_hz=1000.0)
    problem = problem_of(made.to_log())
    windows = rough_problem(problem, problem.unknowns(FAST))
    assert isinstance(windows, WindowedProblem)
    assert [s.time_s.size for s in windows.segments] == [WINDOWED // WINDOWS] * WINDOWS
    assert [s.index for s in windows.segments] == [0, 0]


def test_affine_windows_begin_with_the_best_states_from_anywhere() -> None:
    """Zero and initial states stand linearly: one evaluation finds them from 0 as from the data."""
    problem = problem_of(staircase(1000.0))
    windows = WindowedProblem(problem)
    objective = Objective(windows, {"contraction": 1.0})
    plain, measured = windows.free_unknowns(TRUTH), windows.started(TRUTH)
    found, known = (windows.with_best_states(objective(z)) for z in (plain, measured))
    np.testing.assert_allclose(found, known, rtol=1e-7, atol=1e-7)
