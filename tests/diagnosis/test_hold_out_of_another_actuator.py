"""A hold-out from another actuator speaks against the model, and not against the cause alone."""

from __future__ import annotations

from dataclasses import replace

from softid.diagnosis import diagnose
from softid.diagnosis.report.changes import HELD_OUT_CHANGE
from softid.diagnosis_results import Verdict
from softid.synthesis import hidden_pair


def test_it_is_said_what_differs() -> None:
    """Known truth: creep in both, and a stiffness that is 38 % larger in the second."""
    own = hidden_pair(["creep"], seed=41)
    values = dict(own.actuator.values)
    stiffer = replace(own.actuator, values={**values, "c1": 1.38 * values["c1"]})
    other = hidden_pair(["creep"], seed=41, actuator=stiffer, values=own.hidden)
    found = diagnose(own.logs[0], hold_out=[other.logs[1]], model="muscle")
    assert found.verdict is Verdict.UNKNOWN
    assert [cause.effect for cause in found.descriptive] == ["creep"]
    (told,) = [issue for issue in found.issues if issue.code == HELD_OUT_CHANGE]
    assert "c1 of the model changes by +3" in told.message
    assert told.message in found.summary.replace("The logs differ", "the logs differ")
