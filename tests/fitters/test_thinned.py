"""A problem over block averages that leads the fit of a long log to its basin."""

from __future__ import annotations

import threading
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from softid.fitters import thinned
from softid.fitters.multiple_shooting import PiecewiseProblem
from softid.fitters.objective import Objective
from softid.fitters.output_error import output_error
from softid.fitters.problem import Problem
from softid.fitters.thinned import (
    KEPT_RESIDUALS,
    LONGEST_BLOCK,
    MOST_PER_LOG,
    MOST_WINDOWED,
    WINDOWED,
    WarmStart,
    averaged,
    rough_problem,
    thinning,
    warm_start,
    warm_starts,
    windows_of,
)
from softid.log import Log
from softid.models.muscle import Muscle
from softid.models.muscle_law import NAMES
from softid.parallel import sharing
from softid.synthesis import muscle_log, random_muscle_truth
from softid.synthesis.waveforms import Steps

Array = npt.NDArray[np.float64]

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
    (segment,), (full,) = averaged(whole, 4).segments, whole.segments
    count = len(log) // 4
    means = full.input[: 4 * count].reshape(count, 4).mean(axis=1)
    np.testing.assert_allclose(segment.input, means, rtol=1e-14)
    assert np.flatnonzero(~segment.used["contraction"]).tolist() == [2]
    assert averaged(whole, 4).size == whole.size


def test_short_problems_stay_whole() -> None:
    """Up to twice the samples that are left, and where a segment would lose its transients."""
    log = staircase(100.0)
    assert len(log) < 2 * KEPT_RESIDUALS
    assert thinning(problem_of(log)) == 1
    long = problem_of(staircase(1000.0))
    assert thinning(long) == long.n_samples // KEPT_RESIDUALS > 1
    longer = problem_of(staircase(4000.0))
    assert thinning(longer) == LONGEST_BLOCK < longer.n_samples // KEPT_RESIDUALS
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


def steps_every(hold_s: float) -> Log:
    """28,000 samples of a fast muscle at 1 kHz, if it is 0.2 s."""
    made = muscle_log(FAST, Steps(LEVELS * 20, hold_s), noise_mm=0.3, rate_hz=1000.0)
    return made.to_log()


FAST = {"M": 1e-4, "a1": 0.014, "b1": 3.0, "c1": 1.0, "a2": 1e-3, "b2": 2.0, "c2": 0.1}


def test_a_false_optimum_of_windows_is_not_followed_over_all_samples() -> None:
    """From far too large a mass, hardly damped, windows lead to a false optimum.

    The start behind it leads to white noise, so that the one behind that is not asked.
    """
    problem = problem_of(steps_every(0.2))
    far = problem.unknowns(FAST | {"M": 3.0, "a2": 1e-9, "b2": 9.0})
    near = problem.unknowns({name: 1.3 * value for name, value in FAST.items()})
    starts = [far, near, near.copy(), far.copy()]
    windows = rough_problem(problem, near)
    assert isinstance(windows, PiecewiseProblem)
    found = warm_starts(Objective(problem, {"contraction": 1.0}), starts, windows, 60)
    assert {id(warm.start) for warm in found} == {id(start) for start in starts[:3]}
    assert [warm.is_white for warm in found] == [True, True, False]
    assert found[2].cost > 1.1 * found[0].cost
    alone = warm_starts(Objective(problem, {"contraction": 1.0}), starts[1:], windows, 60)
    assert [id(warm.start) for warm in alone] == [id(near)]
    whole = output_error(problem, [problem.values(s) for s in starts], rng=np.random.default_rng(0))
    assert whole.start.tolist() != far.tolist()
    assert whole.status.success


@pytest.mark.parametrize("cores", [1, 2])
def test_starts_go_through_windows_on_no_more_cores_than_there_are(
    monkeypatch: pytest.MonkeyPatch, cores: int
) -> None:
    """Two at a time where a process may use two cores, by its own thread where it has one."""
    problem = problem_of(steps_every(0.2))
    near = problem.unknowns({name: 1.3 * value for name, value in FAST.items()})
    windows = rough_problem(problem, near)
    assert windows is not None
    threads: list[int] = []

    def nowhere(objective: Objective, start: Array, *_: object) -> WarmStart:
        threads.append(threading.get_ident())
        return WarmStart(start, start)

    monkeypatch.setattr(sharing, "usable_cores", lambda: cores)
    monkeypatch.setattr(thinned, "warm_start", nowhere)
    starts = [near.copy() for _ in range(3)]
    found = warm_starts(Objective(problem, {"contraction": 1.0}), starts, windows, 9)
    assert len(found) == len(threads) == 3
    assert threads[0] == threading.get_ident()
    assert (set(threads) == {threading.get_ident()}) is (cores == 1)


