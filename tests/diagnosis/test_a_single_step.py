"""What a diagnosis says of logs that hold a single step, and another one to judge by."""

from __future__ import annotations

import pytest

from softid.diagnosis import diagnose
from softid.diagnosis.report.ambiguity import SEVERAL_STEPS
from softid.diagnosis.report.other_explanations import ONE_STEP
from softid.diagnosis_results import Verdict
from softid.synthesis import hidden_pair


@pytest.mark.parametrize("model", ["muscle", pytest.param(None, marks=pytest.mark.slow)])
def test_what_it_leaves_open_is_no_cause(model: str | None) -> None:
    """Nothing is hidden: the seven parameters of a muscle are not those of one step, and a lower
    one is missed. That may be these, as the answer says; no law is described for it."""
    pair = hidden_pair([], seed=224003, protocol="step")
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model=model)
    assert found.verdict is Verdict.UNKNOWN
    assert not found.descriptive
    (told,) = [issue for issue in found.issues if issue.code == ONE_STEP]
    assert told.message[1:] in found.summary
    assert found.next_experiment == SEVERAL_STEPS
