"""What becomes of names when more is known: by rule, without a search."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from handmade_diagnosis import FRICTION, TIE, diagnosis

import softid.diagnosis
from softid.diagnosis.verdict.revision import (
    exchanged_causes,
    is_outweighed_by_events,
    with_described_part,
    with_names_withdrawn,
    with_ties,
)
from softid.diagnosis_results import Doubt, Verdict
from softid.effects import effect_of


def test_no_other_file_sets_a_verdict_anew() -> None:
    """Whoever asks why a verdict changed need look in one place."""
    package = Path(softid.diagnosis.__file__).parent
    setting = [f.name for f in package.rglob("*.py") if "verdict=Verdict." in f.read_text("utf-8")]
    assert setting == ["revision.py"]


def test_causes_that_lose_their_names_come_first_among_descriptions() -> None:
    """They stay in the model, and their order is that of what they take away."""
    found = replace(diagnosis(Verdict.PARTIAL), descriptive=(replace(FRICTION, effect="creep"),))
    told = with_names_withdrawn(found)
    assert (told.verdict, told.causes) == (Verdict.UNKNOWN, ())
    assert told.descriptive == (*found.causes, *found.descriptive)
    assert told.extended is found.extended


@pytest.mark.parametrize(
    ("verdict", "doubt", "expected"),
    [
        (Verdict.PARTIAL, None, True),
        (Verdict.PARTIAL, Doubt.ONE_STEP, False),
        (Verdict.NAMED, None, False),
        (Verdict.UNKNOWN, None, False),
    ],
)
def test_an_event_outweighs_causes_that_leave_something(
    verdict: Verdict, doubt: Doubt | None, expected: bool
) -> None:
    """Without causes there is no name to take away, and what leaves noise is no event."""
    found = replace(diagnosis(verdict), descriptive=(replace(FRICTION, doubt=doubt),))
    assert is_outweighed_by_events(found) is expected


@pytest.mark.parametrize(
    ("verdict", "doubt", "part", "expected"),
    [
        (Verdict.NAMED, Doubt.AT_BOUND, 0.2, Verdict.PARTIAL),
        (Verdict.NAMED, None, 0.2, Verdict.PARTIAL),
        (Verdict.NAMED, Doubt.AT_BOUND, 0.01, Verdict.NAMED),
        (Verdict.NAMED, Doubt.MAY_BE_ZERO, 0.2, Verdict.NAMED),
        (Verdict.AMBIGUOUS, Doubt.AT_BOUND, 0.2, Verdict.AMBIGUOUS),
    ],
)
def test_a_description_that_takes_a_clear_part_leaves_the_names_a_part(
    verdict: Verdict, doubt: Doubt | None, part: float, expected: Verdict
) -> None:
    """By its share of what all take away of the held-out squares, unless it may be nothing."""
    found = diagnosis(verdict)
    (cause,) = found.causes
    named = cause.holdout_rmse_before**2 - cause.holdout_rmse_after**2
    after = cause.holdout_rmse_after
    before = (after**2 + part / (1.0 - part) * named) ** 0.5
    beside = replace(
        FRICTION, effect="creep", doubt=doubt, holdout_rmse_before=before, holdout_rmse_after=after
    )
    assert with_described_part(replace(found, descriptive=(beside,))).verdict is expected
    assert with_described_part(found).verdict is verdict


@pytest.mark.parametrize(
    ("verdict", "theirs", "lost", "added"),
    [
        (Verdict.NAMED, ["creep"], ["coulomb_friction"], ["creep"]),
        (Verdict.NAMED, ["coulomb_friction", "creep"], [], []),
        (Verdict.NAMED, [], [], []),
        (Verdict.PARTIAL, ["creep"], [], []),
    ],
)
def test_causes_that_another_model_does_without(
    verdict: Verdict, theirs: list[str], lost: list[str], added: list[str]
) -> None:
    """Those that it shares stay; one that needs no cause at all would have been chosen."""
    without, with_ = exchanged_causes(diagnosis(verdict), [effect_of(name) for name in theirs])
    assert [cause.effect for cause in without] == lost
    assert [effect.name for effect in with_] == added


def test_a_new_tie_takes_the_place_of_the_old_one() -> None:
    """Ties of other causes stay; without a new one nothing changes."""
    found = diagnosis(Verdict.AMBIGUOUS)
    other = replace(TIE, effects=("creep", "relaxation"))
    found = replace(found, verdict=Verdict.NAMED, alternatives=(TIE, other))
    new = replace(TIE, why="no chirp, and another model does without it")
    told = with_ties(found, [new], found.causes)
    assert told.verdict is Verdict.AMBIGUOUS
    assert told.alternatives == (other, new)
    assert with_ties(found, [], found.causes) is found
