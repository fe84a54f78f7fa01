"""What a search has worked out is worked out once, and belongs to that search alone."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

from handmade_searches import (
    NAMED,
    NOISE,
    NOTHING,
    STRUCTURE,
    base_fit,
    chain_of,
    search_over,
)

from softid.diagnosis.searches.search_memory import SearchMemory
from softid.diagnosis.searches.search_result import SearchResult

if TYPE_CHECKING:
    from softid.diagnosis.refit.candidates import Candidate


def test_a_model_is_assessed_once() -> None:
    """The second answer is the first, whatever would be said now."""
    memory, model, other = SearchMemory(), cast("Candidate", object()), cast("Candidate", object())
    assert memory.remainder(model, lambda: NOISE) is NOISE
    assert memory.remainder(model, lambda: STRUCTURE) is NOISE
    assert memory.remainder(other, lambda: STRUCTURE) is STRUCTURE


def test_a_chain_is_grown_once_to_each_length() -> None:
    """Up to two causes is another question than up to three."""
    memory, begun = SearchMemory(), chain_of("delay")
    two, three = chain_of("delay", "creep"), chain_of("delay", "creep", "ageing")
    assert memory.grown(begun, 2, lambda: two) is two
    assert memory.grown(begun, 3, lambda: three) is three
    assert memory.grown(begun, 2, lambda: three) is two


def test_other_first_causes_are_tried_once_for_a_chain() -> None:
    """What was met on the way is told again, and of the same chain in the light of what is known
    now; what is sure stands for itself."""
    memory, chain = SearchMemory(), chain_of("delay")
    known = SearchResult(chain, STRUCTURE, (True,))
    unsure, sure = NOTHING, NAMED
    assert memory.from_others(known, lambda: known.with_unsure([unsure])).unsure == (unsure,)
    judged = replace(known, is_named=(False,))
    again = memory.from_others(judged, lambda: sure)
    assert (again.is_named, again.unsure) == ((False,), (unsure,))
    other = SearchResult(chain_of("creep"), STRUCTURE, (True,))
    assert memory.from_others(other, lambda: sure) is sure
    assert memory.from_others(other, lambda: other) is sure


def test_a_search_over_another_base_remembers_nothing() -> None:
    """Remainders hold for one base."""
    one: Any = search_over()
    other: Any = replace(one, base=base_fit(50.0))
    assert one._memory is not other._memory
