"""Results of a diagnosis: which link of the chain comes before another."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest
from handmade_diagnosis import FRICTION, diagnosis

from softid.diagnosis_results import Cause, Verdict, cause_before, dropped_from


def chain(*errors: float) -> tuple[Cause, ...]:
    """Links between which the held-out error takes these values."""
    return tuple(
        replace(FRICTION, key=f"link{k}", holdout_rmse_before=before, holdout_rmse_after=after)
        for k, (before, after) in enumerate(pairwise(errors))
    )


@pytest.mark.parametrize(
    "errors", [(4.0, 3.0, 2.0, 1.0), (4.0, 3.0, 3.0, 2.0), (2.0, 2.0, 2.0, 2.0)]
)
def test_the_link_before_is_the_one_before(errors: tuple[float, ...]) -> None:
    """In a whole chain, whether a link changes the error or not; none is before itself."""
    first, second, third = links = chain(*errors)
    assert cause_before(second, links) is first
    assert cause_before(third, links) is second


def test_nothing_is_before_the_first_link() -> None:
    """Nor before one that no other ends at; an error that cannot be told ends nowhere."""
    first, second = links = chain(4.0, 3.0, 2.0)
    assert cause_before(first, links) is None
    assert cause_before(second, (second,)) is None
    unknown = chain(float("nan"), float("nan"), 2.0)
    assert cause_before(unknown[1], unknown) is None


def test_a_description_may_be_before_a_cause() -> None:
    """The other table is looked through where the cause's own has no link that ends there."""
    first, second, third = chain(4.0, 3.0, 3.0, 2.0)
    assert cause_before(third, (first, second)) is second
    assert cause_before(second, (second, first)) is first


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
