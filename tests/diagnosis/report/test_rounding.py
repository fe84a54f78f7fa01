"""What the rounding of the channels makes of what is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade_diagnosis import diagnosis, remainder
from linear_motion import TRUTH, linear_angle, linear_log, linear_problem, standing

from softid.diagnosis.report.rounding import (
    COARSE_INPUT,
    input_rounding_issues,
    rounding_issues,
    with_rounding,
)
from softid.diagnosis_results import Verdict
from softid.excitation.texture import find_quantisation
from softid.identification.gauge_errors import gauge_errors
from softid.log import Log

BASE = diagnosis(Verdict.ADEQUATE).base
"""Its angle is told in degrees."""


def rounded(step: float) -> Log:
    log = linear_log(noise=0.01)
    angle = log.channels["angle"]
    values = np.round(angle.values / step) * step
    return replace(log, channels=dict(log.channels) | {"angle": replace(angle, values=values)})


@pytest.mark.parametrize(("rms", "told"), [(0.0104, True), (0.0128, True), (0.0130, False)])
def test_rounding_that_makes_what_is_left_is_told(rms: float, told: bool) -> None:
    """By hand: steps of 0.0222 rad have an rms of 0.0064, a quarter of the power of 0.0128."""
    found = rounding_issues([rounded(0.0222)], BASE, rms)
    assert bool(found) is told
    if told:
        assert "steps of 1.27 deg" in found[0].message
        assert found[0].remedy


def test_fine_samples_are_not_rounded() -> None:
    """No grid, or a fine one, is no remark; nor is a perfect fit."""
    assert not rounding_issues([linear_log(noise=0.01), rounded(0.001)], BASE, 0.0128)
    assert not rounding_issues([rounded(0.0222)], BASE, 0.0)


def ramped(step: float) -> Log:
    """The linear actuator on ramps of 2 kPa/s, with a pressure that is recorded in steps."""
    time_s = np.arange(3000) / 50.0
    pressure = 30.0 + 10.0 * np.abs((time_s / 5.0) % 2.0 - 1.0)
    recorded = np.round(pressure / step) * step
    angle = linear_angle(time_s, pressure)
    return Log.from_arrays(time_s, {"pressure": recorded, "angle": angle}, name="ramped")


@pytest.mark.parametrize(("rms", "told"), [(0.01, True), (0.02, True), (0.03, False)])
def test_rounding_of_the_input_that_makes_what_is_left_is_told(rms: float, told: bool) -> None:
    """By hand: steps of 2 kPa have an rms of 0.58 kPa, with a stiffness of 50 kPa/rad 0.0115 rad.

    That is a quarter of the power of 0.023 rad.
    """
    problem = linear_problem([ramped(2.0)])
    base = standing(problem, problem.unknowns(TRUTH))
    left = replace(remainder(structured=True, explained=0.0), rms=rms)
    gauges = {log.name: gauge_errors(log) for log in problem.logs}
    found = input_rounding_issues(base, left, gauges)
    assert bool(found) is told
    if told:
        assert "pressure is recorded in steps of 2 kPa" in found[0].message
    assert not input_rounding_issues(base, replace(left, structured=False), gauges)


def test_a_ramp_between_two_levels_is_not_rounded() -> None:
    """At 500 kPa/s and 50 Hz it goes up by 10 kPa a sample, and stays."""
    time_s = np.arange(1000) / 50.0
    pressure = np.clip(500.0 * (time_s - 2.0), 0.0, 120.0)
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": 0.02 * pressure})
    problem = linear_problem([log])
    base = standing(problem, problem.unknowns(TRUTH))
    left = replace(remainder(structured=True, explained=0.0), rms=1e-3)
    assert find_quantisation(pressure) is not None
    assert not input_rounding_issues(base, left, {log.name: gauge_errors(log)})


@pytest.mark.parametrize("name", ["pressure", "pressure_command"])
def test_levels_as_far_apart_as_they_were_set_are_not_rounded(name: str) -> None:
    """By definition: a staircase of 20 kPa is what was commanded, up and down, again and again."""
    time_s = np.arange(3000) / 50.0
    pressure = 20.0 * np.round(4.0 * np.abs((time_s / 10.0) % 2.0 - 1.0))
    log = Log.from_arrays(
        time_s,
        {name: pressure, "angle": linear_angle(time_s, pressure)},
        input=name,
        units={name: "kPa"},
    )
    problem = linear_problem([log])
    base = standing(problem, problem.unknowns(TRUTH))
    left = replace(remainder(structured=True, explained=0.0), rms=0.01)
    found = find_quantisation(pressure)
    assert found is not None
    assert found.step == pytest.approx(20.0)
    assert not input_rounding_issues(base, left, {log.name: gauge_errors(log)})


@pytest.mark.parametrize("verdict", [Verdict.UNKNOWN, Verdict.PARTIAL])
def test_an_unknown_cause_asks_for_a_finer_input_first(verdict: Verdict) -> None:
    """Any other experiment would be recorded as coarsely; a cause that is named has its own."""
    problem = linear_problem([ramped(2.0)])
    base = standing(problem, problem.unknowns(TRUTH))
    left = replace(remainder(structured=True, explained=0.0), rms=0.01)
    answer = replace(diagnosis(verdict), remainder=left, next_experiment="repeat it")
    gauges = {log.name: gauge_errors(log) for log in problem.logs}
    told = with_rounding(answer, problem.logs, base, gauges)
    assert COARSE_INPUT in {issue.code for issue in told.issues}
    asks = told.next_experiment or ""
    assert ("finer converter" in asks) is (verdict is Verdict.UNKNOWN)
