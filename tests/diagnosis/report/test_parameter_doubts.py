"""Parameters that are known less well than their intervals say."""

from __future__ import annotations

from dataclasses import replace

from handmade_diagnosis import diagnosis

from softid.diagnosis.report.parameter_doubts import with_unnamed_misfit
from softid.diagnosis_results import Verdict


def test_beside_a_misfit_without_a_name_nothing_is_identified() -> None:
    """In the base and in what describes it; what was not identified keeps its own reason."""
    found = diagnosis(Verdict.UNKNOWN)
    assert found.extended is not None
    first, second, *_ = found.base.parameters
    rows = (replace(first, verdict="identified"), replace(second, verdict="not identified"))
    found = replace(found, base=replace(found.base, parameters=rows))
    told = with_unnamed_misfit(found)
    assert told.base.parameters[0].verdict == "weakly identified"
    assert "has no name" in told.base.parameters[0].reason
    assert told.base.parameters[1] == rows[1]
    assert told.extended is not None
    assert all(p.verdict != "identified" for p in told.extended.parameters)
    named = replace(found, verdict=Verdict.NAMED)
    assert with_unnamed_misfit(named) is named
