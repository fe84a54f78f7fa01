"""What is said of a misfit beside a law in no catalogue."""

from __future__ import annotations

from dataclasses import replace

import pytest
from handmade_diagnosis import diagnosis

from softid.diagnosis.report.remarks import Remarks
from softid.diagnosis.report.summary import summarise
from softid.diagnosis.report.unlisted_texts import LIKE_UNLISTED_LAW, UNLISTED_LAW
from softid.diagnosis_results import Doubt, Verdict
from softid.errors import Issue


@pytest.mark.parametrize("code", [UNLISTED_LAW, LIKE_UNLISTED_LAW])
def test_a_description_that_leaves_noise_is_told_beside_a_law(code: str) -> None:
    """And why it is no more; where it leaves structure, nobody asks why it is no cause."""
    found = diagnosis(Verdict.UNKNOWN)
    slow = tuple(replace(cause, doubt=Doubt.TOO_SLOW) for cause in found.descriptive)
    law = Issue(code, "info", "what is missing behaves like play")
    loud = replace(found, descriptive=slow, issues=(*found.issues, law))
    left = replace(found.remainder, structured=False, explained_share=0.99)
    quiet = replace(loud, remainder=left)
    text = summarise(quiet, Remarks.of(quiet))
    assert "behaves like play. Of the effects in the catalogue, dry friction takes away" in text
    assert "Dry friction may be slower than these logs can tell." in text
    assert "may be slower" not in summarise(loud, Remarks.of(loud))
