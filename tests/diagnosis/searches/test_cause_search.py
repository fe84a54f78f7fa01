"""Searches for the causes of what one base leaves; what each step does is written by hand here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import pytest
from handmade_rounds import candidate
from handmade_searches import (
    LITTLE,
    NAMED,
    NOISE,
    NOTHING,
    STRUCTURE,
    chain_of,
    search_over,
    searched_as,
)

from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.searches import cause_search
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis_results import Remainder
from softid.effects import effect_of


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
    ("first", "vanished", "others", "raced"),
    [
        ("delay", False, NEAR, [()]),
        ("static_curve", False, NEAR, [(), NEAR]),
        ("static_curve", False, FAR, [()]),
        ("static_curve", False, (), [()]),
        ("delay", True, NEAR, [NEAR]),
        ("static_curve", True, NEAR, [NEAR]),
        (None, False, NEAR, [()]),
    ],
)
def test_a_curve_with_free_knots_is_raced_again(
    first: str | None,
    vanished: bool,
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
        self: CauseSearch, chain: Chain, *, max_links: int, extra: Sequence[Any] = (), **raced: Any
    ) -> Chain:
        assert max_links == 1
        assert chain.links == ()
        told.append(extra)
        answers.append(chain_of(first) if first else chain_of())
        return answers[-1]

    monkeypatch.setattr(CauseSearch, "grow", grow)
    monkeypatch.setattr(cause_search, "is_astray", lambda base: vanished)
    monkeypatch.setattr(cause_search, "multistart_candidates", lambda *args: others)
    assert len(effect_of("static_curve").amplitudes) > 1
    found = search_over().first_cause()
    assert told == raced
    assert found is answers[-1]


def test_a_multistart_runs_once_for_each_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its candidates are remembered with the base and the effects that it ran for."""
    asked: list[Any] = []

    def sought(base: Any, effects: Any, scale: Any, sigma: Any) -> tuple[Any, ...]:
        asked.append((base, [effect.key for effect in effects]))
        return NEAR

    monkeypatch.setattr(cause_search, "multistart_candidates", sought)
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
    monkeypatch.setattr(cause_search, "is_astray", lambda base: vanished)
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: left)
    assert search_over()._may_stand_for_another(chain_of(*keys)) is may


def test_a_base_that_leaves_noise_stands_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not where that is noise by its marks alone, or where it misses what is held out."""
    left: dict[str, Remainder] = {}
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: left["fitted"])
    monkeypatch.setattr(cause_search, "with_held_out", lambda *args: left["held out"])
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
    ("jumps", "scatter", "explains"), [(9, True, True), (9, False, False), (0, True, False)]
)
def test_moments_explain_where_they_lie_as_by_chance(
    jumps: int, scatter: bool, explains: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And only where there are any."""
    left = replace(NOISE, open_jumps=jumps, open_jumps_scatter=scatter)
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: left)
    alone = search_over().explained_by_moments()
    assert (alone is not None and not alone.chain.links) is explains


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
    monkeypatch.setattr(cause_search, "is_astray", lambda base: vanished)
    monkeypatch.setattr(cause_search, "multistart_candidates", lambda *args: NEAR)
    monkeypatch.setattr(CauseSearch, "grow", lambda self, chain, **options: chain_of("delay"))
    monkeypatch.setattr(CauseSearch, "search", searched_as({"known": answer}, by=[]))
    found = search_over().search_from_multistart(NOTHING)
    assert found is (answer if counts else None)


def test_a_multistart_that_took_part_has_nothing_new(monkeypatch: pytest.MonkeyPatch) -> None:
    """The race that chose the first cause held its candidates."""
    monkeypatch.setattr(cause_search, "is_astray", lambda base: False)
    known = replace(NOTHING, met_multistart=True)
    assert search_over().search_from_multistart(known) is None


