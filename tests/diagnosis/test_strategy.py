"""Which searches follow one another; what each of them does is written by hand here."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from handmade_diagnosis import remainder
from handmade_rounds import candidate, ranked

from softid.diagnosis import strategy
from softid.diagnosis.search.forward_selection import Chain, Link
from softid.diagnosis.strategy import BETTER_BASE, CauseSearch, SearchResult, search_causes
from softid.diagnosis_results import Remainder
from softid.effects import effect_of

NOISE = remainder(structured=False, explained=1.0)
STRUCTURE = remainder(structured=True, explained=0.7)
LITTLE = replace(NOISE, explained_share=0.9)
GIVEN = (candidate(("delay",)),)


def chain_of(*keys: str) -> Chain:
    links, known = [], tuple[str, ...]()
    for key in keys:
        before, chosen = ranked(known, 0.0), ranked((*known, key), -100.0, 50.0)
        links.append(Link(before, (chosen, before), chosen, (key,), (), 100.0))
        known = (*known, key)
    return Chain(tuple(links), None, candidate(known))


def base_fit(squares: float = 100.0) -> Any:
    return SimpleNamespace(
        candidate=candidate((), squares),
        scale=None,
        sigma={"angle": 1.0},
        is_negligible=False,
        held_out=SimpleNamespace(rms=lambda model: 1.0),
    )


def search_over(base: Any = None, *, effects: Sequence[str] = ()) -> CauseSearch:
    found = tuple(effect_of(key) for key in effects)
    return CauseSearch(base or base_fit(), found, 0, lambda message, fraction: None)


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
    assert SearchResult(chain_of(*keys), left, is_named).came_to_nothing is nothing


def from_multistart(squares: float) -> tuple[Any, ...]:
    """Candidates beside a first cause that leaves 100."""
    return candidate(("creep",), squares), candidate(("ageing",), 2.0 * squares)


NEAR, FAR = from_multistart(101.9), from_multistart(102.1)


@pytest.mark.parametrize(
    ("first", "vanished", "given", "others", "raced"),
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
def test_a_curve_with_free_knots_is_raced_again(
    first: str | None,
    vanished: bool,
    given: Sequence[Any],
    others: tuple[Any, ...],
    raced: list[Sequence[Any]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The rule: a curve, which has more unknowns, is believed when no candidate from a multistart
    comes within 2 % of it; any first cause of a base of which a term has vanished is raced beside
    them at once; never are they sought twice. The last answer counts."""
    told: list[Sequence[Any]] = []
    answers: list[Chain] = []

    def grow(
        self: CauseSearch, chain: Chain, *, max_links: int, extra: Sequence[Any], **raced: Any
    ) -> Chain:
        assert max_links == 1
        assert chain.links == ()
        told.append(extra)
        answers.append(chain_of(first) if first else chain_of())
        return answers[-1]

    monkeypatch.setattr(CauseSearch, "grow", grow)
    monkeypatch.setattr(strategy, "has_vanished", lambda base: vanished)
    monkeypatch.setattr(strategy, "multistart_candidates", lambda *args: others)
    assert len(effect_of("static_curve").amplitudes) > 1
    found = search_over().first_cause(given)
    assert told == raced
    assert found is answers[-1]


def test_a_multistart_runs_once_for_each_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its candidates are remembered with the base and the effects that it ran for."""
    asked: list[Any] = []

    def sought(base: Any, effects: Any, scale: Any, sigma: Any) -> tuple[Any, ...]:
        asked.append((base, [effect.key for effect in effects]))
        return NEAR

    monkeypatch.setattr(strategy, "multistart_candidates", sought)
    one, other = search_over(effects=["delay", "creep"]), search_over(effects=["delay"])
    for _ in range(2):
        assert one.multistart is NEAR
        assert other.multistart is NEAR
    assert replace(other, base=one.base).multistart is NEAR
    assert asked == [
        (one.base.candidate, ["delay", "creep"]),
        (other.base.candidate, ["delay"]),
        (one.base.candidate, ["delay"]),
    ]


@pytest.mark.parametrize(
    ("keys", "vanished", "left", "may"),
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
    may: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where nothing followed it; a curve was raced against a multistart already, and so was any
    cause of a base of which a term has vanished."""
    monkeypatch.setattr(strategy, "has_vanished", lambda base: vanished)
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: left)
    assert search_over()._may_stand_for_another(chain_of(*keys)) is may


def searched_as(answers: dict[str, SearchResult], *, by: list[str]) -> Callable[..., SearchResult]:
    """A search whose answer depends on its base, and on whether its first cause is known."""

    def search(self: CauseSearch, first: Chain | None = None) -> SearchResult:
        key = "known" if first is not None else f"base {self.base.candidate.squares:g}"
        by.append(key)
        return answers[key]

    return search


NAMED = SearchResult(chain_of("delay"), NOISE, (True,))
NOTHING = SearchResult(chain_of("creep"), STRUCTURE, (False,))
ALONE = SearchResult(chain_of(), replace(NOISE, open_jumps=9), ())


