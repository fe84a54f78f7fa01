"""Several causes: first the whole in a few lines, then a paragraph each, then what to do."""

from __future__ import annotations

from dataclasses import replace

from handmade_diagnosis import DELAY, FRICTION, TIE, diagnosis

from softid.diagnosis.report.evidence_text import MOST_CONFUSED
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis_results import Diagnosis, Evidence, Verdict
from softid.effects import EFFECTS, confusable_with

SECOND = replace(DELAY, added_to=(FRICTION.key,), remedy="move the valve to the actuator")


def two_causes(verdict: Verdict = Verdict.NAMED) -> Diagnosis:
    first = replace(FRICTION, remedy="oil it")
    return replace(diagnosis(verdict), causes=(first, SECOND), next_experiment=None)


def test_the_first_paragraph_is_the_whole() -> None:
    """Both names, the gain and what is left come before the evidence for either."""
    whole, one, two, advice = write_summary(two_causes()).summary.split("\n\n")
    assert "Two causes act together: dry friction and delay of the input. With all" in whole
    assert "What the fit leaves" in whole
    assert "Evidence" not in whole
    assert one.startswith("Cause 1: dry friction (coulomb_friction) with Fc = ")
    assert two.startswith("Cause 2: a delay")
    assert "Evidence: BIC falls by" in one
    assert "Evidence: BIC falls by" in two
    assert advice == "In hardware: oil it; move the valve to the actuator."


def test_one_cause_is_one_paragraph() -> None:
    """No blank line, and nothing that acts together."""
    text = write_summary(replace(diagnosis(Verdict.NAMED), next_experiment=None)).summary
    assert "\n" not in text
    assert "act together" not in text


def test_what_a_cause_is_not_told_from_stands_beside_it() -> None:
    """One other by its name, several by their number; what a law in no catalogue is comes later."""
    tied = replace(two_causes(Verdict.AMBIGUOUS), alternatives=(TIE,))
    assert "dry friction and delay of the input (or lag of the pneumatics)." in (
        write_summary(tied).summary
    )
    three = replace(TIE, effects=(*TIE.effects, "sensor_lag"), forms=(*TIE.keys, "sensor_lag"))
    many = write_summary(replace(tied, alternatives=(three,))).summary
    assert "dry friction and delay of the input (or one of 2 others)." in many
    beyond = replace(TIE, effects=("delay", "gauge_lag"), forms=("delay", "gauge_lag"))
    text = write_summary(replace(tied, alternatives=(beyond,))).summary
    whole, _, second, *_ = text.split("\n\n")
    assert "dry friction and delay of the input (or a law in no catalogue)." in whole
    assert "delay of the input or a pressure gauge that lags behind" in second


def test_neighbours_are_told_in_the_form_of_the_cause() -> None:
    """What stands below the actuator is not confused with the upper limit of its sensor."""
    below = replace(DELAY, effect="contact", key="contact.lower", delta_bic=100.0)
    rows = (Evidence(1, "contact.lower", 100.0, 0.1), Evidence(1, "stiffening", 50.0, 0.1))
    found = replace(diagnosis(Verdict.NAMED), causes=(below,), evidence=rows)
    text = write_summary(found).summary
    assert "clipping of the sensor at its lower limit" in text
    assert "upper limit" not in text
    whole = replace(below, effect="creep", key="creep")
    raced = (Evidence(1, "creep", 100.0, 0.1), Evidence(1, "hysteresis.pressure", 50.0, 0.1))
    told = write_summary(replace(found, causes=(whole,), evidence=raced)).summary
    assert "easily confused with hysteresis of the material" in told


def test_those_that_come_nearest_are_told_and_the_others_counted() -> None:
    """A delay has more neighbours than a sentence takes; the sensor's lag reached most."""
    neighbours = confusable_with(EFFECTS["delay"]())
    assert len(neighbours) > MOST_CONFUSED + 1
    rows = [Evidence(1, name, 50.0 + k, 0.1) for k, name in enumerate(neighbours)]
    best = Evidence(1, "sensor_lag", 90.0, 0.1)
    alone = replace(DELAY, delta_bic=100.0)
    found = replace(diagnosis(Verdict.NAMED), causes=(alone,), evidence=(*rows, best))
    text = write_summary(found).summary
    assert "It is easily confused with lag of the sensor, " in text
    assert f"and {len(neighbours) - MOST_CONFUSED} more, which explain these logs less well" in text
