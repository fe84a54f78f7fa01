"""Which effect on a reading or an input comes first: a limit, a dead zone, or another one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, linear_angle, linear_log, linear_problem, standing

from softid.diagnosis import diagnose
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import acting_order, extend_in_order, start_unknowns
from softid.diagnosis.search.forward_selection import converged
from softid.diagnosis.search.order_of_action import (
    in_better_order,
    inputs_exchanged,
    other_order,
)
from softid.diagnosis_results import Diagnosis
from softid.effects import effect_of, extended_name
from softid.effects.base import Effect
from softid.synthesis import hidden_pair

CLIPPING, DRIFT = effect_of("sensor_clipping"), effect_of("sensor_drift")
RATE, LIMIT = 0.02, 1.5
"""rad/s and rad: 0.4 rad over the log, of which levels of up to 1.9 rad are clipped."""


def fitted(true: tuple[Effect, ...], asked: tuple[Effect, ...]) -> Candidate:
    """A model with effects in one order at its optimum for a log that holds them in another."""
    log = linear_log(noise=0.01)
    angle = linear_angle(log.time_s, log.channels["pressure"].values)
    drift = RATE * log.time_s
    before, behind = (drift, 0.0) if true[0] is DRIFT else (0.0, drift)
    read = np.minimum(angle + before, LIMIT) + behind
    base = linear_problem([linear_log(noise=0.01, added=read - angle)])
    z = base.unknowns(TRUTH)
    problem = extend_in_order(base, asked, scale_of(base, z))
    begun = start_unknowns(
        problem, base, z, {"sensor_clipping_upper": LIMIT, "sensor_drift_rate": RATE}
    )
    return converged(replace(standing(problem, begun, SIGMA), effects=asked), SIGMA)


@pytest.mark.parametrize("true", [(DRIFT, CLIPPING), (CLIPPING, DRIFT)])
def test_the_order_in_the_log_is_found(true: tuple[Effect, ...]) -> None:
    """A thousand samples of noise of one hundredth of a radian, and the truth within 3 %."""
    wrong = fitted(true, (true[1], true[0]))
    found = in_better_order(wrong, SIGMA)
    assert found.acting == true
    assert found.effects == wrong.effects
    assert found.squares == pytest.approx(1000.0, abs=180.0)
    assert wrong.squares > 2.0 * found.squares
    assert found.parameters["sensor_clipping_upper"] == pytest.approx(LIMIT, rel=0.03)
    assert found.parameters["sensor_drift_rate"] == pytest.approx(RATE, rel=0.03)


def test_the_right_order_stays() -> None:
    right = fitted((DRIFT, CLIPPING), (DRIFT, CLIPPING))
    assert in_better_order(right, SIGMA) is right


ZONE, LAG = effect_of("dead_zone"), effect_of("pneumatic_lag")
VALUES = {"dead_zone_p0": 20.0, "dead_zone_softness": 0.05, "pneumatic_lag_tau": 0.3}


def driven(true: tuple[Effect, ...], asked: tuple[Effect, ...], **values: float) -> Candidate:
    """A model with effects on the input in one order, for a log that holds them in another."""
    log = linear_log(noise=0.01)
    base = linear_problem([log])
    z = base.unknowns(TRUTH)
    scale, known = scale_of(base, z), VALUES | values
    fine_s = np.linspace(0.0, log.time_s[-1], 20 * (len(log) - 1) + 1)
    u = np.interp(fine_s, log.time_s, log.channels["pressure"].values)
    plain = linear_angle(fine_s, u)
    for effect in true:
        own = [known[extended_name(effect, p)] for p in effect.parameters(scale).names]
        u = effect.apply(np.array(own), fine_s, u, scale)  # type: ignore[attr-defined]
    moved = (linear_angle(fine_s, u) - plain)[::20]
    there = linear_problem([linear_log(noise=0.01, added=moved)])
    problem = extend_in_order(there, asked, scale)
    begun = start_unknowns(problem, there, z, known)
    return replace(standing(problem, begun, SIGMA), effects=asked)


@pytest.mark.parametrize("true", [(ZONE, LAG), (LAG, ZONE)])
def test_the_order_on_the_input_is_found(true: tuple[Effect, ...]) -> None:
    """A valve's dead zone before a lag of 0.3 s, and that of the folds behind it, to 5 %.

    The lag and the actuator's own times may be in each other's place, so that they are not asked.
    """
    wrong = converged(driven(true, (true[1], true[0])), SIGMA)
    found = in_better_order(wrong, SIGMA)
    assert found.acting == true
    assert wrong.squares > found.squares + 200.0  # 1000 samples of noise scatter by 45
    assert found.squares == pytest.approx(1000.0, abs=180.0)
    assert found.parameters["dead_zone_p0"] == pytest.approx(20.0, rel=0.05)


def test_what_commutes_stays() -> None:
    """Two lags may change places, and so may a zone that is next to nothing; one is alone."""
    late = (effect_of("line_resonance"), LAG)
    linear = {"line_resonance_period": 0.3, "line_resonance_zeta": 0.5}
    for asked, values in ((late, linear), ((ZONE, LAG), {"dead_zone_p0": 0.05}), ((ZONE,), {})):
        model = driven(asked, asked, **values)
        assert inputs_exchanged(model) == asked
    apart = driven((ZONE, LAG), (ZONE, LAG))
    assert inputs_exchanged(apart) == (LAG, ZONE)


@pytest.mark.parametrize(
    ("keys", "other"),
    [
        (("sensor_clipping", "sensor_drift"), ("sensor_drift", "sensor_clipping")),
        (("sensor_drift", "sensor_clipping"), ("sensor_clipping", "sensor_drift")),
        (
            ("sensor_drift", "sensor_clipping", "sensor_lag"),
            ("sensor_drift", "sensor_lag", "sensor_clipping"),
        ),
        (("sensor_clipping", "creep"), ("sensor_clipping", "creep")),
        (("sensor_drift", "sensor_lag"), ("sensor_drift", "sensor_lag")),
    ],
)
def test_what_clips_goes_to_the_other_end(keys: tuple[str, ...], other: tuple[str, ...]) -> None:
    """Only beside what else acts on the reading: a creep is in the motion."""
    asked = tuple(effect_of(key) for key in keys)
    assert tuple(effect.key for effect in other_order(asked)) == other


@pytest.mark.parametrize(
    ("known", "added", "order"),
    [
        ("", "dc", "dc"),
        ("c", "d", "dc"),
        ("dc", "k", "dkc"),
        ("cd", "k", "cdk"),
        ("d", "c", "dc"),
        ("", "cd", "dc"),
        ("d", "s", "sd"),
        ("kcd", "s", "kscd"),
        ("s", "d", "sd"),
        ("", "cds", "sdc"),
    ],
)
def test_what_is_added_acts_before_the_end_of_the_range(known: str, added: str, order: str) -> None:
    """c is clipping, d a drift of the sensor, k a creep; an order that is known stays.

    A creep in series, s, is the body's own, before all that a sensor does to the reading.
    """
    named = {"c": CLIPPING, "d": DRIFT, "k": effect_of("creep"), "s": effect_of("creep.series")}
    told = acting_order([named[k] for k in known], [named[k] for k in added])
    assert told == tuple(named[k] for k in order)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [321013, 5])
def test_a_limit_in_front_of_a_drift_stays_in_the_race(seed: int) -> None:
    """The drift is found first. Behind it a limit cuts what it does not: it stays in the race until
    it can change its place, for else a stop in the actuator would be named for it, or nothing."""
    hidden = hidden_pair(
        ["sensor_clipping", "sensor_drift"], seed=seed, model="oscillator", protocol="lever"
    )
    train, hold_out = hidden.logs
    effects = ["sensor_drift", "sensor_clipping", "contact"]
    found = diagnose(train, hold_out=[hold_out], model="oscillator", effects=effects)
    assert {cause.effect for cause in found.causes} == {"sensor_drift", "sensor_clipping"}
    limit = estimate(found, "sensor_clipping_upper")
    assert limit == pytest.approx(hidden.hidden["sensor_clipping"]["upper"], rel=0.02)


def estimate(found: Diagnosis, name: str) -> float:
    assert found.extended is not None
    return found.extended.parameter(name).value
