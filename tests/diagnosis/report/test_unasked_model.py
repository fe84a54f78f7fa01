"""The user named a model, and another one needs no cause."""

from __future__ import annotations

import pytest

from softid.diagnosis.report.other_model import UNASKED_MODEL
from softid.diagnosis.workflow import diagnose
from softid.diagnosis_results import Verdict
from softid.synthesis import hidden_pair


@pytest.mark.slow
def test_a_model_that_needs_no_cause_is_told_in_the_place_of_descriptions() -> None:
    """A muscle, taken for an oscillator: what that misses is no effect of any catalogue."""
    log, judge = hidden_pair([], seed=3).logs
    found = diagnose(log, hold_out=[judge], model="oscillator", effects=("delay", "creep"))
    assert found.verdict is Verdict.UNKNOWN
    (told,) = [issue for issue in found.issues if issue.code == UNASKED_MODEL]
    assert "The muscle model explains these logs by itself" in found.summary
    assert "--model muscle" in told.remedy
    assert found.next_experiment == told.remedy


@pytest.mark.parametrize("model", ["muscle", pytest.param("oscillator", marks=pytest.mark.slow)])
def test_a_misfit_that_no_model_explains_is_left_alone(model: str) -> None:
    """A damping by position: the muscle, which would be chosen, leaves more than noise itself."""
    log, judge = hidden_pair(["position_damping"], seed=3).logs
    found = diagnose(log, hold_out=[judge], model=model, effects=("delay", "creep"))
    assert found.verdict is Verdict.UNKNOWN
    assert UNASKED_MODEL not in [issue.code for issue in found.issues]
