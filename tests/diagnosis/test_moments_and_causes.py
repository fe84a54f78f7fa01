"""A misfit that begins at one moment beside causes that leave more than noise."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from handmade_diagnosis import diagnosis

from softid.diagnosis import completion, diagnose
from softid.diagnosis.report.changes import CHANGE_POINT, HELD_OUT_CHANGE
from softid.diagnosis.report.unlisted_texts import UNLISTED_LAW
from softid.diagnosis_results import Verdict
from softid.errors import Issue
from softid.synthesis import hidden_pair

MOMENT = Issue(CHANGE_POINT, "warning", "the misfit of angle begins at 3 s", "look at it")


@pytest.mark.parametrize(
    ("verdict", "begins", "told"),
    [
        (Verdict.PARTIAL, True, Verdict.UNKNOWN),
        (Verdict.PARTIAL, False, Verdict.PARTIAL),
        (Verdict.NAMED, True, Verdict.NAMED),
        (Verdict.UNKNOWN, True, Verdict.UNKNOWN),
    ],
)
def test_a_moment_outweighs_causes_that_leave_more_than_noise(
    verdict: Verdict, begins: bool, told: Verdict
) -> None:
    """What begins at one moment does not go on throughout; what leaves noise is not asked."""
    found, told_else = diagnosis(verdict), (MOMENT,) if begins else ()
    others: Any = SimpleNamespace(events=lambda *args: told_else, all=lambda *args: told_else)
    case: Any = SimpleNamespace(base=None, others=others, begun_anew=None)
    answer = completion._what_else_it_is(found, case)
    assert answer.verdict is told
    is_withheld = told is Verdict.UNKNOWN
    assert len(answer.descriptive) == len((*found.causes, *found.descriptive)) or not is_withheld
    assert bool(answer.causes) is not is_withheld
    assert (MOMENT in answer.issues) is (is_withheld and begins)


@pytest.mark.parametrize(
    ("is_structured", "asked"), [(True, ["all"]), (False, [])], ids=["left", "noise"]
)
def test_what_is_held_out_differs_and_the_rest_is_asked_where_it_leaves_something(
    is_structured: bool, asked: list[str]
) -> None:
    """What is told of held-out logs explains no misfit of the fitted ones."""
    held = Issue(HELD_OUT_CHANGE, "warning", "the logs differ", "diagnose them apart")
    found = diagnosis(Verdict.UNKNOWN)
    left = replace(found.remainder, structured=is_structured)
    found = replace(found, issues=(held,), remainder=left, causes=())
    met: list[str] = []

    def noted(name: str) -> Any:
        return lambda *args: met.append(name) or ()

    others: Any = SimpleNamespace(events=noted("events"), all=noted("all"))
    case: Any = SimpleNamespace(base=None, others=others, begun_anew=None)
    answer = completion._what_else_it_is(found, case)
    assert met == asked
    assert answer.next_experiment == held.remedy


@pytest.mark.slow
def test_a_law_in_no_catalogue_is_told_in_place_of_descriptions() -> None:
    """The paragraph of an unknown cause; the verdict stays."""
    (log, judge) = hidden_pair(["output_backlash"], seed=710008).logs
    found = diagnose(log, hold_out=[judge], model="muscle", effects=["creep", "delay"])
    assert found.verdict is Verdict.UNKNOWN
    assert [issue.code for issue in found.issues].count(UNLISTED_LAW) == 1
    assert "play between the actuator and its sensor" in found.summary
    assert found.next_experiment is not None
    assert "small moves up and down" in found.next_experiment
