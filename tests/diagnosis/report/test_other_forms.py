"""Parameters that another form of a cause's law would make others."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import pytest
from extended_fits import extended_fit, scale_of
from handmade_diagnosis import diagnosis
from handmade_rounds import candidate, ranked

from softid.diagnosis import diagnose
from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.report.other_forms import OTHER_FORM, with_other_forms
from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis_results import Verdict
from softid.synthesis import hidden_pair


@pytest.mark.parametrize("seed", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_a_linear_creep_does_not_tell_which_stiffness_is_meant(seed: int) -> None:
    """The truth of Q is among the two values, and Q is not called identified."""
    drawn = hidden_pair(["creep"], seed=seed, model="oscillator", protocol="levels")
    train, hold_out = drawn.logs
    effects = ("creep", "creep.series", "delay")
    found = diagnose(train, hold_out=[hold_out], model="oscillator", effects=effects)
    assert [cause.effect for cause in found.causes] == ["creep"]
    assert found.extended is not None
    (told,) = (issue for issue in found.issues if issue.code == OTHER_FORM)
    pair = re.search(r"Q (\S+) in place of (\S+) ", told.message)
    assert pair is not None
    assert min(abs(float(v) / drawn.actuator.values["Q"] - 1.0) for v in pair.groups()) < 0.02
    rows = {p.name: p for p in found.extended.parameters}
    assert rows["Q"].verdict == "weakly identified"
    assert rows["N"].verdict == "identified"


@pytest.mark.slow
def test_where_the_stiffness_goes_with_the_pressure_the_logs_tell() -> None:
    """Known truth: a muscle whose material creeps. Nothing is said, and nothing taken back."""
    train, hold_out = hidden_pair(["creep"], seed=3).logs
    effects = ("creep", "creep.series", "delay")
    found = diagnose(train, hold_out=[hold_out], model="muscle", effects=effects)
    assert [cause.key for cause in found.causes] == ["creep"]
    assert OTHER_FORM not in {issue.code for issue in found.issues}


@pytest.mark.parametrize(("bic", "moves"), [(-1.0, True), (1.0, False)])
def test_a_richer_form_that_is_likelier_makes_the_plain_one_less_sure(
    bic: float, moves: bool
) -> None:
    """N with a free exponent lies outside its interval, which holds for a square only."""
    keys = ("quadratic_damping",)
    found = diagnosis(Verdict.NAMED, extended=extended_fit("oscillator", *keys))
    assert found.extended is not None
    damping = found.extended.parameter("N")
    sure = replace(damping, ci95=(0.9 * damping.value, 1.1 * damping.value), verdict="identified")
    rows = tuple(sure if p.name == "N" else p for p in found.extended.parameters)
    found = replace(found, extended=replace(found.extended, parameters=rows))
    before, chosen = ranked((), 100.0), ranked(keys, 0.0)
    power = ranked(("quadratic_damping.power",), bic, values={"N": 0.8 * damping.value})
    rounds = Link(before, (chosen, power, before), chosen, keys, (), 100.0)
    base = SimpleNamespace(scale=scale_of("oscillator"))
    told = with_other_forms(found, [rounds], candidate(keys), cast(BaseFit, base))
    assert told.extended is not None
    verdict = told.extended.parameter("N").verdict
    assert verdict == ("weakly identified" if moves else "identified")
    assert (OTHER_FORM in {issue.code for issue in told.issues}) is moves
