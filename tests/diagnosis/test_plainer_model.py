"""Which model a first cause extends, where nobody named one."""

from __future__ import annotations

import pytest

from softid.diagnosis import diagnose
from softid.diagnosis.plainer_model import PLAINER_MODEL
from softid.diagnosis_results import Verdict
from softid.synthesis import hidden_pair

SOME = ("contact", "creep", "delay", "static_curve", "stiffening")


@pytest.mark.slow
@pytest.mark.parametrize("effect", ["contact", "stiffening"])
def test_a_plainer_model_with_its_cause_takes_the_place_of_one_that_bends_to_it(
    effect: str,
) -> None:
    """Known truth: an oscillator that meets a wall, or whose spring is not straight.

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


def test_a_model_that_was_named_stays() -> None:
    """The muscle of the first test, by the user's word."""
    train, hold_out = hidden_pair(["stiffening"], seed=501, model="oscillator").logs
    found = diagnose(train, hold_out=[hold_out], model="muscle", effects=["stiffening"])
    assert found.base.model.name == "muscle"
