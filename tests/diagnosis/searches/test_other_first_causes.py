"""What a search from another first cause finds, by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from handmade_rounds import candidate
from handmade_searches import NOISE, NOTHING, chain_of, search_over

from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.searches import cause_search
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult


@pytest.mark.parametrize("sure", ["none", "ageing"])
def test_what_was_not_sure_on_the_way_is_told_with_the_result(
    sure: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Asked twice, the same twice. Of several, that which leaves least promises most."""
    tried = [chain_of("delay"), chain_of("creep"), chain_of("ageing")]
    monkeypatch.setattr(cause_search, "alternative_first_links", lambda *args, refused: tried)
    monkeypatch.setattr(cause_search, "that_promise_the_rest", lambda others, *args: others)
    monkeypatch.setattr(CauseSearch, "grow", lambda self, chain, **options: chain)
    monkeypatch.setattr(CauseSearch, "_of_first_order", lambda self, chain: chain)
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: NOISE)

    def judged(self: CauseSearch, chain: Chain, first: Any) -> SearchResult:
        return SearchResult(chain, NOISE, (chain.final.keys == (sure,),))

    monkeypatch.setattr(CauseSearch, "judged", judged)
    known = replace(NOTHING, chain=replace(NOTHING.chain, final=candidate(("creep",), 1e9)))
    search = search_over()
    for _ in range(2):
        found = search.search_from_other_causes(known)
        is_sure = sure != "none"
        assert found.chain is (tried[2] if is_sure else known.chain)
        assert [one.chain for one in found.unsure] == tried[: 2 if is_sure else 3]
    least = candidate(("softening",), 1e-9)
    result = replace(NOTHING, chain=replace(NOTHING.chain, final=least))
    assert found.with_unsure([result]).promising is least
    assert known.promising is None
    assert known.with_unsure([]) is known


@pytest.mark.parametrize(("squares", "is_another"), [(1e3, False), (1.01e3, True)])
def test_the_same_causes_found_the_other_way_round_are_no_others(
    squares: float, is_another: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Which may be named goes by their numbers, not by which was found first; at another optimum
    they are another model."""
    other = chain_of("static_curve", "contact")
    other = replace(other, final=candidate(other.final.keys, squares))
    monkeypatch.setattr(cause_search, "alternative_first_links", lambda *args, refused: [other])
    monkeypatch.setattr(cause_search, "that_promise_the_rest", lambda others, *args: others)
    monkeypatch.setattr(CauseSearch, "grow", lambda self, chain, **options: chain)
    monkeypatch.setattr(CauseSearch, "_of_first_order", lambda self, chain: chain)
    monkeypatch.setattr(CauseSearch, "_revise", lambda self, chain: chain)
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: NOISE)
    sure = SearchResult(other, NOISE, (True, True))
    monkeypatch.setattr(CauseSearch, "judged", lambda self, chain, first: sure)
    chain = chain_of("contact", "static_curve")
    known = SearchResult(
        replace(chain, final=candidate(chain.final.keys, 1e3)), NOISE, (False, True)
    )
    found = search_over().search_from_other_causes(known)
    assert found is (sure if is_another else known)
