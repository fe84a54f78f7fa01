"""What is held out, and the error on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import RATE_HZ, TRUTH, linear_angle, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import (
    HeldOutBlocks,
    HeldOutErrors,
    HeldOutLogs,
    hold_out_blocks,
)
from softid.fitters.output_error import Optimum, refit_nuisance
from softid.fitters.problem import Problem
from softid.intersample import Intersample
from softid.log import Log, LogSet

Array = npt.NDArray[np.float64]


def driven(pressure: Array, name: str = "log") -> Log:
    time_s = np.arange(pressure.size) / RATE_HZ
    channels = {"pressure": pressure, "angle": linear_angle(time_s, pressure)}
    return Log.from_arrays(time_s, channels, name=name)


def with_angle(log: Log, angle: Array) -> Log:
    channel = replace(log.channels["angle"], values=angle)
    return replace(log, channels=dict(log.channels) | {"angle": channel})


@pytest.mark.parametrize("samples", [30, 101, 1000, 2503])
def test_blocks_of_a_log(samples: int) -> None:
    """Five pieces of 4 %, none in the first tenth, where the rest covers every input."""
    pressure = 50.0 + 50.0 * np.sin(np.arange(samples))
    pressure[: samples // 10 + 2 : 2], pressure[1 : samples // 10 + 2 : 2] = -1.0, 101.0
    trained, held = hold_out_blocks(LogSet((driven(pressure),)))
    (block,) = held.blocks
    assert not block[: samples // 10].any()
    assert np.count_nonzero(np.diff(block.astype(int)) == 1) == 5
    assert block.sum() == 5 * max(samples // 25, 1)
    assert np.array_equal(trained.logs[0].masked, block)
    assert held.whole[0].masked is not None
    assert not held.whole[0].masked.any()


@pytest.mark.parametrize("samples", [2, 3, 4, 5, 9])
def test_nothing_is_held_out_of_a_log_that_is_hardly_more_than_its_blocks(samples: int) -> None:
    """Five blocks of a sample each would cover the shortest; the long log beside it has its own."""
    short = driven(np.linspace(0.0, 50.0, samples), name="short")
    _, held = hold_out_blocks(LogSet((linear_log(), short)))
    of_long, of_short = held.blocks
    assert of_long.sum() == len(linear_log()) // 5
    assert not of_short.any()


def test_blocks_stay_within_what_the_rest_covers() -> None:
    """A ramp ends in its last block: beyond what was fitted, nothing may judge."""
    pressure = np.linspace(0.0, 100.0, 1000)
    pressure[990:] = np.linspace(100.0, 150.0, 10)
    pressure[920:940] += 300.0
    trained, held = hold_out_blocks(LogSet((driven(pressure),)))
    (log,), (block,) = trained.logs, held.blocks
    assert block.any()
    assert not block[920:940].any()
    assert log.masked is not None
    kept = pressure[~log.masked]
    assert kept.min() <= pressure[block].min()
    assert pressure[block].max() <= kept.max()


def test_no_block_begins_after_a_gap() -> None:
    """The state after a gap is found from what follows it, so that is fitted.

    Gaps of five seconds where the five blocks of a whole log begin.
    """
    _, held = hold_out_blocks(LogSet((linear_log(),)))
    begins = np.flatnonzero(np.diff(held.blocks[0].astype(int)) == 1) + 1
    time_s = linear_log().time_s.copy()
    for begin in begins:
        time_s[begin:] += 5.0
    _, held = hold_out_blocks(LogSet((replace(linear_log(), time_s=time_s),)))
    (block,) = held.blocks
    for begin in begins:
        assert not block[begin : begin + 40].any()


def test_what_was_masked_stays_masked() -> None:
    """The fit leaves out both; what judges leaves out what was masked before."""
    log = linear_log()
    masked = np.zeros(len(log), bool)
    masked[180:210] = True
    trained, held = hold_out_blocks(LogSet((log.with_masked(masked),)))
    assert trained.logs[0].masked is not None
    assert trained.logs[0].masked[180:210].all()
    assert np.array_equal(trained.logs[0].masked, masked | held.blocks[0])
    problem = linear_problem(trained.logs)
    ((_, _, measured, residual),) = held.errors(standing(problem, problem.unknowns(TRUTH)))
    assert measured.size == residual.size == np.count_nonzero(held.blocks[0] & ~masked)


def test_errors_in_blocks() -> None:
    """Known truth: the model is exact but for 0.3 rad that stand on the held-out samples alone.

    The sensor's zero of 0.5 rad is known from the rest.
    """
    log = linear_log(added=0.5)
    _, held = hold_out_blocks(LogSet((log,)))
    angle = log.channels["angle"].values + np.where(held.blocks[0], 0.3, 0.0)
    trained, held = hold_out_blocks(LogSet((with_angle(log, angle),)))
    problem = linear_problem(trained.logs)
    candidate = standing(problem, problem.unknowns(TRUTH))
    ((name, channel, measured, residual),) = held.errors(candidate)
    assert (name, channel) == (log.name, "angle")
    assert measured == pytest.approx(angle[held.blocks[0]])
    assert residual == pytest.approx(np.full(residual.size, 0.3), abs=1e-6)
    assert held.rms(candidate) == pytest.approx(0.3, abs=1e-6)


def test_errors_on_held_out_logs() -> None:
    """Known truth: the log's own zero is found, so an offset is no error, and noise is.

    1000 samples of noise of 0.02 rad have an rms within four times 2.2 % of it.
    """
    fitted, other = linear_log(), linear_log(noise=0.02, seed=3, added=0.5)
    problem = linear_problem([fitted])
    held = HeldOutLogs((other,))
    candidate = standing(problem, problem.unknowns(TRUTH))
    ((name, _, measured, residual),) = held.errors(candidate)
    assert name == other.name
    assert np.array_equal(measured, other.channels["angle"].values)
    assert held.rms(candidate) == pytest.approx(0.02, rel=0.09)
    assert abs(float(np.mean(residual))) < 1e-6


def test_zeros_of_what_is_held_out_are_found_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """However often a model is judged; another model has zeros of its own."""
    problem = linear_problem([linear_log()])
    held = HeldOutLogs((linear_log(noise=0.02, seed=3, added=0.5),))
    one, other = (standing(problem, problem.unknowns(TRUTH)) for _ in range(2))
    found: list[Problem] = []

    def counted(asked: Problem) -> Optimum:
        found.append(asked)
        return refit_nuisance(asked)

    monkeypatch.setattr("softid.diagnosis.refit.held_out.refit_nuisance", counted)
    assert held.rms(one) == held.rms(one)
    assert held.errors(one)
    assert held.slopes(one).size
    assert len(found) == 1
    held.rms(other)
    assert len(found) == 2


def test_beyond_the_fitted_range_nothing_judges() -> None:
    """Errors of 0.5 rad above 60 kPa, the largest input that was fitted, and 0.01 rad below.

    The list of errors has them all.
    """
    time_s = np.arange(1000) / RATE_HZ
    fitted = driven(30.0 + 30.0 * np.sin(time_s))
    higher = driven(50.0 + 50.0 * np.sin(time_s), name="higher")
    beyond = higher.pressure_kpa > 60.0
    rng = np.random.default_rng(0)
    noise = np.where(beyond, 0.5, 0.01) * rng.standard_normal(time_s.size)
    judge = with_angle(higher, higher.channels["angle"].values + noise)
    problem = linear_problem([fitted])
    held = HeldOutLogs((judge,))
    candidate = standing(problem, problem.unknowns(TRUTH))
    ((_, _, _, residual),) = held.errors(candidate)
    assert residual.size == time_s.size
    assert held.rms(candidate) < 0.1 < np.sqrt(np.mean(residual**2))


def test_the_parameters_are_not_fitted_to_what_judges() -> None:
    """An actuator that is twice as stiff misses by what the formula says, whatever the zero."""
    log = linear_log()
    stiff = with_angle(log, 0.5 * log.channels["angle"].values)
    problem = linear_problem([log])
    candidate = standing(problem, problem.unknowns(TRUTH))
    wanted = float(np.std(0.5 * log.channels["angle"].values))
    held = HeldOutLogs((replace(stiff, name="stiff"),))
    assert held.rms(candidate) == pytest.approx(wanted, rel=1e-3)


def test_a_drift_in_the_first_rest_leaves_a_judge() -> None:
    """A mask may change what counts as a rest at the start; the blocks judge all the same.

    The output creeps by just over 0.5 % of its span until the input moves, and the held-out block
    at the end of that rest takes just enough of it away.
    """
    time_s = np.arange(2000) / RATE_HZ
    pressure = np.where(time_s < 12.06, 0.0, 50.0 + 20.0 * np.sin(time_s))
    log = driven(pressure)
    span = float(np.ptp(log.channels["angle"].values))
    creep = np.where(time_s < 12.06, 0.00517 * span * time_s / 12.06, 0.0)
    trained, held = hold_out_blocks(
        LogSet((with_angle(log, log.channels["angle"].values + creep),))
    )
    problem = linear_problem(trained.logs)
    assert problem.at_rest == [True]
    assert linear_problem(held.whole).at_rest == [False]
    candidate = standing(problem, problem.unknowns(TRUTH))
    assert 0.0 < held.rms(candidate) < 0.03 * span


def test_nothing_held_out_has_no_error() -> None:
    """Not a number rather than a perfect zero."""
    log = linear_log()
    problem = linear_problem([log])
    nothing = HeldOutBlocks((log,), (np.zeros(len(log), bool),))
    assert np.isnan(nothing.rms(standing(problem, problem.unknowns(TRUTH))))


class RunningAway(HeldOutLogs):
    """Logs on which every model diverges."""

    def judging(self, candidate: Candidate) -> list[HeldOutErrors]:
        """The errors, of which the last are not finite."""
        rows = super().judging(candidate)
        for row in rows:
            row.residual[-9:] = np.nan
        return rows


def test_what_runs_away_on_what_is_held_out_is_worse_than_all_else() -> None:
    """An infinite error rather than none, which nothing would be worse than."""
    problem = linear_problem([linear_log()])
    model = standing(problem, problem.unknowns(TRUTH))
    assert RunningAway((linear_log(),)).rms(model) == np.inf


@pytest.mark.parametrize("intersample", ["held", "zoh"])
def test_blocks_are_judged_with_the_input_of_the_fit(intersample: Intersample) -> None:
    """Known truth: an input held at every sample, whose exact answer leaves nothing in the blocks.

    Straight lines between the samples come half an interval early.
    """
    rng = np.random.default_rng(1)
    pressure = np.repeat(np.concatenate(([0.0], rng.uniform(0.0, 100.0, 39))), 25)
    fine_s = np.arange(50 * pressure.size) / (50 * RATE_HZ)
    held_fine = np.repeat(pressure, 50)
    angle = linear_angle(fine_s, held_fine)[::50]
    log = with_angle(driven(pressure), angle)
    trained, held = hold_out_blocks(LogSet((log,)))
    fitted = [one.with_intersample(intersample) for one in trained]
    problem = linear_problem(fitted)
    rms = held.rms(standing(problem, problem.unknowns(TRUTH)))
    straight = linear_problem(trained.logs)
    assert rms < 0.1 * held.rms(standing(straight, straight.unknowns(TRUTH)))
