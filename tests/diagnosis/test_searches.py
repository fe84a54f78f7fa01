"""Which searches follow one another; what each of them does is written by hand here."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import pytest
from handmade_diagnosis import remainder
from handmade_rounds import candidate, ranked

from softid.diagnosis import searches
from softid.diagnosis.chain import Chain, Link
from softid.diagnosis.searches import (
    BETTER_BASE,
    Found,
    _first_link,
    from_other_places,
    searched_thoroughly,
)
from softid.effects import effect_of

NOISE = remainder(structured=False, explained=1.0)
STRUCTURE = remainder(structured=True, explained=0.7)
ELSEWHERE, GIVEN = (candidate(("creep",)),), (candidate(("delay",)),)


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
    return SimpleNamespace(work=work, base=candidate((), squares), scale=None)


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
    left: Any, is_named: tuple[bool, ...], nothing: bool
) -> None:
    """Structure is left, and no cause may be named; noise with no name is an answer."""
    keys = ("delay", "creep")[: len(is_named)]
    assert Found(chain_of(*keys), left, is_named).came_to_nothing is nothing


@pytest.mark.parametrize(
    ("first", "vanished", "given", "asked"),
    [
        ("delay", False, (), [()]),
        ("static_curve", False, (), [(), ELSEWHERE]),
        ("delay", True, (), [ELSEWHERE]),
        ("static_curve", True, (), [ELSEWHERE]),
        ("static_curve", False, GIVEN, [GIVEN]),
        (None, False, (), [()]),
    ],
)
def test_a_curve_with_free_knots_is_asked_again(
    first: str | None,
    vanished: bool,
    given: Sequence[Any],
    asked: list[Sequence[Any]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The rule: a curve is believed only beside candidates from elsewhere, and so is any first
    cause of a base of which a term has vanished; never are they sought twice. The last answer
    counts."""
    told: list[Sequence[Any]] = []
    answers: list[Chain] = []

    def led_on(*args: Any, besides: Sequence[Any], max_links: int) -> Chain:
        assert max_links == 1
        assert args[-1].links == ()
        told.append(besides)
        answers.append(chain_of(first) if first else chain_of())
        return answers[-1]

    monkeypatch.setattr(searches, "_led_on", led_on)
    monkeypatch.setattr(searches, "has_vanished", lambda base: vanished)
    monkeypatch.setattr(searches, "candidates_elsewhere", lambda *args: ELSEWHERE)
    assert len(effect_of("static_curve").amplitudes) > 1
    found = _first_link(beginning(), (), ignore, 0, given)
    assert told == asked
    assert found is answers[-1]


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
    ],
)
def test_only_a_whole_answer_from_elsewhere_counts(
    vanished: bool, answer: Found, counts: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It leaves noise and a name; and where a term had vanished it was asked for at first."""
    monkeypatch.setattr(searches, "has_vanished", lambda base: vanished)
    monkeypatch.setattr(searches, "candidates_elsewhere", lambda *args: ELSEWHERE)
    monkeypatch.setattr(searches, "extended", lambda *args, **options: chain_of("delay"))
    monkeypatch.setattr(searches, "_searched", searched_as({"begun": answer}, by=[]))
    found = from_other_places(beginning(), (), ignore, 0)
    assert found is (answer if counts else None)
