"""The user named a model, and another one needs no cause."""

from __future__ import annotations

import pytest

from softid.diagnosis.report.other_model import UNASKED_MODEL
from softid.diagnosis.workflow import diagnose
from softid.diagnosis_results import Verdict
from softid.synthesis import hidden_pair


def test_a_model_that_needs_no_cause_is_told_in_the_place_of_descriptions() -> None:
    """A muscle, taken for an oscillator: what that misses is no effect of any catalogue."""
    log, judge = hidden_pair([], seed=3).logs
    found = diagnose(log, hold_out=[judge], model="oscillator", effects=("delay", "creep"))
    assert found.verdict is Verdict.UNKNOWN
    (told,) = [issue for issue in found.issues if issue.code == UNASKED_MODEL]
    assert "The muscle model explains these logs by itself" in found.summary
    assert "--model muscle" in told.remedy
    assert found.next_experiment == told.remedy


@pytest.mark.parametrize("hidden", [["creep"], []])
def test_a_model_that_needs_none_itself_is_left_alone(hidden: list[str]) -> None:
    """The muscle that was named, with a cause in the logs and without."""
    log, judge = hidden_pair(hidden, seed=3).logs
    found = diagnose(log, hold_out=[judge], model="muscle", effects=("delay", "creep"))
    assert UNASKED_MODEL not in [issue.code for issue in found.issues]
