"""Jumps of a sensor's zero, in logs of which a model explains the rest or does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import (
    RATE_HZ,
    TRUTH,
    excess_over,
    linear_angle,
    linear_log,
    linear_problem,
    sizes_of,
    standing,
)

from softid.diagnosis.changes.jump_search import seen_again, zero_jumps
from softid.diagnosis.changes.zero_jumps import (
    ZERO_JUMP,
    ZeroJump,
    with_jumps_exchanged,
    without_jumps,
)
from softid.diagnosis.logs.decimation import AveragedLog, decimated
from softid.diagnosis.refit.candidates import Candidate, advance
from softid.log import Log

Array = npt.NDArray[np.float64]

N, NOISE, SIZE, AT_S = 1500, 0.01, 0.2, 17.0
TIME_S = np.arange(N) / RATE_HZ
SLIPPED = np.where(TIME_S > AT_S, SIZE, 0.0)


def fitted(*logs: Log) -> Candidate:
    problem = linear_problem(list(logs))
    start = problem.unknowns({"M": 0.4, "N": 10.0, "Q": 50.0})
    return advance(standing(problem, start), {"angle": NOISE}, 40)


def log_with(added: Array | float, seed: int = 0) -> Log:
    return linear_log(noise=NOISE, seed=seed, samples=N, added=added)


@pytest.mark.parametrize("hidden", [0.0, 0.1 * np.sin(1.3 * TIME_S)])
def test_a_jump_is_seen_at_its_moment_beside_something_else(hidden: Array | float) -> None:
    """Known truth, alone and beside a swing that no parameter follows, in one log of two."""
    model = fitted(log_with(0.0, 1), log_with(SLIPPED + hidden))
    (jump,) = zero_jumps(model, sizes_of(model), excess_over(NOISE, model))
    assert jump.log == "linear-0"
    assert jump.time_s == pytest.approx(AT_S, abs=1.5 / RATE_HZ)
    assert jump.size == pytest.approx(SIZE, rel=0.15)


@pytest.mark.parametrize("added", [0.0, 0.01 * TIME_S, 0.2 * np.sin(1.3 * TIME_S)])
def test_what_goes_on_throughout_is_no_jump(added: Array | float) -> None:
    """Noise, a drift and a swing."""
    model = fitted(log_with(added))
    assert zero_jumps(model, sizes_of(model), excess_over(NOISE, model)) == ()


def test_a_jump_while_readings_are_lost_is_seen_beside_the_gap() -> None:
    """Three seconds are lost about the slip, more than the moments that are tried lie apart."""
    half = ZeroJump("linear-0", AT_S, SIZE / 2.0)
    log = without_jumps(log_with(SLIPPED), [half])
    model = fitted(log.with_masked(np.abs(TIME_S - AT_S) < 1.5))
    (jump,) = seen_again(model, sizes_of(model), [half])
    assert jump.time_s == pytest.approx(AT_S, abs=1.6)
    assert jump.size == pytest.approx(SIZE, rel=0.05)


def test_a_jump_that_was_taken_out_wrongly_is_seen_again() -> None:
    """Half of it is left, and it was taken three samples late."""
    rough = ZeroJump("linear-0", AT_S + 3.0 / RATE_HZ, SIZE / 2.0)
    model = fitted(without_jumps(log_with(SLIPPED), [rough]))
    (jump,) = seen_again(model, sizes_of(model), [rough])
    assert jump.time_s == pytest.approx(AT_S, abs=1.5 / RATE_HZ)
    assert jump.size == pytest.approx(SIZE, rel=0.05)


def test_a_load_is_taken_out_along_its_course() -> None:
    """Known truth: the actuator moves to its new place, and no reading jumps."""
    pressure = np.where(TIME_S > AT_S, SIZE * TRUTH["Q"], 0.0)
    moved = log_with(linear_angle(TIME_S, pressure))
    model = fitted(moved)
    rough = zero_jumps(model, sizes_of(model), excess_over(NOISE, model))
    for _ in range(3):
        model = fitted(without_jumps(moved, rough))
        rough = seen_again(model, sizes_of(model), rough)
    (jump,) = rough
    assert jump.kind == "load"
    assert jump.time_s == pytest.approx(AT_S, abs=1.5 / RATE_HZ)
    assert jump.size == pytest.approx(SIZE, rel=0.05)
    assert excess_over(NOISE, model) == pytest.approx(0.0, abs=0.1)
    (issue,) = without_jumps(moved, [jump]).issues
    place = f"another place at {jump.time_s:.4g} s of {moved.name}, angle by +0.2 rad, as where"
    assert place in issue.message
    either = replace(jump, kind="zero or load")
    (issue,) = without_jumps(moved, [either]).issues
    assert ", or a load is put on or taken off; the readings" in issue.message


@pytest.mark.parametrize("count", [1, 4])
def test_the_log_without_a_jump_is_that_before_it(count: int) -> None:
    """The recording behind averages, too; the remark tells size and moment in the log's unit."""
    jump = ZeroJump("linear-0", AT_S, SIZE)
    before, after = log_with(0.0), log_with(SLIPPED)
    if count > 1:
        before, after = (decimated(log, count) for log in (before, after))
    steady = without_jumps(after, [jump, replace(jump, log="another")])
    logs = [(before, steady)]
    if isinstance(before, AveragedLog):
        assert isinstance(steady, AveragedLog)
        logs.append((before.recorded, steady.recorded))
    for one, other in logs:
        angles = [log.channels["angle"].values for log in (one, other)]
        # the mean in which the zero jumps holds a part of it
        assert np.median(np.abs(angles[1] - angles[0])) == pytest.approx(0.0, abs=1e-12)
        assert np.abs(angles[1] - angles[0]).max() < (SIZE if count > 1 else 1e-12)
    (issue,) = [issue for issue in steady.issues if issue.code == ZERO_JUMP]
    assert "the zero of angle jumps by +0.2 rad at 17 s of linear-0" in issue.message


def test_exchanged_jumps_are_those_taken_out_at_once() -> None:
    """Of one log only, whichever is given first; what was taken out wrongly comes back."""
    wrong, right = ZeroJump("linear-0", AT_S - 1.0, -SIZE), ZeroJump("linear-0", AT_S, SIZE)
    other = replace(right, log="another")
    slipped = log_with(SLIPPED)
    exchanged = with_jumps_exchanged(without_jumps(slipped, [wrong]), [other, wrong], [right])
    at_once = without_jumps(slipped, [right])
    angles = [log.channels["angle"].values for log in (exchanged, at_once)]
    assert angles[0] == pytest.approx(angles[1], abs=1e-12)
