"""Why a cause is believed, in words."""

from __future__ import annotations

from dataclasses import replace

from handmade_diagnosis import diagnosis

from softid.diagnosis.report.summary import write_summary
from softid.diagnosis_results import Evidence, Verdict


def test_other_forms_of_a_cause_are_no_other_candidates() -> None:
    """A form of the same law is 2 behind, another law 112; without that none of another kind is."""
    found = diagnosis(Verdict.NAMED)
    form = Evidence(1, "coulomb_friction.stribeck", 410.0, 0.9)
    text = write_summary(replace(found, evidence=(*found.evidence, form))).summary
    assert "the next best of another kind, hysteresis of the material, stays 112 behind" in text
    own = tuple(e for e in found.evidence if e.effect == "coulomb_friction")
    refused = Evidence(1, "creep", -4.0, 0.1)
    text = write_summary(replace(found, evidence=(*own, form, refused))).summary
    assert "no effect of another kind that stayed in the race lowers it" in text