def test_several_logs_are_led_by_windows_of_those_that_move_most() -> None:
    """Six logs, the first with a tenth of the range: some of the others have a window each.

    A log without one has no zero there. The optimum is that of a search that began at the truth.
    """
    log, model = steps_every(0.2), Muscle()
    begins_s = (0.0, 4.0, 8.0, 12.0, 16.0)
    logs = [replace(log.between(s, s + 7.0), name=f"from {s} s") for s in begins_s]
    gentle = muscle_log(FAST, Steps((0.0, 30.0) * 16, 0.2), noise_mm=0.3, rate_hz=1000.0)
    still = replace(gentle.to_log(), name="still")
    problem = Problem(model, model.parameters(), [still, *logs])
    windows = rough_problem(problem, problem.unknowns(FAST))
    assert isinstance(windows, PiecewiseProblem)
    assert 1 < len(windows.segments) == len(windows.logs) <= MOST_WINDOWED
    assert still.name not in {one.name for one in windows.logs}
    assert windows.n_samples == pytest.approx(WINDOWED, abs=MOST_WINDOWED)
    starts = [guess.values_dict() for guess in model.guess(problem.segments, "contraction")]
    found = output_error(problem, starts, rng=np.random.default_rng(0))
    best = Objective(problem, found.sigma).solve(problem.unknowns(FAST), 400)
    assert found.cost == pytest.approx(best.normal.cost, rel=1e-6)


def test_a_fast_motion_is_led_through_windows() -> None:
    """A log of 28,000 samples that steps every 0.2 s; a slow start goes through blocks.

    One window of 2,500 samples holds the range of the input, and leads to a hundredth of the
    start's cost.
    """
    problem = problem_of(steps_every(0.2))
    start = problem.unknowns({name: 1.3 * value for name, value in FAST.items()})
    windows = rough_problem(problem, start)
    assert isinstance(windows, PiecewiseProblem)
    assert [s.time_s.size for s in windows.segments] == [WINDOWED]
    objective = Objective(problem, {"contraction": 1.0})
    reached = warm_start(objective, start, windows, 30).point
    assert objective(reached).cost < 0.01 * objective(start).cost
    slow = problem.unknowns(FAST | {"c2": 30.0})
    blocks = rough_problem(problem, slow)
    assert blocks is not None
    sizes = [s.time_s.size for s in averaged(problem, thinning(problem)).segments]
    assert [s.time_s.size for s in blocks.segments] == sizes


def test_two_windows_lead_where_the_middle_rests() -> None:
    """The middle third holds the lowest level; the begin and the end cover the whole range."""
    levels = LEVELS * 6 + (0.0,) * 42 + LEVELS * 6
    made = muscle_log(FAST, Steps(levels, 0.2), noise_mm=0.3, rate_hz=1000.0)
    problem = problem_of(made.to_log())
    windows = rough_problem(problem, problem.unknowns(FAST))
    assert isinstance(windows, PiecewiseProblem)
    assert [s.time_s.size for s in windows.segments] == [WINDOWED // MOST_PER_LOG] * MOST_PER_LOG
    assert [s.index for s in windows.segments] == [0, 0]


def test_affine_windows_begin_with_the_best_states_from_anywhere() -> None:
    """Zero and initial states stand linearly: one evaluation finds them from 0 as from the data."""
    problem = problem_of(staircase(1000.0))
    windows = windows_of(problem)
    objective = Objective(windows, {"contraction": 1.0})
    plain, measured = windows.free_unknowns(TRUTH), windows.started(TRUTH)
    found, known = (windows.with_best_states(objective(z)) for z in (plain, measured))
    np.testing.assert_allclose(found, known, rtol=1e-7, atol=1e-7)
