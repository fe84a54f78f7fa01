"""What a reader cannot act on stays in the record, and out of the paragraph."""

from __future__ import annotations

from dataclasses import replace

import pytest
from handmade_diagnosis import DELAY, TIE, cause, diagnosis

from softid.diagnosis.logs.permanent_set import RESIDUAL_SET
from softid.diagnosis.report.changes import CHANGE_POINT
from softid.diagnosis.report.remarks import LEAVE_A_SET
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis.report.unlisted_texts import LAW_BESIDE, LIKE_UNLISTED_LAW
from softid.diagnosis_results import Alternative, Diagnosis, Doubt, Variation, Verdict
from softid.effects import EFFECTS
from softid.errors import Issue

SETS = tuple(Issue(RESIDUAL_SET, "info", f"log {k} keeps a set") for k in (1, 2))


def told(found: Diagnosis) -> str:
    """The paragraph."""
    return write_summary(found).summary


def test_a_set_is_told_once_and_not_beside_what_leaves_one() -> None:
    """Of two logs the first; a named creep, a tie with one or what changed at once explains it."""
    found = replace(diagnosis(Verdict.PARTIAL), issues=SETS, alternatives=())
    text = told(found)
    assert "Log 1 keeps a set." in text
    assert "Log 2" not in text
    creep = cause("creep", (), before=2.0, after=0.5)
    assert "keeps a set" not in told(replace(found, causes=(creep,)))
    tie = Alternative(("coulomb_friction", "hysteresis"), {"hysteresis": 1.0}, "no slow loops")
    assert "keeps a set" not in told(replace(found, alternatives=(tie,)))
    unknown = replace(diagnosis(Verdict.UNKNOWN), issues=SETS, alternatives=(tie,))
    assert "Log 1 keeps a set." in told(unknown)  # a tie of descriptions explains nothing
    moment = Issue(CHANGE_POINT, "warning", "the misfit begins at 3 s", "look then")
    assert "keeps a set" not in told(replace(unknown, issues=(*SETS, moment)))


def test_what_leaves_a_set_is_in_the_catalogue() -> None:
    """So that a cause which is renamed is not overlooked."""
    assert set(LEAVE_A_SET) <= {key.split(".")[0] for key in EFFECTS}


def test_of_a_law_in_no_catalogue_the_descriptions_are_beside_the_point() -> None:
    """The law comes first; why what takes away less is no cause, and its rest, are not told."""
    law = Issue(LIKE_UNLISTED_LAW, "info", "what is missing behaves like a law", "look at it")
    found = diagnosis(Verdict.UNKNOWN)
    doubted = tuple(replace(c, doubt=Doubt.CANCELS) for c in found.descriptive)
    found = replace(found, descriptive=doubted)
    assert "nearly cancels another" in told(found)
    assert "Look at the plots" in told(found)
    text = told(replace(found, issues=(law,), next_experiment="look at it"))
    assert (
        "none of the effects tried can be named for it. What is missing behaves like a law. Of the "
        "effects in the catalogue, dry friction takes away 60 % on the fitted samples, and "
        "100 % on those held out. Next: look at it." in text
    )
    assert "cancels" not in text
    assert "plots" not in text


def test_a_law_of_what_descriptions_leave_comes_behind_them() -> None:
    """It stands in the place of what the rest follows, which is part of the law."""
    law = Issue(LAW_BESIDE, "info", "what is left behaves like a law", "look at it")
    for verdict in (Verdict.UNKNOWN, Verdict.PARTIAL):
        found = diagnosis(verdict)
        assert "is not noise: 37 % of its power follows" in told(found)
        text = told(replace(found, issues=(law,)))
        assert "What is left, 0.2 deg rms on the fitted samples, behaves like a law." in text
        assert text.count("behaves like a law") == 1
        assert "of its power" not in text
        assert text.index("dry friction") < text.index("behaves like a law")


@pytest.mark.parametrize(("count", "named"), [(5, 5), (6, 4), (8, 4)])
def test_a_long_tie_is_told_by_its_ends(count: int, named: int) -> None:
    """The first three, and the last, which may stand in the place of several causes."""
    keys = ("delay", "pneumatic_lag", "sensor_lag", "line_resonance", "sensor_resonance")
    keys = (*keys, "valve_flow", "clock_rate", "smoothing")[:count]
    tie = Alternative(keys, dict.fromkeys(keys, 1.0), "no chirp")
    found = replace(diagnosis(Verdict.AMBIGUOUS), causes=(DELAY,), alternatives=(tie,))
    opening = told(found).partition("do not say which: ")[2].partition(". ")[0]
    titles = [EFFECTS[key].title for key in keys]
    assert sum(f"{title[:1].lower()}{title[1:]}" in opening for title in titles) == named
    assert (f", {count - named} more or " in opening) is (count > named)
    assert write_summary(found).alternatives[0].keys == keys


def test_a_class_that_is_not_named_whole_is_told_with_its_members() -> None:
    """In a tie the delay alone is named, so what no log tells it from is news."""
    text = told(replace(diagnosis(Verdict.AMBIGUOUS), alternatives=(TIE,)))
    assert (
        "No log of pressure and motion tells a delay of the input from an offset between the "
        "clocks of the two channels. " in text
    )


def test_that_a_tied_law_is_not_exactly_this_one_is_told_by_the_tie() -> None:
    """A size that varies is a doubt about a cause that is named alone."""
    varied = replace(DELAY, variation=Variation("x", 0.02, 0.1, 1e-9))
    found = replace(diagnosis(Verdict.PARTIAL), causes=(varied,), alternatives=())
    assert "Its size varies by about 2 % with the position" in told(found)
    assert "Its size" not in told(replace(found, alternatives=(TIE,)))
