"""Parameters that are known less well than their intervals say."""

from __future__ import annotations

from dataclasses import replace

from handmade_diagnosis import diagnosis

from softid.diagnosis.report.parameter_doubts import with_unnamed_misfit, with_varying_sizes
from softid.diagnosis_results import Variation, Verdict


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


def test_a_cause_that_is_not_the_same_throughout_has_another_law() -> None:
    """Its own parameters are weakly identified, and those of the base stay what they are."""
    found = diagnosis(Verdict.NAMED)
    first, *others = found.causes
    varied = replace(first, variation=Variation("x", spread=0.1, share=0.02, chance=1e-9))
    told = with_varying_sizes(replace(found, causes=(varied, *others)))
    assert told.extended is not None
    own = {p.name for p in first.parameters}
    weak = {p.name for p in told.extended.parameters if p.verdict == "weakly identified"}
    assert weak == own
    assert "varies with the position" in told.causes[0].parameters[0].reason
    assert with_varying_sizes(found) is found
