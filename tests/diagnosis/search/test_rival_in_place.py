"""Chains in which a rival stands in the place of the last cause."""

from __future__ import annotations

from dataclasses import replace

from handmade_rounds import link, ranked

from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.search.rival_in_place import with_rivals_in_place


def test_each_rival_stands_in_the_place_of_the_cause_once_and_has_it_as_a_rival() -> None:
    """By hand: of three contenders two explain as much, and one of these has a second form."""
    first = link(400.0)
    keys = ("pneumatic_lag", "pneumatic_lag.separate", "creep")
    rows = [ranked((key,), first.chosen.bic + 1.0) for key in keys]
    tied = replace(
        first,
        ranked=(first.chosen, *rows, first.before),
        rivals=("delay", "pneumatic_lag"),
    )
    found = list(with_rivals_in_place(Chain((tied,), None, first.chosen.plain)))
    assert [chain.final for chain in found] == [row.plain for row in rows[:2]]
    for chain in found:
        assert chain.links[0].added.name == "pneumatic_lag"
        assert chain.links[0].rivals == ("pneumatic_lag", "delay")
        assert chain.links[0].found is chain.final


def test_the_causes_before_the_last_stay() -> None:
    """A contender of an earlier round has fewer causes and is none."""
    first, second = link(400.0), link(100.0)
    other = ranked(("creep",), second.chosen.bic + 1.0)
    tied = replace(second, ranked=(second.chosen, other), rivals=("delay", "creep"))
    (found,) = with_rivals_in_place(Chain((first, tied), None, second.chosen.plain))
    assert found.links[0] is first
    assert found.links[1].rivals == ("creep", "delay")


def test_nothing_stands_in_the_place_of_nothing() -> None:
    """Neither without a cause nor without a rival."""
    alone = link(400.0)
    assert not list(with_rivals_in_place(Chain((), alone, alone.before.plain)))
    assert not list(with_rivals_in_place(Chain((alone,), None, alone.chosen.plain)))
