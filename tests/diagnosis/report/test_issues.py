"""What a user is told about how a diagnosis was made."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from handmade_diagnosis import cause, diagnosis
from handmade_rounds import link

from softid.diagnosis.report.issues import refusal_issues, unsure_issues
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis_results import Doubt, Verdict


def judge(before: float, after: float) -> Any:
    """Held-out samples on which the base, which has no effects, and a law have such errors."""
    return SimpleNamespace(rms=lambda candidate: after if candidate.effects else before)


@pytest.mark.parametrize(
    ("after", "words"),
    [(1.4, "adds 40 % to it"), (1.0, "leaves it as it is"), (0.98, None), (0.5, None)],
)
def test_a_law_that_what_is_held_out_refuses_is_told(after: float, words: str | None) -> None:
    """A delay halves the squares of the fitted samples and lowers the BIC by 300."""
    found = link(300.0)
    nothing = Chain((), found, found.before.candidate)
    told = refusal_issues(nothing, judge(1.0, after))
    assert bool(told) is (words is not None)
    if words is not None:
        assert words in told[0].message
        assert "would take away 50 % of the squared error on the fitted samples" in told[0].message
        shown = write_summary(replace(diagnosis(Verdict.UNKNOWN), causes=(), issues=told))
        assert words in shown.summary


@pytest.mark.parametrize(
    ("key", "left", "anew"),
    [("delay", 50.0, False), ("softening", 50.0, True), ("softening", 95.0, False)],
)
def test_what_begins_with_a_log_may_have_begun_before(key: str, left: float, anew: bool) -> None:
    """A rubber that the first log has worn in is worn in when the second begins; but one that
    explains a twentieth is no reason to record anything for it."""
    found = link(300.0, key=key, after=left)
    (told,) = refusal_issues(Chain((), found, found.before.candidate), judge(1.0, 1.4))
    assert told.remedy is not None
    assert ("recorded after the others" in told.remedy) is anew
    assert "blocks of the logs judge" in told.remedy
    shown = write_summary(replace(diagnosis(Verdict.UNKNOWN), causes=(), issues=(told,)))
    assert (shown.next_experiment == told.remedy) is anew
    assert "adds 40 % to it" in shown.summary


def test_nothing_is_refused_that_did_not_pay_or_was_added() -> None:
    """A fall of the BIC by 10 is chance; a chain with a link has its cause; and a law that takes
    away half a hundredth has nothing to be refused."""
    chance, found, slight = link(10.0), link(300.0), link(300.0, after=99.5)
    assert not refusal_issues(Chain((), slight, slight.before.candidate), judge(1.0, 2.0))
    assert not refusal_issues(Chain((), chance, chance.before.candidate), judge(1.0, 2.0))
    assert not refusal_issues(Chain((found,), found, found.chosen.plain), judge(1.0, 2.0))
    assert not refusal_issues(Chain((), None, found.before.candidate), judge(1.0, 2.0))


def test_laws_that_may_be_chance_are_told_with_what_speaks_against_them() -> None:
    """The fall of the BIC of 412 beside the doubt; none for a law of which nothing is doubted."""
    sure = cause("creep", [], before=2.0, after=1.0)
    unsure = replace(sure, doubt=Doubt.MAY_GAIN_NOTHING)
    (told,) = unsure_issues([sure, unsure])
    assert (
        "creep of the material would lower the BIC by 412, but it is not confirmed" in told.message
    )
    assert told.remedy == "record more of the same moves, which would show whether it is there"
    (quick,) = unsure_issues([replace(sure, doubt=Doubt.TOO_QUICK)])
    assert quick.remedy == "sample the input faster, which would show what it does meanwhile"
    found = replace(diagnosis(Verdict.ADEQUATE), issues=(told,))
    assert "None of the effects tried can be claimed." in write_summary(found).summary
    assert "Creep of the material would lower the BIC by 412" in write_summary(found).summary
