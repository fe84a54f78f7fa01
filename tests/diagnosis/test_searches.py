"""Which searches follow one another; what each of them does is written by hand here."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from handmade_diagnosis import remainder
from handmade_rounds import candidate, ranked

from softid.diagnoses import Remainder
from softid.diagnosis import searches
from softid.diagnosis.chain import Chain, Link
from softid.diagnosis.searches import (
    BETTER_BASE,
    Found,
    _elsewhere,
    _first_link,
    _stands_for_another,
    from_other_places,
    searched_thoroughly,
)
from softid.effects import effect_of

NOISE = remainder(structured=False, explained=1.0)
STRUCTURE = remainder(structured=True, explained=0.7)
GIVEN = (candidate(("delay",)),)


def chain_of(*keys: str) -> Chain:
    links, known = [], tuple[str, ...]()
    for key in keys:
        before, chosen = ranked(known, 0.0), ranked((*known, key), -100.0, 50.0)
        links.append(Link(before, (chosen, before), chosen, (key,), (), 100.0))
        known = (*known, key)
    return Chain(tuple(links), None, candidate(known))


def beginning(squares: float = 100.0) -> Any:
    optimum = SimpleNamespace(sigma={"angle": 1.0})
    work = SimpleNamespace(found=SimpleNamespace(optimum=optimum))
    return SimpleNamespace(work=work, base=candidate((), squares), scale=None, elsewhere={})


def ignore(message: str, fraction: float) -> None:
    del message, fraction


@pytest.mark.parametrize(
    ("left", "is_named", "nothing"),
    [
        (STRUCTURE, (), True),
        (STRUCTURE, (False, False), True),
        (STRUCTURE, (False, True), False),
        (NOISE, (), False),
        (NOISE, (False,), False),
    ],
)
def test_a_search_that_came_to_nothing(
    left: Remainder, is_named: tuple[bool, ...], nothing: bool
) -> None:
    """Structure is left, and no cause may be named; noise with no name is an answer."""
    keys = ("delay", "creep")[: len(is_named)]
    assert Found(chain_of(*keys), left, is_named).came_to_nothing is nothing


def elsewhere(squares: float) -> tuple[Any, ...]:
    """Candidates beside a first cause that leaves 100."""
    return candidate(("creep",), squares), candidate(("ageing",), 2.0 * squares)


NEAR, FAR = elsewhere(101.9), elsewhere(102.1)


@pytest.mark.parametrize(
    ("first", "vanished", "given", "others", "asked"),
    [
        ("delay", False, (), NEAR, [()]),
        ("static_curve", False, (), NEAR, [(), NEAR]),
        ("static_curve", False, (), FAR, [()]),
        ("static_curve", False, (), (), [()]),
        ("delay", True, (), NEAR, [NEAR]),
        ("static_curve", True, (), NEAR, [NEAR]),
        ("static_curve", False, GIVEN, NEAR, [GIVEN]),
        (None, False, (), NEAR, [()]),
    ],
)
def test_a_curve_with_free_knots_is_asked_again(
    first: str | None,
    vanished: bool,
    given: Sequence[Any],
    others: tuple[Any, ...],
    asked: list[Sequence[Any]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The rule: a curve, which has more unknowns, is believed when no candidate from elsewhere
    comes within 2 % of it; any first cause of a base of which a term has vanished is looked for
    beside them at once; never are they sought twice. The last answer counts."""
    told: list[Sequence[Any]] = []
    answers: list[Chain] = []

    def led_on(*args: Any, besides: Sequence[Any], max_links: int, **raced: Any) -> Chain:
        assert max_links == 1
        assert args[-1].links == ()
        told.append(besides)
        answers.append(chain_of(first) if first else chain_of())
        return answers[-1]

    monkeypatch.setattr(searches, "_led_on", led_on)
    monkeypatch.setattr(searches, "has_vanished", lambda base: vanished)
    monkeypatch.setattr(searches, "candidates_elsewhere", lambda *args: others)
    assert len(effect_of("static_curve").amplitudes) > 1
    found = _first_link(beginning(), (), ignore, 0, given)
    assert told == asked
    assert found is answers[-1]


