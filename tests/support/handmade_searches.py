"""Searches for causes by hand: chains, bases and answers without a fit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from handmade_diagnosis import remainder
from handmade_rounds import candidate, ranked

from softid.diagnosis.search.forward_selection import Chain, Link
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.effects import effect_of

NOISE = remainder(structured=False, explained=1.0)
STRUCTURE = remainder(structured=True, explained=0.7)
LITTLE = replace(NOISE, explained_share=0.9)


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
        gauges={},
        is_negligible=False,
        held_out=SimpleNamespace(rms=lambda model: 1.0),
    )


def search_over(base: Any = None, *, effects: Sequence[str] = ()) -> CauseSearch:
    found = tuple(effect_of(key) for key in effects)
    return CauseSearch(base or base_fit(), found, 0, lambda message, fraction: None)


def searched_as(answers: dict[str, SearchResult], *, by: list[str]) -> Callable[..., SearchResult]:
    """A search whose answer depends on its base, and on whether a first cause is known."""

    def search(self: CauseSearch, first: Chain | None = None) -> SearchResult:
        key = (
            "known"
            if first is not None and first.links
            else f"base {self.base.candidate.squares:g}"
        )
        by.append(key)
        return answers[key]

    return search


NAMED = SearchResult(chain_of("delay"), NOISE, (True,))
NOTHING = SearchResult(chain_of("creep"), STRUCTURE, (False,))
ALONE = SearchResult(chain_of(), replace(NOISE, open_jumps=9), ())
