"""A misfit that begins at one moment beside causes that leave more than noise."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from handmade_diagnosis import diagnosis

from softid.diagnosis.base.base_fit import Request
from softid.diagnosis.report import changes
from softid.diagnosis.report.changes import CHANGE_POINT
from softid.diagnosis_results import Verdict
from softid.errors import Issue

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
    verdict: Verdict, begins: bool, told: Verdict, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What begins at one moment does not go on throughout; what leaves noise is not asked."""
    monkeypatch.setattr(changes, "change_issues", lambda *args: (MOMENT,) if begins else ())
    monkeypatch.setattr(changes, "excess_of", lambda *args: 1.0)
    for other in ("spell_issues", "difference_issues"):
        monkeypatch.setattr(changes, other, lambda *args: ())
    problem = SimpleNamespace(model=None)
    base: Any = SimpleNamespace(candidate=SimpleNamespace(problem=problem), scale=None)
    recordings: Any = None
    request = Request(None, None, 0, lambda message, fraction: None)
    found = diagnosis(verdict)
    answer = changes.with_changes(found, recordings, request, base)
    assert answer.verdict is told
    is_withheld = told is Verdict.UNKNOWN
    assert len(answer.descriptive) == len((*found.causes, *found.descriptive)) or not is_withheld
    assert bool(answer.causes) is not is_withheld
    assert (MOMENT in answer.issues) is (is_withheld and begins)
