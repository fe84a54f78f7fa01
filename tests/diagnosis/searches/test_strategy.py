"""Which searches follow one another; what each of them does is written by hand here."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from handmade_rounds import candidate
from handmade_searches import (
    ALONE,
    NAMED,
    NOISE,
    NOTHING,
    STRUCTURE,
    base_fit,
    chain_of,
    search_over,
    searched_as,
)

from softid.diagnosis.residual.noise_floor import SMALLEST_EXCESS
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.searches import strategy
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis.searches.strategy import BETTER_BASE, search_causes, search_with_intersample
from softid.diagnosis_results import Remainder

WITHOUT_JUMPS = ("search_without_zero_jumps", "search_without_jumps_of_judges")


def explanations(**known: Any) -> Any:
    """No explanation but a known one."""
    none = {
        "all": lambda base: (),
        "outdo": lambda base, cause: False,
        "part": lambda base: False,
    }
    return SimpleNamespace(**{**none, **known})


@pytest.fixture(autouse=True)
def no_jumps(monkeypatch: pytest.MonkeyPatch) -> None:
    """No sensor slips in logs that nobody made."""
    for name in WITHOUT_JUMPS:
        monkeypatch.setattr(strategy, name, lambda *args: None)


@pytest.mark.parametrize(
    ("known", "of", "stands"),
    [
        (NOTHING, "search_without_zero_jumps", True),
        (NAMED, "search_without_zero_jumps", False),
        (NOTHING, "search_without_jumps_of_judges", True),
        (NAMED, "search_without_jumps_of_judges", True),
        (replace(NAMED, remainder=STRUCTURE), "search_without_jumps_of_judges", False),
    ],
)
def test_what_is_sure_without_a_jump_stands(
    known: SearchResult, of: str, stands: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the fitted logs where structure is left; in what judges, where none is or nothing has a
    name."""
    steady = SearchResult(chain_of("ageing"), NOISE, (True,)), search_over()
    monkeypatch.setattr(strategy, of, lambda *args: steady)
    monkeypatch.setattr(CauseSearch, "search_from_other_causes", lambda self, found: found)
    monkeypatch.setattr(CauseSearch, "first_cause", lambda self: chain_of())
    monkeypatch.setattr(CauseSearch, "search", searched_as({"base 100": known}, by=[]))
    recordings: Any = SimpleNamespace(logs=(), hold_out=())
    others = explanations()
    request: Any = SimpleNamespace()
    answer = search_causes(recordings, request, search_over(), others)
    assert (answer is steady) is stands


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
    monkeypatch.setattr(CauseSearch, "search_from_other_causes", lambda self, known: known)
    request: Any = SimpleNamespace(fit_base=lambda *args, thorough: base_fit(again))
    recordings: Any = SimpleNamespace(logs=(), hold_out=())
    others = explanations()
    monkeypatch.setattr(CauseSearch, "first_cause", lambda self: chain_of())
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

    def explained(base: Any) -> tuple[str, ...]:
        asked.append(base.candidate.squares)
        return ("a load that slipped",)

    others = explanations(all=explained)
    unused: Any = None
    monkeypatch.setattr(CauseSearch, "first_cause", lambda self: chain_of())
    answer, _ = search_causes(unused, unused, search_over(), others)
    assert answer is nothing
    assert asked == [100.0]