@pytest.mark.parametrize(
    ("first", "alone", "again", "other", "found", "base"),
    [
        (NAMED, ALONE, 10.0, NAMED, "first", 100.0),
        (NOTHING, ALONE, 10.0, NAMED, "alone", 100.0),
        (NOTHING, replace(ALONE, remainder=NOISE), 10.0, None, "again", 10.0),
        (NOTHING, None, 10.0, None, "again", 10.0),
        (NOTHING, None, 100.0 * BETTER_BASE, NAMED, "other", 100.0),
        (NOTHING, None, 100.0 * BETTER_BASE, None, "first", 100.0),
    ],
)
def test_other_searches_follow_one_that_came_to_nothing(
    first: SearchResult,
    alone: SearchResult | None,
    again: float,
    other: SearchResult | None,
    found: str,
    base: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """First the base alone with open moments of jumps, if that leaves noise; another optimum of the
    base, if it leaves 2 % less; then a multistart; then what there was."""
    better = SearchResult(chain_of("ageing"), NOISE, (True,))
    by: list[str] = []
    answers = {"base 100": first, f"base {again:g}": better}
    monkeypatch.setattr(CauseSearch, "search", searched_as(answers, by=by))
    monkeypatch.setattr(CauseSearch, "without_causes", lambda self: alone)
    monkeypatch.setattr(CauseSearch, "search_from_multistart", lambda self, known: other)
    monkeypatch.setattr(CauseSearch, "search_from_other_causes", lambda self, known: None)
    request: Any = SimpleNamespace(fit_base=lambda *args, thorough: base_fit(again))
    recordings: Any = SimpleNamespace(logs=(), hold_out=())
    others: Any = SimpleNamespace(all=lambda recordings, base: ())
    answer, search = search_causes(recordings, request, search_over(), others)
    answers_by_name = {"first": first, "alone": alone, "again": better, "other": other}
    assert answer is answers_by_name[found]
    assert search.base.candidate.squares == base
    assert by == ["base 100", *(["base 10"] if found == "again" else [])]


def test_no_other_search_follows_where_the_misfit_is_explained(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The base is asked about, and is not fitted again."""
    nothing = SearchResult(Chain((), None, base_fit(100.0).candidate), STRUCTURE, ())
    monkeypatch.setattr(CauseSearch, "search", searched_as({"base 100": nothing}, by=[]))
    monkeypatch.setattr(CauseSearch, "without_causes", lambda self: None)
    asked: list[float] = []

    def explained(recordings: object, base: Any) -> tuple[str, ...]:
        asked.append(base.candidate.squares)
        return ("a load that slipped",)

    others: Any = SimpleNamespace(all=explained)
    unused: Any = None
    answer, _ = search_causes(unused, unused, search_over(), others)
    assert answer is nothing
    assert asked == [100.0]


def test_a_base_that_leaves_noise_stands_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not where that is noise by its marks alone, or where it misses what is held out."""
    left: dict[str, Remainder] = {}
    monkeypatch.setattr(CauseSearch, "_left_by_base", property(lambda self: left["fitted"]))
    monkeypatch.setattr(strategy, "with_held_out", lambda *args: left["held out"])
    for fitted, held_out, stands in (
        (NOISE, NOISE, True),
        (STRUCTURE, NOISE, False),
        (replace(NOISE, colour_s=1.0), NOISE, False),
        (NOISE, replace(NOISE, misses_held_out=True), False),
        (replace(NOISE, open_jumps=9), replace(NOISE, misses_held_out=True), True),
    ):
        left["fitted"], left["held out"] = fitted, held_out
        alone = search_over().without_causes()
        assert (alone is not None and not alone.chain.links) is stands


@pytest.mark.parametrize(
    ("vanished", "answer", "counts"),
    [
        (False, NAMED, True),
        (True, NAMED, False),
        (False, NOTHING, False),
        (False, SearchResult(chain_of("delay"), STRUCTURE, (True,)), False),
        (False, SearchResult(chain_of("delay"), NOISE, (False,)), False),
        (False, SearchResult(chain_of("delay"), LITTLE, (True,)), False),
    ],
)
def test_only_a_whole_answer_from_a_multistart_counts(
    vanished: bool, answer: SearchResult, counts: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It leaves noise, less than 7 % of the misfit, and a name; and where a term had vanished the
    multistart ran at first."""
    monkeypatch.setattr(strategy, "has_vanished", lambda base: vanished)
    monkeypatch.setattr(strategy, "multistart_candidates", lambda *args: NEAR)
    monkeypatch.setattr(CauseSearch, "first_cause", lambda self, extra: chain_of("delay"))
    monkeypatch.setattr(CauseSearch, "search", searched_as({"known": answer}, by=[]))
    found = search_over().search_from_multistart(NOTHING)
    assert found is (answer if counts else None)


def test_a_multistart_that_took_part_has_nothing_new(monkeypatch: pytest.MonkeyPatch) -> None:
    """The race that chose the first cause held its candidates."""
    monkeypatch.setattr(strategy, "has_vanished", lambda base: False)
    known = replace(NOTHING, met_multistart=True)
    assert search_over().search_from_multistart(known) is None


@pytest.mark.parametrize(
    ("first", "again"), [(("delay",), False), (("creep",), True), (None, True)]
)
def test_the_same_first_cause_leads_to_the_same_answer(
    first: tuple[str, ...] | None, again: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where a multistart leads to where the search began the rest is known."""
    monkeypatch.setattr(strategy, "has_vanished", lambda base: False)
    monkeypatch.setattr(strategy, "multistart_candidates", lambda *args: NEAR)
    monkeypatch.setattr(CauseSearch, "first_cause", lambda self, extra: chain_of("delay"))
    monkeypatch.setattr(CauseSearch, "search", searched_as({"known": NAMED}, by=[]))
    known = None if first is None else candidate(first, chain_of("delay").final.squares)
    found = search_over().search_from_multistart(replace(NOTHING, first=known))
    assert found is (NAMED if again else None)
