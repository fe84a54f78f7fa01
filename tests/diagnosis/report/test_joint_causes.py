"""Two names for what may be one cause."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from extended_fits import extended_fit
from handmade_diagnosis import DELAY, cause, diagnosis, estimate

from softid.diagnosis.report.joint_causes import (
    ONE_CAUSE,
    OWN_LAG,
    SHARED_SCALE,
    joint_cause_issues,
    with_open_places,
    with_shared_scale,
)
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis_results import Alternative, Diagnosis, Verdict
from softid.models import Oscillator

GAIN = cause(
    "sensor_gain_drift",
    [estimate("sensor_gain_drift_g", -0.008, "1/s")],
    before=2.0,
    after=1.0,
)
ZERO = cause(
    "sensor_drift", [estimate("sensor_drift_rate", -0.002, "rad/s")], before=1.0, after=0.5
)


def test_a_gain_about_the_sensors_own_zero_is_told() -> None:
    """By hand: y₀ = −d/g = −0.25 rad in the model, so 14.3 degrees below the zero of the log."""
    found = replace(diagnosis(Verdict.NAMED), causes=(GAIN, ZERO))
    assert found.extended is not None
    zero = found.extended.nuisances[0].zero["angle"]
    (issue,) = joint_cause_issues(found)
    assert issue.code == ONE_CAUSE
    expected = float(np.rad2deg(zero - 0.25))
    told = float(issue.message.split(" of ")[-1].split(" deg")[0])
    assert told == pytest.approx(expected, rel=5e-3)
    assert issue.message[1:] in write_summary(replace(found, issues=(issue,))).summary


def test_other_causes_are_two() -> None:
    """One of them alone, or beside another cause, says nothing of the sensor's zero."""
    for causes in ((GAIN,), (ZERO,), (GAIN, DELAY), ()):
        assert joint_cause_issues(replace(diagnosis(Verdict.NAMED), causes=causes)) == ()


def test_a_free_curve_shares_the_scale_of_the_law() -> None:
    """Told where the static curve is free, and by no other cause.

    What is known up to a factor is not identified; a delay beside it is.
    """
    knot = replace(estimate("static_curve_k2", 0.1, "rad"), verdict="identified")
    curve = cause("static_curve", [knot], before=2.0, after=1.0)
    found = diagnosis(Verdict.NAMED)
    assert found.extended is not None
    own = tuple(replace(p, verdict="identified") for p in found.extended.parameters)
    known = replace(found.extended, parameters=(*own, knot))
    both = replace(found, causes=(DELAY, curve), extended=known)
    told = with_shared_scale(both, linear_in=None)
    issue = told.issues[-1]
    assert (issue.code, issue.severity) == (SHARED_SCALE, "warning")
    assert told.extended is not None
    for p in told.extended.parameters:
        sure = p.name.startswith("delay_")
        assert (p.verdict == "identified") is sure, p.name
        assert bool(p.reason) is not sure
    (_, of_curve) = told.causes
    assert [p.verdict for p in of_curve.parameters] == ["weakly identified"]
    other = replace(both, causes=(DELAY, GAIN))
    assert with_shared_scale(other, linear_in=None) is other


def verdicts(found: Diagnosis) -> dict[str, str]:
    assert found.extended is not None
    return {p.name: p.verdict for p in found.extended.parameters}


def over_oscillator(*keys: str) -> Diagnosis:
    """Causes over an oscillator with a natural frequency of its own."""
    own = {"natural_frequency": (2.0, "Hz"), "damping_ratio": (0.3, "1")}
    extended = replace(extended_fit("oscillator", *keys), derived=own)
    causes = tuple(
        cause(
            key,
            [p for p in extended.parameters if p.name.startswith(key.partition(".")[0] + "_")],
            before=2.0,
            after=1.0,
        )
        for key in keys
    )
    found = diagnosis(Verdict.AMBIGUOUS, extended=extended)
    base = replace(found.base, model=Oscillator(x_unit="rad", u_unit="kPa").spec())
    return replace(found, base=base, causes=causes, alternatives=())


