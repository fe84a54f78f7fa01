"""Which model a first cause extends, where nobody named one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from softid.diagnosis import diagnose
from softid.diagnosis.searches.over_plainer_models import PLAINER_MODEL
from softid.diagnosis_results import Verdict
from softid.log import Log
from softid.synthesis import hidden_pair

M, N, Q = 0.012, 0.30, 1.6
"""Inertia, damping and stiffness of an actuator that does not ring: poles of 0.13 and 0.058 s."""

TOP_KPA, RATE_HZ, NOISE = 240.0, 50.0, 5e-3

SOME = ("contact", "creep", "delay", "static_curve", "stiffening")


@pytest.mark.slow
@pytest.mark.parametrize("effect", ["contact", "stiffening"])
def test_a_plainer_model_with_its_cause_takes_the_place_of_one_that_bends_to_it(
    effect: str,
) -> None:
    """Known truth: an oscillator that meets a wall, or whose spring is nonlinear.

    By itself a muscle, whose spring is curved, predicts both better.
    """
    hidden = hidden_pair([effect], seed=501, model="oscillator")
    train, hold_out = hidden.logs
    found = diagnose(train, hold_out=[hold_out], effects=SOME)
    assert found.verdict is Verdict.NAMED
    assert [cause.effect for cause in found.causes] == [effect]
    assert found.base.model.name == "oscillator"
    (told,) = (issue for issue in found.issues if issue.code == PLAINER_MODEL)
    assert "by itself the muscle model predicts" in told.message
    values = {p.name.removeprefix(f"{effect}_"): p.value for p in found.causes[0].parameters}
    assert values == pytest.approx(dict(hidden.hidden[effect]), rel=0.05)


@pytest.mark.parametrize("effect", ["creep", pytest.param("static_curve", marks=pytest.mark.slow)])
def test_a_model_stays_that_explains_more(effect: str) -> None:
    """Known truth: a muscle; its creep leaves noise, a curve is held against an oscillator's."""
    train, hold_out = hidden_pair([effect], seed=502).logs
    found = diagnose(train, hold_out=[hold_out], effects=SOME)
    assert found.base.model.name == "muscle"
    assert PLAINER_MODEL not in {issue.code for issue in found.issues}
    assert [cause.effect for cause in found.causes] == [effect]


@pytest.mark.slow
def test_a_model_of_which_little_is_known_beside_its_causes_is_asked_again() -> None:
    """Known truth: an oscillator. A muscle with both causes leaves noise, too, but five of its
    seven parameters are anything."""
    hidden = ["asymmetric_damping", "hysteresis"]
    drawn = hidden_pair(hidden, seed=510, model="oscillator", protocol="levels")
    train, hold_out = drawn.logs
    found = diagnose(train, hold_out=[hold_out], effects=(*hidden, "creep", "coulomb_friction"))
    assert found.base.model.name == "oscillator"
    assert {cause.effect for cause in found.causes} == set(hidden)
    assert found.extended is not None
    assert all(p.verdict != "not identified" for p in found.extended.parameters)


@pytest.mark.slow
def test_a_model_that_was_named_stays() -> None:
    """The muscle of the first test, by the user's word."""
    train, hold_out = hidden_pair(["stiffening"], seed=501, model="oscillator").logs
    found = diagnose(train, hold_out=[hold_out], model="muscle", effects=["stiffening"])
    assert found.base.model.name == "muscle"


def recorded(
    force: Callable[[float], float], seed: int, *, cubic: float = 0.0, delay_s: float = 0.0
) -> Log:
    """M x'' + N x' + Q x + cubic x³ = force(p) on levels and ramps of 40 s, with noise."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(0.0, 40.0, 1.0 / RATE_HZ)
    turns_s = np.cumsum(np.concatenate(([3.0], rng.uniform(0.2, 1.5, 60))))
    levels = np.repeat(rng.uniform(0.0, TOP_KPA, 30), 2)
    pressure = np.interp(time_s, turns_s, np.concatenate(([0.0], levels)))

    def moved(t: float, state: np.ndarray) -> tuple[float, float]:
        x, v = state
        left = force(float(np.interp(t - delay_s, time_s, pressure)))
        return v, (left - N * v - Q * x - cubic * x**3) / M

    span = (0.0, time_s[-1])
    x = solve_ivp(moved, span, (0.0, 0.0), "LSODA", time_s, rtol=1e-6, max_step=0.05).y[0]
    angle = x + NOISE * np.ptp(x) * rng.normal(size=x.size)
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}, name=f"log {seed}")


def levelling_off(p: float) -> float:
    return 1.8 * float(np.tanh(p / 120.0))


@pytest.mark.slow
def test_a_lag_that_another_model_does_without_is_in_a_tie() -> None:
    """Known truth: a force that levels off, constant inertia, damping and stiffness.

    A muscle without inertia and a sensor that lags by one of the two poles follow it exactly; so
    does an oscillator with a curve.
    """
    logs = [recorded(levelling_off, seed) for seed in (180, 181)]
    found = diagnose(logs[0], hold_out=[logs[1]])
    assert found.base.model.name == "muscle"
    assert found.verdict is Verdict.AMBIGUOUS
    (tie,) = found.alternatives
    assert tie.effects[0] == found.causes[0].effect
    assert tie.effects[-1] == "static_curve"
    assert "Over the oscillator model, which has fewer parameters," in found.summary


@pytest.mark.slow
def test_no_lag_is_named_beside_a_delay_of_such_an_actuator() -> None:
    """Of 0.1 s: one of 0.06 s takes less than a twentieth of what the curve does, as a root mean
    square, and is described."""
    logs = [recorded(levelling_off, seed, delay_s=0.1) for seed in (180, 181)]
    found = diagnose(logs[0], hold_out=[logs[1]])
    tied = {name for tie in found.alternatives for name in tie.effects}
    sure = {cause.effect for cause in found.causes} - tied
    assert {"delay"} <= sure <= {"delay", "static_curve"}


@pytest.mark.slow
def test_a_spring_that_is_not_straight_is_no_lag_of_another_model() -> None:
    """Known truth: a spring with k3 = 15 kPa/rad³. A muscle bends to it, and what it leaves of the
    motion looks like a lag of the pneumatics then."""
    logs = [recorded(lambda p: 0.01 * p, seed, cubic=0.15) for seed in (182, 183)]
    found = diagnose(logs[0], hold_out=[logs[1]])
    assert found.base.model.name == "oscillator"
    assert [cause.effect for cause in found.causes] == ["stiffening"]
    assert found.causes[0].parameters[0].value == pytest.approx(15.0, rel=0.1)
