"""The moment at which a misfit begins, on logs in which something changed at a known one."""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import (
    RATE_HZ,
    TRUTH,
    linear_angle,
    linear_log,
    linear_problem,
    pressure_course,
    standing,
)

from softid.diagnosis import diagnose
from softid.diagnosis.assessment import assess
from softid.diagnosis.candidates import Candidate, advance
from softid.diagnosis.change_point import CODE, change_marks, change_point
from softid.diagnosis.scale import scale_of
from softid.log import Log

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


def excess_of(base: Candidate) -> float:
    scale = scale_of(base.problem, base.minimum.point)
    return assess(base, base, scale, rng=np.random.default_rng(0)).excess


@pytest.mark.parametrize("kind", ADDED)
def test_moment_and_kind_are_found(kind: str) -> None:
    """Known truth, to half a second, for some jumps show in motion only; all of the misfit goes."""
    base = fitted(linear_log(noise=NOISE, samples=N, added=ADDED[kind]))
    found = change_point(base, excess_of(base))
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
    found = change_point(base, excess_of(base))
    assert found is not None
    assert found.log == 1
    (mark,) = change_marks(base, scale_of(base.problem, base.minimum.point), seed=0)
    assert mark.code == CODE
    assert "s of linear-1: its zero jumps there, which takes away" in mark.message


def test_a_change_of_the_actuator_is_none_of_the_sensor() -> None:
    """From one moment on the damping is four times as large: no kind alone makes up for it."""
    slow = linear_angle(TIME_S, pressure_course(TIME_S), TRUTH | {"N": 4.0 * TRUTH["N"]})
    base = fitted(linear_log(noise=0.003, samples=N, added=(slow - ANGLE) * LATE))
    found = change_point(base, excess_of(base))
    assert found is None or found.kind == ""


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
    assert change_point(base, excess_of(base)) is None


def test_a_diagnosis_tells_the_moment() -> None:
    """No effect is named, the paragraph tells when, and what to do next."""
    log = linear_log(noise=NOISE, samples=N, added=ADDED["zero"])
    found = diagnose(log, model="oscillator", effects=["sensor_lag"])
    assert not found.causes
    assert re.search(r"The misfit of angle begins at 2[23]\.\d+ s of linear-0: ", found.summary)
    assert "its zero jumps there" in found.summary
    assert "diagnose what comes before and after it apart" in (found.next_experiment or "")
