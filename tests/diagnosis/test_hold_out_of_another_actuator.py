"""A hold-out from another actuator speaks against the model, and not against the cause alone."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from softid.diagnosis import diagnose
from softid.diagnosis.report.changes import HELD_OUT_CHANGE
from softid.diagnosis_results import Verdict
from softid.synthesis import Actuator, hidden_pair


def with_values(actuator: Actuator, **factors: float) -> Actuator:
    """The actuator with parameters that are so many times as large."""
    changed = {name: factor * actuator.values[name] for name, factor in factors.items()}
    return replace(actuator, values={**actuator.values, **changed})


@pytest.mark.slow
def test_it_is_said_what_differs() -> None:
    """Known truth: creep in both, and a stiffness that is 38 % larger in the second."""
    own = hidden_pair(["creep"], seed=41)
    stiffer = with_values(own.actuator, c1=1.38)
    other = hidden_pair(["creep"], seed=41, actuator=stiffer, values=own.hidden)
    found = diagnose(own.logs[0], hold_out=[other.logs[1]], model="muscle")
    assert found.verdict is Verdict.PARTIAL
    assert [cause.effect for cause in found.causes] == ["creep"]
    (told,) = [issue for issue in found.issues if issue.code == HELD_OUT_CHANGE]
    assert "c1 of the model changes by +3" in told.message
    assert told.message in found.summary.replace("The logs differ", "the logs differ")


@pytest.mark.slow
def test_a_payload_in_the_hold_out_does_not_hide_the_cause() -> None:
    """Known truth: creep in both; the second moves twice the mass, and is 6 % stiffer by it."""
    light = hidden_pair(["creep"], seed=41).actuator
    heavy = with_values(light, M=4.0)
    own = hidden_pair(["creep"], seed=41, actuator=heavy)
    loaded = with_values(heavy, M=2.0, c1=1.06)
    other = hidden_pair(["creep"], seed=41, actuator=loaded, values=own.hidden)
    found = diagnose(own.logs[0], hold_out=[other.logs[1]], model="muscle")
    assert found.verdict is Verdict.PARTIAL
    assert [cause.effect for cause in found.causes] == ["creep"]
    (told,) = [issue for issue in found.issues if issue.code == HELD_OUT_CHANGE]
    assert "the inertia M changes by +" in told.message
    assert "as with another payload" in told.message
    assert "hardly show" not in found.summary


@pytest.mark.slow
def test_a_cause_gains_beside_what_is_held_out_differs_in() -> None:
    """Known truth: the input is late in both; a payload hides in the second what that does.

    The error there is nearly the same with the delay and without, and falls where the inertia is
    its own.
    """
    own = hidden_pair(["delay"], seed=11, model="oscillator")
    loaded = with_values(own.actuator, M=3.5)
    other = hidden_pair(["delay"], seed=11, actuator=loaded, values=own.hidden, model="oscillator")
    found = diagnose(own.logs[0], hold_out=[other.logs[1]], model="oscillator")
    assert found.verdict is Verdict.PARTIAL
    assert [cause.effect for cause in found.causes] == ["delay"]
    (told,) = [issue for issue in found.issues if issue.code == HELD_OUT_CHANGE]
    assert "the inertia M changes by +" in told.message
    gained = re.search(r"what was found takes away ([0-9]+) % of the error there", told.message)
    assert gained is not None
    assert int(gained[1]) > 30
