"""The moment at which a misfit begins, on logs in which something changed at a known one."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from handmade_diagnosis import remainder
from linear_motion import (
    RATE_HZ,
    TRUTH,
    linear_angle,
    linear_log,
    linear_problem,
    pressure_course,
    sizes_of,
    standing,
)
from noise import coloured

from softid.diagnosis import diagnose
from softid.diagnosis.changes import change_point as change_point_module
from softid.diagnosis.changes.change_point import change_point
from softid.diagnosis.refit.candidates import Candidate, advance
from softid.diagnosis.refit.held_out import HeldOutLogs
from softid.diagnosis.report import changes
from softid.diagnosis.report.changes import (
    CHANGE_POINT,
    HELD_OUT_CHANGE,
    change_issues,
    held_out_change_issues,
)
from softid.diagnosis.residual.assessment import excess_of
from softid.diagnosis.residual.motion import mean_square, residual_context
from softid.log import Log
from softid.synthesis import hidden_pair

Array = npt.NDArray[np.float64]

N, NOISE, MOMENT_S = 2000, 0.01, 23.0
TIME_S = np.arange(N) / RATE_HZ
ANGLE = linear_angle(TIME_S, pressure_course(TIME_S))
LATE = TIME_S > MOMENT_S
RATE = np.gradient(ANGLE, TIME_S)

ADDED = {
    "zero": 0.1 * LATE,
    "gain": -0.08 * ANGLE * LATE,
    "clock": np.interp(TIME_S - 0.06 * LATE, TIME_S, ANGLE) - ANGLE,
}
"""What a sensor adds whose zero, gain or clock jumps."""


def fitted(*logs: Log) -> Candidate:
    """The oscillator at its optimum over some logs."""
    problem = linear_problem(logs)
    begun = standing(problem, problem.unknowns(TRUTH))
    return advance(begun, {"angle": NOISE}, 40, tolerance=1e-4)


def excess(base: Candidate) -> float:
    return excess_of(base, sizes_of(base))


@pytest.mark.parametrize("kind", ADDED)
def test_moment_and_kind_are_found(kind: str) -> None:
    """Known truth, to half a second, for some jumps show in motion only; all of the misfit goes."""
    base = fitted(linear_log(noise=NOISE, samples=N, added=ADDED[kind]))
    found = change_point(base, sizes_of(base), excess(base))
    assert found is not None
    assert found.kind == kind
    assert found.time_s == pytest.approx(MOMENT_S, abs=0.5)
    assert found.share == pytest.approx(1.0, abs=0.06)


def test_the_log_is_found() -> None:
    """Of three logs the second has a zero that jumps; its own moment and name are told."""
    logs = [
        linear_log(noise=NOISE, seed=k, samples=N, added=ADDED["zero"] * (k == 1))
        for k in (0, 1, 2)
    ]
    base = fitted(*logs)
    found = change_point(base, sizes_of(base), excess(base))
    assert found is not None
    assert found.log == 1
    (mark,) = change_issues(base, sizes_of(base), excess(base))
    assert mark.code == CHANGE_POINT
    assert "s of linear-1: its zero jumps there, which takes away" in mark.message


def test_two_changes_at_once_are_neither_alone() -> None:
    """Zero and gain jump together: the moment is told, and no kind, for none makes up for both."""
    base = fitted(linear_log(noise=NOISE, samples=N, added=(0.1 - 0.15 * ANGLE) * LATE))
    found = change_point(base, sizes_of(base), excess(base))
    assert found is not None
    assert found.kind == ""
    assert found.time_s == pytest.approx(MOMENT_S, abs=0.5)
    (mark,) = change_issues(base, sizes_of(base), excess(base))
    assert "there the model changes in more than one way" in mark.message


OTHERS = {
    "nothing": 0.0 * ANGLE,
    "drift": 0.004 * TIME_S,
    "lag": np.interp(TIME_S - 0.08, TIME_S, ANGLE) - ANGLE,
    "curve": 0.05 * ANGLE**2,
    "friction": 0.05 * np.tanh(RATE / 0.1),
    "two jumps": 0.1 * (LATE & (TIME_S < 31.0)),
    "swings": 0.05 * np.sin(2.0 * np.pi * 0.13 * TIME_S),
}


@pytest.mark.parametrize("name", OTHERS)
def test_what_goes_on_throughout_begins_at_no_moment(name: str) -> None:
    """Noise, a drift, a delay, a law of position or speed, a swing, and what comes and goes."""
    base = fitted(linear_log(noise=NOISE, samples=N, added=OTHERS[name]))
    assert change_point(base, sizes_of(base), excess(base)) is None


def slow_noise(seed: int) -> Array:
    """Noise with the usual deviation, 90 % of it with a correlation time of 1 s."""
    rng = np.random.default_rng(seed)
    slow = coloured(rng, N, 1.0, 1.0 / RATE_HZ)
    found: Array = NOISE * (np.sqrt(0.9) * slow + np.sqrt(0.1) * rng.standard_normal(N))
    return found


@pytest.mark.parametrize(
    ("added", "most"),
    [(0.0 * ANGLE, 1), (0.0018 * TIME_S, 0), (0.0015 * ANGLE * TIME_S, 0)],
    ids=["nothing", "drift", "gain drift"],
)
def test_slow_noise_begins_at_no_moment(added: Array, most: int) -> None:
    """Of 20 draws, with the noise known; to the statistics of white noise more of them would."""
    found = []
    for seed in range(20):
        base = fitted(linear_log(noise=0.0, samples=N, added=added + slow_noise(seed)))
        power = mean_square(residual_context(base))
        found.append(change_point(base, sizes_of(base), power / NOISE**2 - 1.0))
    assert sum(moment is not None for moment in found) <= most


def test_a_change_in_no_known_way_is_told_if_nothing_else_is() -> None:
    """A zero and a gain that jump at once are neither alone."""
    both = ADDED["zero"] + 2.0 * ADDED["gain"]
    base = fitted(linear_log(noise=NOISE, samples=N, added=both))
    (mark,) = change_issues(base, sizes_of(base), excess(base))
    assert "in more than one way" in mark.message
    assert change_issues(base, sizes_of(base), excess(base), alone=True) == ()


def judged_by(base: Candidate, judge: Log) -> Any:
    """What is asked of a base fit here."""
    return SimpleNamespace(candidate=base, held_out=HeldOutLogs((judge,)), scale=sizes_of(base))


@pytest.mark.parametrize("kind", ADDED)
def test_what_is_held_out_begins_to_differ_at_a_moment(kind: str) -> None:
    """Known truth: the fitted log is whole, and the other jumps at its own moment."""
    base = fitted(linear_log(noise=NOISE, samples=N))
    judge = linear_log(noise=NOISE, seed=7, samples=N, added=ADDED[kind])
    left = remainder(structured=False, explained=1.0)
    left = replace(left, rms=NOISE, excess=0.0, misses_held_out=True)
    (mark,) = held_out_change_issues(base, left, judged_by(base, judge), is_sure=True)
    moment = re.search(r"begins at ([0-9.]+) s of linear-7: its (\w+)", mark.message)
    assert moment is not None
    assert float(moment[1]) == pytest.approx(MOMENT_S, abs=0.5)
    assert moment[2] == kind
    found = replace(left, misses_held_out=False)
    assert held_out_change_issues(base, found, judged_by(base, judge), is_sure=True) == ()


def test_another_actuator_differs_at_no_moment() -> None:
    """Half as large from the first sample on: another gain, not a jump."""
    base = fitted(linear_log(noise=NOISE, samples=N))
    judge = linear_log(noise=NOISE, seed=7, samples=N, added=-0.5 * ANGLE)
    left = remainder(structured=False, explained=1.0)
    left = replace(left, rms=NOISE, excess=0.0, misses_held_out=True)
    (mark,) = held_out_change_issues(base, left, judged_by(base, judge), is_sure=True)
    judged = judged_by(base, judge)
    assert held_out_change_issues(base, left, judged, is_sure=False) == ()
    loud = replace(left, structured=True)  # the model is right on none of the logs
    assert held_out_change_issues(base, loud, judged, is_sure=True) == ()
    assert mark.code == HELD_OUT_CHANGE
    assert "the gain of the reading changes by -50.0 % in linear-7" in mark.message


def test_a_turned_hold_out_is_told_whatever_else_is_wrong() -> None:
    """A model that is right on none of the logs is wrong on a turned one by far more."""
    base = fitted(linear_log(noise=NOISE, samples=N))
    turned = linear_log(noise=NOISE, seed=7, samples=N, added=-2.0 * ANGLE + 0.1 * ANGLE**2)
    left = replace(remainder(structured=True, explained=0.0), misses_held_out=True)
    (mark,) = held_out_change_issues(base, left, judged_by(base, turned), is_sure=False)
    assert mark.code == HELD_OUT_CHANGE
    assert "angle has the other sign in linear-7 than in the fitted logs" in mark.message
    bent = linear_log(noise=NOISE, seed=7, samples=N, added=0.1 * ANGLE**2)
    told = held_out_change_issues(base, left, judged_by(base, bent), is_sure=False)
    assert not any("sign" in mark.message for mark in told)


def test_one_change_throughout_is_told_before_a_moment(monkeypatch: pytest.MonkeyPatch) -> None:
    """A moment has one more unknown: it is not even looked for where a gain takes all away."""
    base = fitted(linear_log(noise=NOISE, samples=N))
    judge = linear_log(noise=NOISE, seed=7, samples=N, added=0.06 * ANGLE)
    left = remainder(structured=False, explained=1.0)
    left = replace(left, rms=NOISE, excess=0.0, misses_held_out=True)
    monkeypatch.setattr(changes, "change_issues", lambda *asked: pytest.fail("looked for"))
    (mark,) = held_out_change_issues(base, left, judged_by(base, judge), is_sure=True)
    size = re.search(r"the gain of the reading changes by ([0-9.+]+) % in linear-7", mark.message)
    assert size is not None
    assert float(size[1]) == pytest.approx(6.0, abs=0.3)


def test_a_model_that_runs_away_has_no_moment(monkeypatch: pytest.MonkeyPatch) -> None:
    """A load that is nearly nothing moves it beyond all numbers: nothing is regressed on that."""
    base = fitted(linear_log(noise=NOISE, samples=N, added=ADDED["zero"]))
    assert change_point(base, sizes_of(base), excess(base)) is not None
    monkeypatch.setattr(change_point_module, "by_load", lambda *given: np.full(N, np.inf))
    assert change_point(base, sizes_of(base), excess(base)) is None


def test_a_diagnosis_tells_the_moment() -> None:
    """No effect is named, the paragraph tells when, and what to do next."""
    log = linear_log(noise=NOISE, samples=N, added=ADDED["zero"])
    found = diagnose(log, model="oscillator", effects=["sensor_lag"])
    assert not found.causes
    assert re.search(r"The misfit of angle begins at 2[23]\.\d+ s of linear-0: ", found.summary)
    assert "its zero jumps there" in found.summary
    assert "diagnose what comes before and after it apart" in (found.next_experiment or "")


@pytest.mark.parametrize("seed", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_a_load_that_is_hung_on_is_no_jump_of_the_zero(seed: int) -> None:
    """Where the stiffness goes with the pressure the two differ from level to level."""
    pair = hidden_pair(["load_jump"], seed=seed)
    found = diagnose(pair.logs[0], model="muscle", effects=["sensor_drift"])
    assert not found.causes
    assert "a constant load changes" in found.summary
    (moment,) = re.findall(r"(?:begins at|confined to) ([0-9.]+) s", found.summary)
    assert float(moment) == pytest.approx(pair.hidden["load_jump"]["at"], abs=1.0)