@pytest.mark.parametrize(
    ("first", "again"), [(("delay",), False), (("creep",), True), (None, True)]
)
def test_the_same_first_cause_leads_to_the_same_answer(
    first: tuple[str, ...] | None, again: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where a multistart leads to where the search began the rest is known."""
    monkeypatch.setattr(cause_search, "is_astray", lambda base: False)
    monkeypatch.setattr(cause_search, "multistart_candidates", lambda *args: NEAR)
    monkeypatch.setattr(CauseSearch, "grow", lambda self, chain, **options: chain_of("delay"))
    monkeypatch.setattr(CauseSearch, "search", searched_as({"known": NAMED}, by=[]))
    known = None if first is None else candidate(first, chain_of("delay").final.squares)
    found = search_over().search_from_multistart(replace(NOTHING, first=known))
    assert found is (NAMED if again else None)


@pytest.mark.parametrize("is_found", [True, False])
def test_a_multistart_meets_what_the_first_round_left(
    is_found: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether its best cause was taken or what is held out refused it: it does not run again."""
    best = chain_of("delay").links[0]
    told: list[Mapping[str, Any]] = []

    def grow(self: CauseSearch, chain: Chain, **options: Any) -> Chain:
        told.append(options)
        return chain_of("delay") if is_found else Chain((), best, chain.final)

    monkeypatch.setattr(cause_search, "is_astray", lambda base: False)
    monkeypatch.setattr(cause_search, "multistart_candidates", lambda *args: NEAR)
    monkeypatch.setattr(CauseSearch, "grow", grow)
    monkeypatch.setattr(CauseSearch, "search", lambda self, first: NAMED)
    search = search_over()
    first = search.first_cause()
    search.search_from_multistart(NOTHING)
    assert [options.get("extra", ()) for options in told] == [(), NEAR]
    assert told[1]["raced"] is (first.links[0] if is_found else best)


@pytest.mark.parametrize(("share", "is_sought"), [(0.3, False), (0.7, True)])
def test_a_third_cause_is_sought_beside_two_that_explain_half(
    share: float, is_sought: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And the whole chain is revised with it."""
    two, three = chain_of("delay", "creep"), chain_of("delay", "creep", "ageing")
    left = replace(STRUCTURE, explained_share=share)
    revised: list[Chain] = []
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: left)
    monkeypatch.setattr(CauseSearch, "grow", lambda self, chain: three)
    monkeypatch.setattr(CauseSearch, "_revise", lambda self, c: revised.append(c) or c)
    assert search_over()._with_third(two) is (three if is_sought else two)
    assert revised == ([three] if is_sought else [])


@pytest.mark.parametrize(
    ("share", "squares", "second"),
    [(0.3, 50.0, "other"), (0.7, 50.0, "first"), (0.3, 99.5, "first")],
)
def test_a_first_cause_that_explains_little_is_raced_before_a_second_is_sought(
    share: float, squares: float, second: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A candidate from the multistart that leaves less takes its place; the answer knows of it."""
    first, other = chain_of("delay"), chain_of("creep")
    left = replace(STRUCTURE, explained_share=share)
    begun: list[Chain] = []

    def grow(self: CauseSearch, chain: Chain, **options: Any) -> Chain:
        if not chain.links:
            return other
        begun.append(chain)
        return chain_of(*chain.final.keys, "ageing")

    monkeypatch.setattr(cause_search, "is_astray", lambda base: False)
    monkeypatch.setattr(cause_search, "multistart_candidates", lambda *a: from_multistart(squares))
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: left)
    monkeypatch.setattr(CauseSearch, "grow", grow)
    monkeypatch.setattr(CauseSearch, "_revise", lambda self, chain: chain)
    monkeypatch.setattr(
        CauseSearch, "judged", lambda self, chain, model: SearchResult(chain, left, (False,) * 2)
    )
    found = search_over().search(first)
    assert begun[0] is (other if second == "other" else first)
    assert found.met_multistart is (second == "other")


@pytest.mark.parametrize("count", [2, 3])
def test_a_lag_is_asked_again_where_a_third_cause_is_known(
    count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With one other cause the resonance is likelier than the lag, with two the lag is."""
    begun, lagging = chain_of("line_resonance"), chain_of("pneumatic_lag")
    resonant = chain_of(*("line_resonance", "creep", "ageing")[:count])
    of_lags = chain_of("pneumatic_lag", "sensor_lag", "pressure_mass")

    def grow(self: CauseSearch, chain: Chain, *, max_links: int = 3, **options: Any) -> Chain:
        if chain is lagging:
            return of_lags if max_links > 2 else chain_of("pneumatic_lag", "sensor_lag")
        return resonant if max_links > 2 else chain_of("line_resonance", "creep")

    monkeypatch.setattr(cause_search, "is_astray", lambda base: False)
    monkeypatch.setattr(cause_search, "chain_of_first_order", lambda *args: lagging)
    monkeypatch.setattr(cause_search, "is_likelier", lambda new, old, sigma: new is of_lags.final)
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: NOISE)
    monkeypatch.setattr(CauseSearch, "grow", grow)
    monkeypatch.setattr(CauseSearch, "_revise", lambda self, chain: chain)
    monkeypatch.setattr(
        CauseSearch, "judged", lambda self, chain, model: SearchResult(chain, NOISE, ())
    )
    found = search_over().search(begun)
    assert found.chain.final.keys == (of_lags if count == 3 else resonant).final.keys


@pytest.mark.parametrize(
    ("left", "misses", "noise"),
    [(NOISE, False, True), (NOISE, True, False), (STRUCTURE, False, False)],
)
def test_as_much_as_behind_noise_is_asked_only_where_all_is_noise(
    left: Remainder, misses: bool, noise: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On what is held out, too: slow moves hide a lag which the quick ones of another log show."""
    asked: list[bool] = []

    def selected(now: Any, *args: Any, is_noise: Any, **others: Any) -> Chain:
        asked.append(is_noise(now))
        return chain_of("delay")

    monkeypatch.setattr(cause_search, "select_forward", selected)
    monkeypatch.setattr(
        cause_search, "with_held_out", lambda left, *args: replace(left, misses_held_out=misses)
    )
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: left)
    search_over().grow(chain_of("delay"))
    assert asked == [noise]


@pytest.mark.parametrize(
    ("left", "muffles", "stays"),
    [(NOISE, True, False), (NOISE, False, True), (STRUCTURE, True, True)],
)
def test_behind_noise_a_cause_must_explain_more_than_the_gauge(
    left: Remainder, muffles: bool, stays: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Friction that holds a motion still against the noise of the pressure is none."""
    asked: list[bool] = []

    def selected(now: Any, *args: Any, is_no_worse: Any, **others: Any) -> Chain:
        asked.append(is_no_worse(now, now))
        return chain_of("delay")

    monkeypatch.setattr(cause_search, "select_forward", selected)
    monkeypatch.setattr(cause_search, "with_held_out", lambda left, *args: left)
    monkeypatch.setattr(cause_search, "takes_input_noise_at_most", lambda *args: muffles)
    monkeypatch.setattr(cause_search, "NO_WORSE", 1.1)
    monkeypatch.setattr(cause_search, "BETTER", 1.1)
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: left)
    search_over().grow(chain_of("delay"))
    assert asked == [stays]
