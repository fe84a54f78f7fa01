"""A description beside named causes that leave noise without it, by rule."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest
from handmade_diagnosis import diagnosis
from handmade_searches import NOISE, STRUCTURE, chain_of, search_over

from softid.diagnosis.searches import without_idle as module
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis.searches.without_idle import without_idle
from softid.diagnosis_results import Cause, Doubt, Remainder, Verdict

(CAUSE,) = diagnosis(Verdict.NAMED).causes[:1]


def described(key: str, doubt: Doubt = Doubt.GAINS_NOTHING) -> Cause:
    return replace(CAUSE, key=key, doubt=doubt)


def shortened(
    keys: Sequence[str],
    descriptions: Sequence[Cause],
    monkeypatch: pytest.MonkeyPatch,
    *,
    left: Remainder = NOISE,
    is_named: bool = True,
) -> SearchResult | None:
    """What stays of a chain whose named causes alone leave something."""
    links = chain_of(*keys).links
    links = tuple(replace(link, found=link.chosen.plain) for link in links)
    chain = replace(chain_of(*keys), links=links)

    def judged(self: CauseSearch, chain: Any, first: Any) -> SearchResult:
        return SearchResult(chain, left, (is_named,) * len(chain.links), first)

    monkeypatch.setattr(module, "converged", lambda model, sigma: model)
    monkeypatch.setattr(CauseSearch, "remainder_of", lambda self, model: left)
    monkeypatch.setattr(CauseSearch, "judged", judged)
    named = (True,) * (len(keys) - len(descriptions)) + (False,) * len(descriptions)
    return without_idle(SearchResult(chain, NOISE, named), search_over(), descriptions)


def test_what_changes_nothing_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """A contact that gains nothing beside a stiffening that leaves noise without it."""
    found = shortened(["stiffening", "contact"], [described("contact")], monkeypatch)
    assert found is not None
    assert [link.added.key for link in found.chain.links] == ["stiffening"]
    assert found.chain.final.keys == ("stiffening",)
    assert found.is_named == (True,)


@pytest.mark.parametrize(
    ("keys", "descriptions", "left", "is_named"),
    [
        (["creep"], [], NOISE, True),
        (["creep"], [described("creep")], NOISE, True),
        (["creep", "contact"], [described("contact")], STRUCTURE, True),
        (["creep", "contact"], [described("contact", Doubt.DOES_NOT_OCCUR)], NOISE, True),
        (["contact", "creep"], [described("contact")], NOISE, True),
        (["creep", "contact"], [described("contact")], NOISE, False),
    ],
    ids=["no description", "no cause", "leaves structure", "acts", "not last", "no name alone"],
)
def test_what_may_act_stays(
    keys: Sequence[str],
    descriptions: Sequence[Cause],
    left: Remainder,
    is_named: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It takes a part of the misfit, or the cause has no name without it."""
    assert shortened(keys, descriptions, monkeypatch, left=left, is_named=is_named) is None
