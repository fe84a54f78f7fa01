"""A second element of a named cause, hidden by the generator."""

from __future__ import annotations

import re

import pytest

from softid.diagnosis import diagnose
from softid.diagnosis.report.several_elements import SEVERAL_ELEMENTS
from softid.diagnosis_results import Diagnosis, Verdict
from softid.synthesis import HiddenPair, hidden_pair


def diagnosed(pair: HiddenPair, model: str, effect: str) -> Diagnosis:
    train, hold_out = pair.logs
    return diagnose(train, hold_out=[hold_out], model=model, effects=[effect])


def test_a_creep_of_two_times_is_told_with_both() -> None:
    """Known truth: two elements, whose times are told to a twentieth."""
    pair = hidden_pair(["two_time_creep"], seed=230001, model="oscillator")
    found = diagnosed(pair, "oscillator", "creep")
    assert found.verdict is Verdict.PARTIAL
    (told,) = [issue.message for issue in found.issues if issue.code == SEVERAL_ELEMENTS]
    times = sorted(float(value) for value in re.findall(r"([\d.]+) s for", told))
    true = pair.hidden["two_time_creep"]
    assert times == pytest.approx(sorted((true["tau1"], true["tau2"])), rel=0.05)
    assert told[1:] in found.summary


@pytest.mark.parametrize("effect", ["creep", "hysteresis"])
def test_one_element_has_no_second(effect: str) -> None:
    """Nor is one asked for where it leaves noise and nothing is described beside it."""
    found = diagnosed(hidden_pair([effect], seed=230001, model="oscillator"), "oscillator", effect)
    assert found.verdict is Verdict.NAMED
    assert SEVERAL_ELEMENTS not in {issue.code for issue in found.issues}