def test_other_places_are_sought_once_for_each_set_of_effects(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Their candidates are remembered with the base that they began from."""
    asked: list[Any] = []

    def sought(base: Any, effects: Any, scale: Any, sigma: Any) -> tuple[Any, ...]:
        asked.append((base, [effect.key for effect in effects]))
        return NEAR

    monkeypatch.setattr(searches, "candidates_elsewhere", sought)
    start, other = beginning(), beginning()
    delay, creep = effect_of("delay"), effect_of("creep")
    for _ in range(2):
        assert _elsewhere(start, [delay, creep]) is NEAR
        assert _elsewhere(start, [delay]) is NEAR
    assert _elsewhere(other, [delay]) is NEAR
    assert asked == [
        (start.base, ["delay", "creep"]),
        (start.base, ["delay"]),
        (other.base, ["delay"]),
    ]


@pytest.mark.parametrize(
    ("keys", "vanished", "left", "stands"),
    [
        (("delay",), False, STRUCTURE, True),
        (("delay",), False, NOISE, False),
        (("delay",), True, STRUCTURE, False),
        (("static_curve",), False, STRUCTURE, False),
        (("delay", "creep"), False, STRUCTURE, False),
        ((), False, STRUCTURE, False),
    ],
)
def test_a_single_cause_that_leaves_structure_may_stand_for_another(
    keys: tuple[str, ...],
    vanished: bool,
    left: Remainder,
    stands: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where nothing followed it; a curve was tried against candidates from elsewhere already, and
    so was any cause of a base of which a term has vanished."""
    monkeypatch.setattr(searches, "has_vanished", lambda base: vanished)
    monkeypatch.setattr(searches, "_left", lambda start, now, seed: left)
    assert _stands_for_another(beginning(), chain_of(*keys), 0) is stands


def searched_as(answers: dict[str, Found], *, by: list[str]) -> Callable[..., Found]:
    """A search whose answer depends on its base, and on whether it was begun already."""

    def searched(
        start: Any, effects: Any, report: Any, seed: int, begun: Chain | None = None
    ) -> Found:
        key = "begun" if begun is not None else f"base {start.base.squares:g}"
        by.append(key)
        return answers[key]

    return searched


NAMED = Found(chain_of("delay"), NOISE, (True,))
NOTHING = Found(chain_of("creep"), STRUCTURE, (False,))


@pytest.mark.parametrize(
    ("first", "again", "elsewhere", "found", "base"),
    [
        (NAMED, 10.0, NAMED, "first", 100.0),
        (NOTHING, 10.0, None, "again", 10.0),
        (NOTHING, 100.0 * BETTER_BASE, NAMED, "elsewhere", 100.0),
        (NOTHING, 100.0 * BETTER_BASE, None, "first", 100.0),
    ],
)
def test_other_searches_follow_one_that_came_to_nothing(
    first: Found,
    again: float,
    elsewhere: Found | None,
    found: str,
    base: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """First another optimum of the base, if it leaves 2 % less; then other places; then what there
    was."""
    better = Found(chain_of("ageing"), NOISE, (True,))
    by: list[str] = []
    answers = {"base 100": first, f"base {again:g}": better}
    monkeypatch.setattr(searches, "_searched", searched_as(answers, by=by))
    monkeypatch.setattr(searches, "from_other_places", lambda *args: elsewhere)
    monkeypatch.setattr(searches, "_from_other_causes", lambda *args: None)
    asked: Any = SimpleNamespace(seed=0, begin=lambda *args, thorough: beginning(again))
    given: Any = SimpleNamespace(logs=(), hold_out=())
    answer, start = searched_thoroughly(given, asked, beginning(), (), ignore, None)
    assert answer is {"first": first, "again": better, "elsewhere": elsewhere}[found]
    assert start.base.squares == base
    assert by == ["base 100", *(["base 10"] if found == "again" else [])]


@pytest.mark.parametrize(
    ("vanished", "answer", "counts"),
    [
        (False, NAMED, True),
        (True, NAMED, False),
        (False, NOTHING, False),
        (False, Found(chain_of("delay"), STRUCTURE, (True,)), False),
        (False, Found(chain_of("delay"), NOISE, (False,)), False),
        (False, Found(chain_of("delay"), replace(NOISE, explained_share=0.9), (True,)), False),
    ],
)
def test_only_a_whole_answer_from_elsewhere_counts(
    vanished: bool, answer: Found, counts: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It leaves noise, less than 7 % of the misfit, and a name; and where a term had vanished it
    was asked for at first."""
    monkeypatch.setattr(searches, "has_vanished", lambda base: vanished)
    monkeypatch.setattr(searches, "candidates_elsewhere", lambda *args: NEAR)
    monkeypatch.setattr(searches, "extended", lambda *args, **options: chain_of("delay"))
    monkeypatch.setattr(searches, "_searched", searched_as({"begun": answer}, by=[]))
    found = from_other_places(beginning(), NOTHING, (), ignore, 0)
    assert found is (answer if counts else None)


@pytest.mark.parametrize(
    ("first", "again"), [(("delay",), False), (("creep",), True), (None, True)]
)
def test_the_same_first_cause_leads_to_the_same_answer(
    first: tuple[str, ...] | None, again: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where other places lead to where the search began the rest is known."""
    monkeypatch.setattr(searches, "has_vanished", lambda base: False)
    monkeypatch.setattr(searches, "candidates_elsewhere", lambda *args: NEAR)
    monkeypatch.setattr(searches, "extended", lambda *args, **options: chain_of("delay"))
    monkeypatch.setattr(searches, "_searched", searched_as({"begun": NAMED}, by=[]))
    begun = None if first is None else candidate(first, chain_of("delay").final.squares)
    known = NOTHING._replace(begun=begun)
    found = from_other_places(beginning(), known, (), ignore, 0)
    assert found is (NAMED if again else None)