@pytest.mark.parametrize(
    ("left", "outdone", "ends"),
    [(STRUCTURE, True, True), (STRUCTURE, False, False), (NOISE, True, False)],
)
def test_a_law_that_outdoes_the_first_cause_ends_the_search(
    left: Remainder, outdone: bool, ends: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If the cause leaves more than noise; it is no more than a description then."""
    monkeypatch.setattr(CauseSearch, "first_cause", lambda self: chain_of("creep"))
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: left)
    monkeypatch.setattr(CauseSearch, "judged", lambda self, chain, first: NOTHING)
    monkeypatch.setattr(CauseSearch, "search", lambda self, first: NAMED)
    others = explanations(outdo=lambda base, cause: outdone)
    unused: Any = None
    answer, _ = search_causes(unused, unused, search_over(), others)
    assert answer == (NOTHING if ends else NAMED)


@pytest.mark.parametrize(
    ("left", "parted", "ends"),
    [(STRUCTURE, True, True), (STRUCTURE, False, False), (NOISE, True, False)],
)
def test_a_number_that_parts_a_log_ends_the_search(
    left: Remainder, parted: bool, ends: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If the causes leave more than noise; they are no more than descriptions then."""
    found, other = replace(NAMED, remainder=left), replace(NAMED, remainder=NOISE)
    monkeypatch.setattr(CauseSearch, "first_cause", lambda self: chain_of())
    monkeypatch.setattr(CauseSearch, "search", lambda self, first: found)
    monkeypatch.setattr(CauseSearch, "search_from_other_causes", lambda self, known: other)
    monkeypatch.setattr(strategy, "is_likelier", lambda *args: True)
    unused: Any = None
    answer, _ = search_causes(unused, unused, search_over(), explanations(part=lambda base: parted))
    assert any(answer.is_named) is not ends


def answered(
    found: SearchResult,
    other: SearchResult | None,
    monkeypatch: pytest.MonkeyPatch,
    base: Any = None,
) -> tuple[SearchResult, list[Chain]]:
    """The answer where the search finds one thing and other first causes another, and the chains
    behind which these were asked for."""
    others = explanations()
    monkeypatch.setattr(CauseSearch, "first_cause", lambda self: chain_of())
    monkeypatch.setattr(CauseSearch, "search", searched_as({"base 100": found}, by=[]))
    asked: list[Chain] = []

    def from_another(self: CauseSearch, known: SearchResult) -> SearchResult:
        asked.append(known.chain)
        return other or known

    monkeypatch.setattr(CauseSearch, "search_from_other_causes", from_another)
    unused: Any = None
    answer, _ = search_causes(unused, unused, search_over(base), others)
    return answer, asked


LOUD = replace(NOISE, excess=1.1 * SMALLEST_EXCESS, noise_from_rest=False)
THREE = ("delay", "creep", "ageing")


@pytest.mark.parametrize(
    ("keys", "left", "other", "likelier", "asks", "replaced"),
    [
        (THREE, NOISE, NAMED, True, True, True),
        (THREE, NOISE, NAMED, False, True, False),
        (THREE, NOISE, None, True, True, False),
        (("delay", "creep"), LOUD, NAMED, True, True, True),
        (("delay", "creep"), replace(LOUD, noise_from_rest=True), NAMED, True, False, False),
        (("delay", "creep"), NOISE, NAMED, True, False, False),
        (("delay",), LOUD, NAMED, True, False, False),
        (("delay",), STRUCTURE, NAMED, True, True, True),
        (("delay",), STRUCTURE, NAMED, False, True, False),
    ],
    ids=[
        "three",
        "less likely",
        "none",
        "louder",
        "known noise",
        "noise",
        "one",
        "structure",
        "less likely without structure",
    ],
)
def test_what_is_likelier_takes_the_place_of_three_causes_and_of_what_leaves_more_than_noise(
    keys: tuple[str, ...],
    left: Remainder,
    other: SearchResult | None,
    likelier: bool,
    asks: bool,
    replaced: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The first may stand for two others. Where rests tell the noise, what is above it is structure
    in any case."""
    named = SearchResult(chain_of(*keys), left, (True,) * len(keys))
    monkeypatch.setattr(strategy, "is_likelier", lambda one, other, sigma: likelier)
    answer, asked = answered(named, other, monkeypatch)
    assert asked == ([named.chain] if asks else [])
    assert answer is (other if replaced else named)


@pytest.mark.parametrize(
    ("squares", "size", "error", "named", "likelier", "replaced"),
    [
        (50.0, 7, 0.9, (True, False), True, True),
        (50.0, 8, 0.9, (True, False), True, False),
        (150.0, 7, 0.9, (True, False), True, False),
        (50.0, 7, 1.1, (True, False), True, False),
        (50.0, 7, 0.9, (False, False), True, False),
        (50.0, 7, 0.9, (True, False), False, False),
    ],
    ids=["in everything", "more unknowns", "leaves more", "errs more", "no name", "less likely"],
)
def test_what_is_unsure_is_outdone_by_what_does_better_in_everything(
    squares: float,
    size: int,
    error: float,
    named: tuple[bool, ...],
    likelier: bool,
    replaced: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A creep and a contact that leave something, behind a curve and another form of the creep."""
    first, second = chain_of("creep.series", "static_curve"), chain_of("creep", "contact")
    now = candidate(first.final.keys, unknowns=7)
    then = candidate(second.final.keys, squares, unknowns=size)
    other = SearchResult(replace(second, final=then), STRUCTURE, named)
    known = SearchResult(replace(first, final=now), STRUCTURE, (True, False))
    monkeypatch.setattr(strategy, "is_likelier", lambda one, than, sigma: likelier)
    base = base_fit()
    base.held_out = SimpleNamespace(rms=lambda model: error if model is then else 1.0)
    answer, _ = answered(known, known.with_unsure([other]), monkeypatch, base)
    assert answer.chain is (other if replaced else known).chain
    assert answer.unsure == (other,)


@pytest.mark.parametrize("sure", [NAMED, None])
@pytest.mark.parametrize(
    ("keys", "left", "asks"),
    [
        (("static_curve", "delay"), STRUCTURE, True),
        (("delay", "static_curve"), replace(NOISE, misses_held_out=True), True),
        (("static_curve",), NOISE, False),
        (("stiffening", "delay"), replace(NOISE, misses_held_out=True), False),
    ],
    ids=["left in sample", "left elsewhere", "nothing left", "no curve"],
)
def test_other_first_causes_are_tried_where_a_curve_leaves_something(
    keys: tuple[str, ...],
    left: Remainder,
    asks: bool,
    sure: SearchResult | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What is not sure does not replace what has a name."""
    named = SearchResult(chain_of(*keys), left, (True,) * len(keys))
    answer, asked = answered(named, sure, monkeypatch)
    assert answer is (sure if asks and sure else named)
    assert asked == ([named.chain] if asks else [])


@pytest.mark.parametrize(
    ("keys", "anew"), [(("delay", "creep"), True), (("delay",), False)], ids=["two", "one"]
)
def test_what_judges_is_held_anew_when_all_causes_are_known(
    keys: tuple[str, ...], anew: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A model without its second cause held it otherwise; with a single one that was asked."""
    chain, first = chain_of(*keys), chain_of("delay")
    found = SearchResult(chain, STRUCTURE, (True,) * len(keys), first.final)

    def judged_by(*logs: Any) -> Any:
        base = base_fit()
        base.candidate.problem.logs = [SimpleNamespace(effective_intersample="zoh")]
        base.identified = SimpleNamespace(hold_out=logs)
        base.judged_by = lambda others: judged_by(*others)
        return base

    held, by_all = (SimpleNamespace(effective_intersample=each) for each in ("held", "zoh"))
    monkeypatch.setattr(strategy, "intersample_after_first_cause", lambda *args: None)
    monkeypatch.setattr(strategy, "intersample_after_all_causes", lambda *args: None)
    changed: Any = SimpleNamespace(hold_out=())
    monkeypatch.setattr(strategy, "recordings_with_intersample", lambda *args: changed)
    monkeypatch.setattr(
        strategy,
        "hold_out_as_explained",
        lambda known, *args: (held if known is first.final else by_all,),
    )
    search = search_over(judged_by(held))
    monkeypatch.setattr(strategy, "search_causes", lambda *args, **options: (found, search))
    after = replace(found, remainder=NOISE)
    monkeypatch.setattr(CauseSearch, "judged", lambda self, *args: after)
    unused: Any = None
    answer, last = search_with_intersample(unused, unused, search, unused, first)
    assert answer == (after if anew else found)
    assert last.base.identified.hold_out == ((by_all,) if anew else (held,))
