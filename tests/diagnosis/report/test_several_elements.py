"""A second element of a named cause, hidden by the generator."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest
from handmade_diagnosis import DELAY, diagnosis, remainder

from softid.diagnosis import diagnose
from softid.diagnosis.report import several_elements
from softid.diagnosis.report.several_elements import SEVERAL_ELEMENTS
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis_results import Diagnosis, Verdict
from softid.effects import effects_of
from softid.errors import Issue
from softid.synthesis import HiddenPair, hidden_pair


def diagnosed(pair: HiddenPair, model: str, effect: str) -> Diagnosis:
    train, hold_out = pair.logs
    return diagnose(train, hold_out=[hold_out], model=model, effects=[effect])


@pytest.mark.slow
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


def test_a_second_element_outdoes_what_is_described() -> None:
    """It explains what is left, and shows in another experiment than a rest without a name."""
    left = replace(remainder(structured=True, explained=0.99), structure_share=0.0, by={})
    two = Issue(SEVERAL_ELEMENTS, "info", "the material creeps with more than one time", "hold on")
    found = replace(diagnosis(Verdict.PARTIAL), descriptive=(DELAY,), remainder=left)
    alone = write_summary(found).summary
    assert "follows from no variable that was looked at" in alone
    text = write_summary(replace(found, issues=(two,))).summary
    outdone = (
        "Besides, delay of the input describes a part of the rest, but a second element of the "
        "cause does so better. With all of them the error goes"
    )
    assert outdone in text
    assert text.index("What is left") < text.index("The material creeps with more than one time.")
    assert "follows from no variable" not in text
    assert "Next: hold on." in text


@pytest.mark.parametrize(("excess", "is_told"), [(0.0, False), (1.0, True)])
def test_of_what_passes_for_noise_none_is_taken(
    excess: float, is_told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where all that is left counts as slow noise, a likelier second element is none."""
    left = replace(remainder(structured=False, explained=0.99), excess=excess, colour_s=1.0)
    found = replace(diagnosis(Verdict.NAMED), remainder=left)
    creep = effects_of(["creep"])[0]
    final, other = (SimpleNamespace(squares=squares, acting=(creep,)) for squares in (2.0, 1.0))
    issue = Issue(SEVERAL_ELEMENTS, "info", "two", None)
    monkeypatch.setattr(several_elements, "standing_of", lambda *args: None)
    monkeypatch.setattr(several_elements, "refitted_with", lambda *args, **kwargs: other)
    monkeypatch.setattr(several_elements, "_is_better", lambda *args: True)
    monkeypatch.setattr(several_elements, "_issue", lambda *args: issue)
    links: Any = [SimpleNamespace(added=creep)]
    nothing: Any = None
    answer = several_elements.with_several_elements(found, links, cast("Any", final), nothing)
    assert (issue in answer.issues) is is_told


@pytest.mark.parametrize("effect", ["creep", "hysteresis"])
def test_one_element_has_no_second(effect: str) -> None:
    """Nor is one asked for where it leaves noise and nothing is described beside it."""
    found = diagnosed(hidden_pair([effect], seed=230001, model="oscillator"), "oscillator", effect)
    assert found.verdict is Verdict.NAMED
    assert SEVERAL_ELEMENTS not in {issue.code for issue in found.issues}
