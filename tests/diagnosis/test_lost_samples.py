"""A diagnosis of logs whose input jumps while samples are lost."""

from __future__ import annotations

import pytest
from linear_motion import MODEL, TRUTH
from lost_samples import jump, recorded

from softid.diagnosis import diagnose
from softid.diagnosis_results import Verdict
from softid.identification.lost_input import without_lost_input

VALUES = MODEL.parameters().with_values(TRUTH).values_dict()


def test_fitted_and_held_out_logs_are_treated() -> None:
    """What depends on the loss is left out of what is fitted and of what judges, to the sample that
    the errors of the fit can move the end of it."""
    fitted = [recorded(jump()), recorded(jump(), lost=(), seed=2)]
    judge = recorded(jump(), seed=1)
    found = diagnose(fitted, hold_out=[judge], model="oscillator")
    assert found.verdict is Verdict.ADEQUATE
    by_log = {row.log: row for row in found.base.statistics}
    assert [row.in_sample for row in by_log.values()] == [True, True, False]
    for log in (fitted[0], judge):
        masked = without_lost_input(log, MODEL, VALUES).masked
        assert masked is not None
        assert masked.sum() > 25
        assert by_log[log.name].n == pytest.approx(len(log) - masked.sum(), abs=1)
    assert by_log[fitted[1].name].n == len(fitted[1])
    told = [issue.message for issue in found.issues if issue.code == "lost-input"]
    assert [message.split(":")[0] for message in told] == [fitted[0].name, judge.name]
