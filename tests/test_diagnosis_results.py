"""Results of a diagnosis: which link of the chain comes before another."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import nan

import pytest
from handmade_diagnosis import FRICTION, diagnosis

from softid.diagnosis_results import Cause, Verdict, cause_before, dropped_from


def chain(*errors: float) -> tuple[Cause, ...]:
    """Links between which the held-out error takes these values."""
    names = [f"link{k}" for k in range(len(errors) - 1)]
    return tuple(
        replace(
            FRICTION,
            key=names[k],
            added_to=tuple(names[:k]),
            holdout_rmse_before=before,
            holdout_rmse_after=after,
        )
        for k, (before, after) in enumerate(pairwise(errors))
    )


@pytest.mark.parametrize(
    "errors",
    [(4.0, 3.0, 2.0, 1.0), (4.0, 3.0, 3.0, 2.0), (2.0, 2.0, 2.0, 2.0), (4.0, nan, nan, 2.0)],
)
def test_the_link_before_is_the_one_before(errors: tuple[float, ...]) -> None:
    """Whether a link changes the error or not, or has none, and in whatever order they are kept."""
    first, second, third = links = chain(*errors)
    assert [link.round for link in links] == [1, 2, 3]
    for others in (links, links[::-1]):
        assert cause_before(first, others) is None
        assert cause_before(second, others) is first
        assert cause_before(third, others) is second


def test_a_link_of_another_table_is_not_before() -> None:
    """Of causes and descriptions apart, each may lack what the other's link was added to."""
    first, second, third = chain(4.0, 3.0, 3.0, 2.0)
    assert cause_before(third, (first, second)) is second
    assert cause_before(third, (first, third)) is None
    assert cause_before(second, (second, third)) is None


def test_what_the_extended_model_does_without() -> None:
    """The extended fit made by hand has all parameters of the base; without it nothing is lost."""
    found = diagnosis(Verdict.NAMED)
    assert dropped_from(found) == ()
    assert dropped_from(replace(found, extended=None)) == ()
    assert found.extended is not None
    lost = found.base.parameters[0].name
    kept = tuple(p for p in found.extended.parameters if p.name != lost)
    assert dropped_from(replace(found, extended=replace(found.extended, parameters=kept))) == (
        lost,
    )
