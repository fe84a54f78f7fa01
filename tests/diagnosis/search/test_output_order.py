"""Which of a sensor's effects comes first: the end of its range, or what else it does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, linear_angle, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import acting_order, extend_in_order, start_unknowns
from softid.diagnosis.search.forward_selection import converged
from softid.diagnosis.search.output_order import in_better_order, other_order
from softid.effects import effect_of
from softid.effects.base import Effect

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
    ],
)
def test_what_is_added_acts_before_the_end_of_the_range(known: str, added: str, order: str) -> None:
    """c is clipping, d a drift of the sensor, k a creep; an order that is known stays."""
    named = {"c": CLIPPING, "d": DRIFT, "k": effect_of("creep")}
    told = acting_order([named[k] for k in known], [named[k] for k in added])
    assert told == tuple(named[k] for k in order)
