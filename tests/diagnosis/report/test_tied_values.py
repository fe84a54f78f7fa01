"""Parameters that hang on which cause of a tie is simulated."""

from __future__ import annotations

from dataclasses import replace

import pytest
from extended_fits import extended_fit
from handmade_diagnosis import diagnosis
from handmade_rounds import ranked

from softid.diagnosis.report.tied_values import with_tied_values
from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis_results import Verdict


@pytest.mark.parametrize(
    ("rival", "share", "moves"),
    [
        ("pneumatic_lag", 1.5, True),
        ("pneumatic_lag", 0.5, False),
        ("sensor_lag", 1.5, False),
    ],
)
def test_what_a_rival_makes_another_is_less_sure(rival: str, share: float, moves: bool) -> None:
    """A value of M one and a half half-widths away is outside; a rival that is in no tie is none.

    What was not identified before keeps its own reason.
    """
    found = diagnosis(Verdict.AMBIGUOUS)
    assert found.extended is not None
    rows = tuple(
        replace(p, ci95=(0.9 * p.value, 1.1 * p.value), verdict=verdict)
        for p, verdict in zip(
            found.extended.parameters[:2], ("identified", "not identified"), strict=True
        )
    )
    rest = found.extended.parameters[2:]
    found = replace(found, extended=replace(found.extended, parameters=(*rows, *rest)))
    values = {p.name: p.value * (1.0 + 0.1 * share) for p in rows}
    before, other = ranked((), 100.0), ranked((rival,), 3.0, values=values)
    chosen = ranked(("delay",), 0.0)
    link = Link(before, (chosen, other, before), chosen, ("delay", "pneumatic_lag"), (), 100.0)
    told = with_tied_values(found, [link], 1)
    assert told.extended is not None
    first, second = told.extended.parameters[:2]
    assert first.verdict == ("weakly identified" if moves else "identified")
    assert ("lag of the pneumatics" in first.reason) is moves
    assert second == rows[1]
    beside_more = with_tied_values(found, [link], 2).extended
    assert beside_more is not None
    assert beside_more.parameters[:2] == rows


def test_what_a_tied_cause_has_holds_for_it_alone() -> None:
    """A delay's own parameters, and none where its name is not in doubt."""
    found = diagnosis(Verdict.AMBIGUOUS, extended=extended_fit("muscle", "delay"))
    assert found.extended is not None
    own = {p.name for p in found.causes[0].parameters}
    sure = tuple(replace(p, verdict="identified") for p in found.extended.parameters)
    found = replace(found, extended=replace(found.extended, parameters=sure))
    told = with_tied_values(found, [], 1)
    assert told.extended is not None
    weak = {p.name for p in told.extended.parameters if p.verdict == "weakly identified"}
    assert weak == own
    alone = replace(found, alternatives=())
    assert with_tied_values(alone, [], 1) == alone
