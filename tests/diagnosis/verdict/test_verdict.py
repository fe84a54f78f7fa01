"""Which verdict follows from the links that may be named and from what is left."""

from __future__ import annotations

from dataclasses import replace

import pytest
from handmade_diagnosis import FRICTION, remainder
from handmade_rounds import bare_link

from softid.diagnosis.verdict.naming import verdict_of
from softid.diagnosis_results import Variation, Verdict


@pytest.mark.parametrize(("misses", "verdict"), [(False, "named"), (True, "partial")])
def test_a_name_beside_a_rest_that_is_held_out_is_a_part(misses: bool, verdict: str) -> None:
    """And nothing named beside such a rest is unknown, not adequate."""
    left = replace(remainder(structured=False, explained=1.0), misses_held_out=misses)
    assert verdict_of([bare_link(1.0)], [True], left).value == verdict
    assert verdict_of([], [], left) is (Verdict.UNKNOWN if misses else Verdict.ADEQUATE)


@pytest.mark.parametrize(
    ("excess", "colour_s", "varies", "verdict"),
    [
        (0.15, None, True, Verdict.PARTIAL),
        (0.15, None, False, Verdict.NAMED),
        (0.05, None, True, Verdict.NAMED),
        (0.0, 0.4, True, Verdict.PARTIAL),
    ],
)
def test_a_law_that_is_not_quite_its_own_is_a_part_where_more_may_be_left(
    excess: float, colour_s: float | None, varies: bool, verdict: Verdict
) -> None:
    """Of noise that is known to 3 %, the true law leaves at most 8 % more nearly always."""
    left = remainder(structured=False, explained=0.99)
    left = replace(left, excess=excess, noise_sd=0.03, colour_s=colour_s)
    told = replace(FRICTION, variation=Variation("t", 0.08, 0.02, 0.001) if varies else None)
    assert verdict_of([bare_link(1.0)], [True], left, [told]) is verdict


def test_every_link_has_its_cause() -> None:
    """A cause that is missing shifts the others: the variation of one would be held to another."""
    links, left = [bare_link(1.0), bare_link(1.0)], remainder(structured=False, explained=0.8)
    assert verdict_of(links, [True, True], left) is Verdict.NAMED
    with pytest.raises(ValueError, match="zip"):
        verdict_of(links, [True, True], left, [FRICTION])


@pytest.mark.parametrize(
    ("links", "named", "structured", "verdict"),
    [
        ([], [], False, Verdict.ADEQUATE),
        ([], [], True, Verdict.UNKNOWN),
        ([("delay",)], [False], True, Verdict.UNKNOWN),
        ([("delay",)], [False], False, Verdict.UNKNOWN),
        ([("delay",)], [True], False, Verdict.NAMED),
        ([("delay",)], [True], True, Verdict.PARTIAL),
        ([("delay", "creep")], [True], False, Verdict.AMBIGUOUS),
        ([("delay", "creep")], [True], True, Verdict.AMBIGUOUS),
        ([("delay",), ("creep", "ageing")], [True, True], False, Verdict.AMBIGUOUS),
        ([("delay",), ("creep", "ageing")], [True, False], True, Verdict.PARTIAL),
        ([("delay", "creep"), ("ageing",)], [False, True], False, Verdict.NAMED),
    ],
)
def test_verdict(
    links: list[tuple[str, ...]], named: list[bool], structured: bool, verdict: Verdict
) -> None:
    """Every branch: rivals of a link that is not named make nothing ambiguous."""
    left = remainder(structured=structured, explained=0.8)
    assert verdict_of([bare_link(1.0, *rivals) for rivals in links], named, left) is verdict
