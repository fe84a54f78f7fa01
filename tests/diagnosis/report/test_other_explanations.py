"""What explains a misfit that no cause does, and in which order it is asked."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest
from handmade_diagnosis import cause, diagnosis

from softid.diagnosis.report import other_explanations
from softid.diagnosis.report.other_explanations import (
    EVENT_BESIDE,
    OtherExplanations,
    with_event_beside,
    with_law_beside,
)
from softid.diagnosis.report.unlisted_texts import (
    LAW_BESIDE,
    LIKE_UNLISTED_LAW,
    UNLISTED_LAW,
    unlisted_issue,
)
from softid.diagnosis.verdict.beyond_catalogue import BeyondCatalogue
from softid.diagnosis.verdict.separations import STEPS
from softid.diagnosis.verdict.unlisted_laws import (
    NEAR_ONE,
    EarlyReading,
    InputPlay,
    OutputPlay,
    SwingingPart,
)
from softid.diagnosis_results import Verdict
from softid.effects import effect_of
from softid.errors import Issue


class Base:
    """What no explanation here looks at."""

    scale = None
    candidate = SimpleNamespace(problem=SimpleNamespace(logs=()))


DIFFERS, JUMPS, SPELL, MIXED = (Issue(name, "warning", name) for name in "abcd")
LAW = BeyondCatalogue((OutputPlay(),), 0.99, 0.98, 1.0, 1.0, ((0.03, "1"),))


@pytest.mark.parametrize(("squares", "outdone"), [(0.8, True), (1.0, False)])
def test_what_a_cause_may_do_as_well_is_tried_against_the_cause(
    squares: float, outdone: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tip that swings is told in the place of a cause that leaves more, and else is none.

    However many causes it is compared with, it is fitted to a base once.
    """
    asked = tip_that_swings(monkeypatch, squares)
    others, base = OtherExplanations(), Base()
    cause: Any = SimpleNamespace(squares=1.0)
    assert others.outdo(base, cause) is outdone  # type: ignore[arg-type]
    assert others.outdo(base, cause) is outdone  # type: ignore[arg-type]
    told = others.laws(base, 0.99)  # type: ignore[arg-type]
    assert [issue.code for issue in told] == [UNLISTED_LAW] * outdone
    assert asked == [(), NEAR_ONE, *(["anew"] * (not outdone))]