def test_over_a_linear_model_forces_share_the_scale_and_speeds_do_not() -> None:
    """M ẍ + N ẋ + Q x = u, with all three and a friction twice as large: vs is what it was."""
    found = over_oscillator("static_curve", "coulomb_friction")
    told = verdicts(with_shared_scale(found, linear_in="kPa"))
    shared = {name for name, verdict in told.items() if verdict == "weakly identified"}
    assert {"M", "N", "Q", "coulomb_friction_Fc"} <= shared
    assert told["coulomb_friction_vs"] == "identified"


def test_what_may_change_places_with_the_actuators_own_is_not_identified() -> None:
    """A line's resonance, tied with the sensor's or not, may be the actuator's; its gain is none
    of it. Behind a dead zone it may be, too, and before one it is not."""
    found = over_oscillator("line_resonance", "sensor_drift")
    open_ones = {"M", "N", "line_resonance_period", "line_resonance_zeta"}
    rivals = ("line_resonance", "sensor_resonance")
    tie = Alternative(rivals, dict.fromkeys(rivals, 0.0), why="")
    for alternatives in ((), (tie,)):
        told = with_open_places(replace(found, alternatives=alternatives))
        assert {n for n, verdict in verdicts(told).items() if verdict != "identified"} == open_ones
        assert told.causes[0].parameters[0].verdict == "weakly identified"
        assert told.causes[1] == found.causes[1]
    behind = with_open_places(over_oscillator("dead_zone", "line_resonance"))
    assert {n for n, v in verdicts(behind).items() if v != "identified"} == open_ones
    for keys in (("line_resonance", "dead_zone"), ("line_resonance", "hysteresis")):
        between = over_oscillator(*keys)
        assert with_open_places(between) is between


def test_a_lag_is_none_of_an_actuator_that_rings() -> None:
    """One real pole has no place among two complex ones."""
    found = over_oscillator("pneumatic_lag")
    assert with_open_places(found) is found


def test_an_inertia_that_does_not_ring_may_be_a_lag() -> None:
    """(0.5 d/dt + 1)(0.1 d/dt + 1): a lag of either before the other, unless friction tells.

    By hand: ω = 1/√0.05 rad/s, ζ = 0.6 ω/2.
    """
    omega = 1.0 / np.sqrt(0.05)
    own = {
        "time_constant": (0.6, "s"),
        "natural_frequency": (omega / (2.0 * np.pi), "Hz"),
        "damping_ratio": (0.3 * omega, "1"),
    }

    def with_times(*keys: str) -> Diagnosis:
        found = over_oscillator(*keys)
        assert found.extended is not None
        return replace(found, extended=replace(found.extended, derived=own))

    told = with_open_places(with_times("sensor_drift"))
    assert {n for n, v in verdicts(told).items() if v != "identified"} == {"M", "N"}
    assert told.extended is not None
    assert "a lag of 0.5 s or of 0.1 s" in told.extended.parameters[0].reason
    assert told.issues[-1].code == OWN_LAG
    rubs = with_times("coulomb_friction")
    assert with_open_places(rubs) is rubs
    rings = over_oscillator("sensor_drift")
    assert with_open_places(rings) is rings


def test_an_adequate_base_tells_it_too() -> None:
    """Without a cause the base itself is in doubt, and only a linear one."""
    own = {
        "time_constant": (0.6, "s"),
        "natural_frequency": (2.0, "Hz"),
        "damping_ratio": (2.0, "1"),
    }
    found = over_oscillator("sensor_drift")
    assert found.extended is not None
    base = replace(found.extended, model=found.base.model, derived=own)
    clean = replace(found, verdict=Verdict.ADEQUATE, base=base, extended=None, causes=())
    told = {p.name: p.verdict for p in with_open_places(clean).base.parameters}
    assert (told["M"], told["N"], told["Q"]) == (*["weakly identified"] * 2, "identified")
    nonlinear = replace(diagnosis(Verdict.ADEQUATE), extended=None)
    assert with_open_places(nonlinear) is nonlinear
