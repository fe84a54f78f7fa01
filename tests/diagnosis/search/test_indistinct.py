"""Causes that an unexplained misfit does not let apart."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from handmade_rounds import SAMPLES, link, ranked

from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis.search.indistinct import (
    best_of_tie,
    with_rivals_held_out,
    with_rivals_in_misfit,
)


@pytest.mark.parametrize(("behind", "rivals"), [(1190.0, True), (1210.0, False)])
def test_a_misfit_counts_as_a_hundred_samples(behind: float, rivals: bool) -> None:
    """Closed form: of 10,000 samples, a BIC of 1200 is one of 12 for a hundred of them."""
    assert SAMPLES == 10_000
    first = link(3000.0)
    other = ranked(("pneumatic_lag",), first.chosen.bic + behind)
    found = with_rivals_in_misfit(replace(first, ranked=(first.chosen, other, first.before)))
    assert found.rivals == (("delay", "pneumatic_lag") if rivals else ("delay",))


def test_each_cause_is_a_rival_once() -> None:
    """By its name, whatever its form; what was extended is none, however near it is."""
    first = link(10.0)
    rows = [ranked((key,), first.chosen.bic + 1.0) for key in ("creep", "coulomb_friction")]
    rows.append(ranked(("coulomb_friction.stribeck",), first.chosen.bic + 2.0))
    row_of_base = first.before
    found = with_rivals_in_misfit(replace(first, ranked=(first.chosen, *rows, row_of_base)))
    assert found.rivals == ("delay", "creep", "coulomb_friction")


@pytest.mark.parametrize(
    ("behind", "error", "effects", "rivals"),
    [
        (25.0, 0.96, 1, True),
        (35.0, 0.96, 1, False),
        (25.0, 0.98, 1, False),
        (25.0, 0.96, 2, False),
    ],
)
def test_what_is_held_out_may_prefer_one_that_explains_nearly_as_much(
    behind: float, error: float, effects: int, rivals: bool
) -> None:
    """By hand: of a BIC of 3000 one that is 30 behind, if it errs by 3 % less there and is a model
    of as many causes."""
    first = link(3000.0)
    other = ranked(("pneumatic_lag",), first.chosen.bic + behind)
    round_ = replace(first, ranked=(first.chosen, other, first.before))
    final: Any = SimpleNamespace(effects=(None,) * effects)
    errors = {id(final): 1.0, id(other.plain): error}
    found = with_rivals_held_out(round_, final, lambda model: errors[id(model)])
    assert found.rivals == (("delay", "pneumatic_lag") if rivals else ("delay",))


def test_the_best_of_a_tie_is_the_one_that_errs_least_elsewhere() -> None:
    """By hand: a rival of the tie, not what is none of it, however little that errs."""
    first = link(3000.0)
    rival, other = (ranked((key,), first.chosen.bic + 5.0) for key in ("pneumatic_lag", "creep"))
    rows = (first.chosen, rival, other, first.before)
    tied = replace(first, ranked=rows, rivals=("delay", "pneumatic_lag"))
    final: Any = SimpleNamespace(effects=(None,))
    errors = {id(final): 1.0, id(rival.plain): 0.9, id(other.plain): 0.1}
    assert best_of_tie([tied], final, lambda model: errors[id(model)]) is rival.plain
    alone = replace(tied, rivals=("delay",))
    assert best_of_tie([alone], final, lambda model: errors[id(model)]) is final
    assert best_of_tie([], final, lambda model: errors[id(model)]) is final


def test_what_a_round_extended_is_no_rival_of_its_tie() -> None:
    """A revision took the first of two causes away: the second round extended as many as are left.

    It adds nothing, so it has no name to be asked for.
    """
    before, chosen = ranked(("creep",), 0.0), ranked(("creep", "delay"), -50.0)
    second = Link(before, (chosen, before), chosen, ("delay", "pneumatic_lag"), (), 100.0)
    final: Any = SimpleNamespace(effects=(None,))
    errors = {id(final): 1.0, id(before.plain): 0.1}
    assert best_of_tie([second], final, lambda model: errors[id(model)]) is final
    assert with_rivals_held_out(second, final, lambda model: errors[id(model)]) is second
