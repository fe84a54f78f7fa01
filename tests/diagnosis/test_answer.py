"""What an answer says of causes that others need."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from handmade_diagnosis import FRICTION
from handmade_searches import base_fit, chain_of
from linear_motion import MODEL, SIGMA, TRUTH, base_problem, linear_angle, standing

from softid.diagnosis import answer, diagnose
from softid.diagnosis.refit.extension import extend
from softid.diagnosis.search.order_of_size import prefix_models
from softid.diagnosis.verdict import doubts
from softid.diagnosis.verdict.naming import doubt_of
from softid.diagnosis_results import Cause, Doubt
from softid.effects import effect_of
from softid.effects.base import Effect
from softid.identification.assembly import OptimisedProblem
from softid.identification.parameter_constraints import ParameterConstraints
from softid.log import Log
from softid.synthesis import hidden_pair


@pytest.mark.parametrize(
    ("interval", "is_told"),
    [((0.1, 0.9), True), ((0.0, 0.9), True), ((-0.1, 0.9), False), (None, True)],
    ids=["gain", "no loss", "perhaps a loss", "too few samples"],
)
def test_what_others_leave_without_a_cause_speaks_for_it_where_it_is_no_loss(
    interval: tuple[float, float] | None, is_told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first of two causes gains nothing alone. An interval that begins at 0 holds no loss, for
    that is where it is cut off if the error falls throughout the logs."""
    alone = replace(FRICTION, holdout_rmse_after=FRICTION.holdout_rmse_before)
    monkeypatch.setattr(answer, "refit_without", lambda *args: None)
    monkeypatch.setattr(answer, "gain_interval", lambda *args: interval)
    errors = np.ones(10)
    held_out: Any = SimpleNamespace(first_errors=lambda model: errors, rms=lambda model: 1.7)
    chain = chain_of("coulomb_friction", "delay")
    found, _ = answer._with_errors_without(
        (alone, FRICTION), chain, base_fit(), held_out, errors, ()
    )
    assert found.holdout_rmse_without == (1.7 if is_told else None)


def test_all_errors_are_those_of_the_model_that_was_refined(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Behind jumps at unknown moments: else the gain is that of one model, its interval another's.

    The causes before the last one are those that the search left.
    """
    refined: Any = SimpleNamespace()
    monkeypatch.setattr(answer, "noise_with_moments", lambda *args: "noise")
    monkeypatch.setattr(answer, "refined_under", lambda *args: refined)
    chain = chain_of("coulomb_friction", "delay")
    chain = replace(chain, links=tuple(replace(link, found=link.before) for link in chain.links))
    base = base_fit()
    found, _ = answer._with_open_moments(chain, base)
    assert found.final is refined
    assert prefix_models(found, base.candidate)[-1] is refined
    assert found.links[0] is chain.links[0]


def test_bounds_of_the_user_stay_theirs_beside_causes(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same parameter is judged with its bounds over the base; a cause has none of the user."""
    own = MODEL.parameters()
    bounded = own.replacing(replace(own["N"], value=10.0, lower=9.0, upper=11.0))
    constraints = ParameterConstraints.of(own, bounded)
    problem, scale = base_problem()
    extended = extend(problem, [effect_of("sensor_drift")], scale)
    final = standing(extended, np.zeros(extended.size))
    assembled: list[OptimisedProblem] = []
    monkeypatch.setattr(answer, "_assembled", lambda found, *args: assembled.append(found))
    known: Any = SimpleNamespace(
        found=SimpleNamespace(
            unseen={}, optimum=SimpleNamespace(sigma=SIGMA), constraints=constraints
        )
    )
    answer._fit_of(final, known, 0, {})
    names = [n for n in extended.parameters.names if assembled[0].constraints.bounds(n)]
    assert names == ["N"]


def late_and_drifting(seed: int) -> Log:
    """Steps of a slow actuator at 500 Hz that are read late by a quarter of a second, and drift."""
    time_s = np.arange(13000) / 500.0
    levels = np.random.default_rng(seed).uniform(0.0, 80.0, 6)
    pressure = np.repeat(levels, 2500)[: time_s.size]
    late = np.concatenate((np.full(125, pressure[0]), pressure[:-125]))
    angle = linear_angle(time_s, late, TRUTH | {"N": 100.0}) + 0.01 * time_s
    angle += 0.02 * np.random.default_rng(seed + 1).standard_normal(time_s.size)
    channels = {"pressure": pressure, "angle": angle}
    return Log.from_arrays(time_s, channels, name=f"late {seed}").with_intersample("straight")


@pytest.mark.slow
def test_leaving_nothing_out_leaves_the_same_error_of_averages(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An identity: where the others without a cause are the model with all of them, it gains
    nothing. Of means of several samples the whole had half the error of its samples, so that any
    cause seemed to be needed."""
    told: list[tuple[float | None, float]] = []

    def spy(cause: Cause, effect: Effect, fit: Any, whole: float, *, varies: float) -> Doubt | None:
        told.append((cause.holdout_rmse_without, whole))
        return doubt_of(cause, effect, fit, whole, varies=varies)

    monkeypatch.setattr(answer, "asks_for_the_others", lambda *args: True)
    monkeypatch.setattr(answer, "refit_without", lambda chain, *args: chain.final)
    monkeypatch.setattr(doubts, "doubt_of", spy)
    found = diagnose(
        late_and_drifting(10),
        hold_out=[late_and_drifting(20)],
        model="oscillator",
        effects=["sensor_drift", "delay"],
    )
    assert "averaged" in {issue.code for issue in found.issues}
    assert len(told) >= 2
    for without, whole in told:
        assert without == pytest.approx(whole, rel=1e-9)


def test_a_term_that_the_base_could_not_see_is_known_beside_a_cause() -> None:
    """Known truth: behind a hysteresis the inertia is lost, and beside it it is known to 2 %."""
    pair = hidden_pair(
        ["hysteresis"], seed=226000, model="oscillator", protocol="triangles", size=2.0
    )
    train, hold_out = pair.logs
    found = diagnose(train, hold_out=[hold_out], model="oscillator", effects=["hysteresis"])
    assert found.extended is not None
    (before, after) = (
        next(p for p in fit.parameters if p.name == "M") for fit in (found.base, found.extended)
    )
    assert before.verdict == "not identified"
    assert after.verdict == "identified"
    assert after.ci95 is not None
    assert after.ci95[0] < pair.actuator.values["M"] < after.ci95[1]
    assert "not-seen" not in {issue.code for issue in found.issues}
