"""What is said of a misfit beside a law in no catalogue."""

from __future__ import annotations

from dataclasses import replace

import pytest
from handmade_diagnosis import diagnosis

from softid.diagnosis.report.remarks import Remarks
from softid.diagnosis.report.summary import summarise
from softid.diagnosis.report.unlisted_texts import LIKE_UNLISTED_LAW, UNLISTED_LAW
from softid.diagnosis.searches.fitted_together import NOT_TOGETHER
from softid.diagnosis_results import Doubt, Verdict
from softid.errors import Issue


@pytest.mark.parametrize(
    ("code", "held_out", "held"),
    [(UNLISTED_LAW, 0.4, "40 %"), (LIKE_UNLISTED_LAW, -0.2, "nothing")],
)
def test_a_description_that_leaves_noise_is_told_beside_a_law(
    code: str, held_out: float, held: str
) -> None:
    """And why it is no more; where it leaves structure, nobody asks why it is no cause."""
    found = diagnosis(Verdict.UNKNOWN)
    slow = tuple(replace(cause, doubt=Doubt.TOO_SLOW) for cause in found.descriptive)
    law = Issue(code, "info", "what is missing behaves like play")
    loud = replace(found, descriptive=slow, issues=(*found.issues, law))
    left = replace(found.remainder, structured=False, explained_share=0.99, held_out_share=held_out)
    quiet = replace(loud, remainder=left)
    text = summarise(quiet, Remarks.of(quiet))
    assert (
        "behaves like play. Of the effects in the catalogue, dry friction takes away 99 %" in text
    )
    assert f"on the fitted samples, and {held} on those held out." in text
    assert "Dry friction may be slower than these logs can tell." in text
    assert "may be slower" not in summarise(loud, Remarks.of(loud))


def test_a_law_is_told_beside_what_logs_do_not_share() -> None:
    """That no parameters follow the logs together does not say what is missing; a law does."""
    apart = Issue(NOT_TOGETHER, "warning", "no parameters follow both")
    law = Issue(LIKE_UNLISTED_LAW, "info", "what is missing behaves like play")
    found = replace(diagnosis(Verdict.UNKNOWN), causes=(), descriptive=(), issues=(apart, law))
    text = summarise(found, Remarks.of(found))
    assert "No parameters follow both. What is missing behaves like play." in text
