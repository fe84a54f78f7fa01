"""Errors and gains as sentences."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from handmade_diagnosis import diagnosis

from softid.diagnosis.report.summary import write_summary
from softid.diagnosis_results import Verdict


def test_more_is_left_on_what_is_held_out() -> None:
    """0.2 degrees on the fitted samples: 0.25 held out are no more than that, 0.26 are."""
    found = diagnosis(Verdict.NAMED)
    assert found.remainder.rms * 180.0 / math.pi == pytest.approx(0.2, rel=0.01)
    for factor, more in ((1.24, False), (1.26, True)):
        gains = tuple(replace(g, rmse_after=factor * found.remainder.rms) for g in found.gains)
        text = write_summary(replace(found, gains=gains)).summary
        assert ("The held-out samples keep more" in text) is more


@pytest.mark.parametrize("verdict", [Verdict.NAMED, Verdict.PARTIAL, Verdict.UNKNOWN])
def test_what_only_the_held_out_samples_show_is_told(verdict: Verdict) -> None:
    """In each answer with the error there and what to do about it."""
    found = diagnosis(verdict)
    left = replace(found.remainder, structured=False, misses_held_out=True)
    open_end = replace(found, remainder=left, next_experiment=None)
    text = write_summary(open_end).summary
    assert "than noise and the errors of the parameters make of them: something that" in text
    assert "Next: fit what is held out together with the rest" in text
    assert "is not noise" not in text