@pytest.mark.parametrize(("taken", "told"), [(0.0, True), (0.98, True), (0.99, False)])
def test_what_a_cause_may_do_as_well_is_told_where_none_does(
    taken: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tip that swings leaves 1 %, which must be a tenth less than what descriptions leave; a
    change that needs more than one number is looked for all the same."""
    tip_that_swings(monkeypatch)
    monkeypatch.setattr(other_explanations, "difference_issues", lambda base: ())
    monkeypatch.setattr(other_explanations, "excess_of", lambda model, scale: 1.0)
    monkeypatch.setattr(other_explanations, "change_issues", lambda *a, alone=False: ())
    monkeypatch.setattr(other_explanations, "spell_issues", lambda *a: (SPELL,))
    others, base = OtherExplanations(), Base()
    found = others.laws(base, taken)  # type: ignore[arg-type]
    assert [issue.code for issue in found] == [UNLISTED_LAW] * told
    assert others.events(base) == (SPELL,)  # type: ignore[arg-type]


def tip_that_swings(monkeypatch: pytest.MonkeyPatch, squares: float = 1.0) -> list[Any]:
    """Let a law that one cause may do as well be all that is found; what is asked for is listed."""
    swings = BeyondCatalogue((SwingingPart(),), 0.99, 0.98, squares, 1.0, ((0.4, "s"),))
    asked: list[Any] = []

    def beyond(
        base: Any, noise: float, laws: Any = (), *, at_starts: bool = False
    ) -> BeyondCatalogue | None:
        asked.append("anew" if at_starts else laws)
        return swings if laws is NEAR_ONE else None

    monkeypatch.setattr(other_explanations, "beyond_catalogue", beyond)
    monkeypatch.setattr(other_explanations, "noise_variance", lambda model, scale: 1.0)
    return asked


@pytest.mark.parametrize(
    ("taken", "told"), [(0.0, True), (0.97, True), (0.98, False), (1.0, False)]
)
def test_a_law_that_leaves_far_more_than_descriptions_is_not_told(
    taken: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It leaves 7 %: three times what descriptions leave that take 97.7 %."""
    worse = replace(LAW, share=0.93)
    monkeypatch.setattr(other_explanations, "beyond_catalogue", lambda *a: worse)
    monkeypatch.setattr(other_explanations, "noise_variance", lambda *a: 1.0)
    base: Any = Base()
    assert bool(OtherExplanations().laws(base, taken)) is told


@pytest.mark.parametrize(
    ("answers", "events", "everything"),
    [
        ({"difference", "change", "law", "spell"}, [DIFFERS], [DIFFERS.code]),
        ({"change", "law", "spell"}, [JUMPS], [JUMPS.code]),
        ({"law", "spell", "mixed"}, [], [UNLISTED_LAW]),
        ({"spell", "mixed"}, [SPELL], [SPELL.code]),
        ({"mixed", "near one"}, [MIXED], [MIXED.code]),
        ({"anew"}, [], [UNLISTED_LAW]),
        ({"near one"}, [], [UNLISTED_LAW]),
        (set(), [], []),
    ],
)
def test_the_order_in_which_they_are_asked(
    answers: set[str],
    events: list[Issue],
    everything: list[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One number for each log, one moment, one law, then what needs more, and a law that one cause
    may do as well; each is asked once."""
    asked: list[str] = []

    def told(name: str, issue: Issue) -> tuple[Issue, ...]:
        asked.append(name)
        return (issue,) if name in answers else ()

    def change(model: Any, scale: Any, excess: float, *, alone: bool = False) -> tuple[Issue, ...]:
        return told("change", JUMPS) if alone else told("mixed", MIXED)

    def law(
        base: Any, noise: float, laws: Any = (), *, at_starts: bool = False
    ) -> BeyondCatalogue | None:
        name = "near one" if laws is NEAR_ONE else "anew" if at_starts else "law"
        return LAW if told(name, MIXED) else None

    monkeypatch.setattr(
        other_explanations, "difference_issues", lambda *a: told("difference", DIFFERS)
    )
    monkeypatch.setattr(other_explanations, "change_issues", change)
    monkeypatch.setattr(other_explanations, "spell_issues", lambda *a: told("spell", SPELL))
    monkeypatch.setattr(other_explanations, "beyond_catalogue", law)
    monkeypatch.setattr(other_explanations, "excess_of", lambda *a: 1.0)
    monkeypatch.setattr(other_explanations, "noise_variance", lambda *a: 1.0)
    base: Any = Base()
    others = OtherExplanations()
    for _ in range(2):
        assert list(others.events(base)) == events
        assert [issue.code for issue in others.all(base)] == everything
    assert len(asked) == len(set(asked))


@pytest.mark.parametrize(
    ("verdict", "structured", "leaves", "held_share", "asked", "code"),
    [
        (Verdict.UNKNOWN, True, 2.0, 0.99, ["both"], UNLISTED_LAW),
        (Verdict.UNKNOWN, True, 0.5, 0.9, ["both"], UNLISTED_LAW),
        (Verdict.UNKNOWN, True, 0.5, 0.99, ["both", "beside"], LAW_BESIDE),
        (Verdict.PARTIAL, True, 2.0, 0.99, ["beside"], LAW_BESIDE),
        (Verdict.PARTIAL, False, 2.0, 0.99, [], None),
    ],
)
def test_a_law_beside_causes_is_asked_where_they_leave_something(
    verdict: Verdict,
    structured: bool,
    leaves: float,
    held_share: float,
    asked: list[str],
    code: str | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Beside all causes where they have names, and together with another one where none has.

    Both together leave 1, and take 98 % on what is held out: they are told unless descriptions
    outdo them on either.
    """
    met = []

    def both(*args: Any) -> BeyondCatalogue:
        met.append("both")
        return replace(LAW, beside=(effect_of("creep"),))

    def law(*args: Any, beside: Any) -> BeyondCatalogue:
        met.append("beside")
        return replace(LAW, beside=(effect_of("creep"),))

    monkeypatch.setattr(other_explanations, "beyond_and_cause", both)
    monkeypatch.setattr(other_explanations, "beyond_catalogue", law)
    monkeypatch.setattr(other_explanations, "noise_variance", lambda *args: 1.0)
    found, effects = diagnosis(verdict), (effect_of("creep"),)
    left = replace(found.remainder, structured=structured, held_out_share=held_share)
    found = replace(found, remainder=left)
    base, final = cast(Any, Base()), cast(Any, SimpleNamespace(effects=effects, squares=leaves))
    answer = with_law_beside(found, base, final, ())
    assert met == asked
    told = answer.issues[len(found.issues) :]
    assert [issue.code for issue in told] == ([code] if code else [])
    for issue in told:
        together = "creep of the material together with a law" in issue.message
        assert together is (code == UNLISTED_LAW)
    assert with_law_beside(answer, base, final, ()) is answer or not asked


@pytest.mark.parametrize(
    ("named", "begins_beside", "asked"),
    [
        ((), {"creep", "delay"}, 1),
        ((), {"delay"}, 2),
        ((), {"creep"}, 3),
        ((), set(), 3),
        (("creep",), {"creep"}, 1),
        (("creep",), {"creep", "delay"}, 2),
        (("creep",), {"delay"}, 3),
        (("creep", "delay"), {"creep", "delay"}, 1),
    ],
)
def test_a_moment_is_looked_for_beside_all_causes_and_fewer(
    named: tuple[str, ...],
    begins_beside: set[str],
    asked: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of two one may stand for what began then, first of all the one without a name; the first
    model that shows a moment is told."""
    looked: list[set[str]] = []

    def change(model: Any, *args: Any, alone: bool) -> tuple[Issue, ...]:
        looked.append({effect.name for effect in model.effects})
        return (Issue("any", "warning", "the misfit begins", "look"),) * (
            looked[-1] == begins_beside
        )

    monkeypatch.setattr(other_explanations, "change_issues", change)
    monkeypatch.setattr(other_explanations, "difference_issues", lambda *args: ())
    monkeypatch.setattr(other_explanations, "excess_of", lambda *args: 1.0)
    monkeypatch.setattr(
        other_explanations,
        "refit_with_fewer",
        lambda now, base, others, *args: SimpleNamespace(effects=tuple(others)),
    )
    effects = (effect_of("creep"), effect_of("delay"))
    base = cast(Any, SimpleNamespace(candidate=None, scale=None, sigma=None))
    final = cast(Any, SimpleNamespace(effects=effects))
    found = diagnosis(Verdict.UNKNOWN)
    found = replace(found, remainder=replace(found.remainder, structured=True))
    found = replace(found, causes=tuple(cause(name, (), before=2.0, after=0.5) for name in named))
    answer = with_event_beside(found, base, final)
    assert len(looked) == asked
    told = answer.issues[len(found.issues) :]
    titles = [effect.title.lower() for effect in effects if effect.name in begins_beside]
    message = f"beside {' and '.join(titles)} the misfit begins"
    assert [(i.code, i.message) for i in told] == [(EVENT_BESIDE, message)] * bool(begins_beside)
    assert not begins_beside or answer.next_experiment == "look"
    assert with_event_beside(answer, base, final) is answer or not begins_beside


@pytest.mark.parametrize(
    ("found", "code", "told"),
    [
        (LAW, UNLISTED_LAW, "sensor (3 % of the range), which takes away 99 %"),
        (
            BeyondCatalogue((EarlyReading(), InputPlay()), 0.93, 0.9, 1.0, 1.0, ((0.0498, "s"),)),
            LIKE_UNLISTED_LAW,
            "late (0.0498 s) or play of the valve",
        ),
        (
            BeyondCatalogue((OutputPlay(),), 0.99, 0.9, 1.0, 1.0, ((0.1, "1"), (0.2, "1"))),
            LIKE_UNLISTED_LAW,
            "sensor, which takes",
        ),
    ],
)
def test_a_law_is_told_with_its_size(found: BeyondCatalogue, code: str, told: str) -> None:
    """That of the best one, where it has a single one."""
    issue = unlisted_issue(found)
    assert issue.code == code
    assert told in issue.message
    assert found.laws[0].shown_by in (issue.remedy or "")


def test_a_law_of_what_is_left_counts_of_that() -> None:
    """And what a tie names already is no news, but speaks for one side of it."""
    issue = unlisted_issue(LAW, of_rest=True)
    assert issue.code == LAW_BESIDE
    assert issue.message.startswith("what is left behaves like a law in no catalogue, play between")
    assert issue.message.endswith(
        "which takes away 99 % of it above the noise, and 98 % on what is held out"
    )
    tied = unlisted_issue(LAW, of_rest=True, is_tied=True)
    assert tied.message.startswith("what is left speaks for play between the actuator")


def test_a_law_whose_experiment_is_on_record_is_sought_on_the_rig() -> None:
    """A gauge that is late shows in fast steps; what to look at is what would mend it."""
    found = BeyondCatalogue((EarlyReading(),), 0.99, 0.98, 1.0, 1.0, ((0.05, "s"),))
    assert unlisted_issue(found).remedy == "record fast steps, where it would show"
    assert unlisted_issue(found, held=frozenset((STEPS,))).remedy == (
        f"settle it on the rig, for these logs hold fast steps already: {EarlyReading.remedy}"
    )
