"""What a paragraph says of a rest of which a remark tells what it is."""

from __future__ import annotations

from dataclasses import replace

import pytest
from handmade_diagnosis import diagnosis

from softid.diagnosis.report.coarse_sampling import COARSE_SAMPLING
from softid.diagnosis.report.other_explanations import EVENT_BESIDE
from softid.diagnosis.report.rounding import COARSE_INPUT
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis_results import Verdict
from softid.errors import Issue

GUESS = "a law with a memory"


@pytest.mark.parametrize("code", [EVENT_BESIDE, COARSE_INPUT, COARSE_SAMPLING])
@pytest.mark.parametrize("verdict", [Verdict.UNKNOWN, Verdict.PARTIAL])
def test_what_is_told_is_not_guessed(code: str, verdict: Verdict) -> None:
    """Without the remark the paragraph guesses; with it, it says what the remark does."""
    found = diagnosis(verdict)
    rest = replace(
        found.remainder, structured=True, structure_share=0.0, by={}, noise_from_rest=False
    )
    found = replace(found, remainder=rest, issues=(), alternatives=())
    told = replace(found, issues=(Issue(code, "warning", "it is known"),))
    assert GUESS in write_summary(found).summary
    summary = write_summary(told).summary
    assert GUESS not in summary
    assert "follows from no variable" not in summary
    assert "It is known." in summary
