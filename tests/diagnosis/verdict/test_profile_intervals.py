"""Intervals of what a cause is made of, where the sum of squares is no parabola."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from handmade import fit_result
from handmade_diagnosis import cause
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.diagnosis.refit.optimum import optimum_of
from softid.diagnosis.search.forward_selection import Chain, converged
from softid.diagnosis.verdict.profile_intervals import with_intervals, with_profile_intervals
from softid.effects import effect_of
from softid.errors import Issue
from softid.fitters.problem import Problem
from softid.identification.estimates import parameter_estimates
from softid.identification.issues import estimate_issue
from softid.identification.parameter_constraints import ParameterConstraints
from softid.identification.parameter_covariance import errors_of
from softid.results import FitResult

WARM_UP = effect_of("sensor_warmup")


def warming(time_constant_s: float) -> tuple[FitResult, Candidate]:
    """A log of 20 s whose reading rises by 2 mrad/s at first, with that effect fitted."""
    time_s = linear_log().time_s
    size = 0.002 * time_constant_s
    added = size * (1.0 - np.exp(-time_s / time_constant_s))
    base = linear_problem([linear_log(noise=0.01, added=added)])
    z = base.unknowns(TRUTH)
    problem = extend(base, (WARM_UP,), scale_of(base, z))
    true = {"sensor_warmup_size": size, "sensor_warmup_time": time_constant_s}
    begun = start_unknowns(problem, base, z, true)
    final = converged(replace(standing(problem, begun, SIGMA), effects=(WARM_UP,)), SIGMA)
    optimum = optimum_of(final, SIGMA)
    constraints = ParameterConstraints.of(problem.model.parameters(), None)
    rows = parameter_estimates(problem, optimum, errors_of(problem, optimum), {}, constraints)
    return replace(fit_result(), parameters=rows), final


def test_a_time_longer_than_the_log_is_open_above() -> None:
    """A log of 20 s under noise does not tell a rise over 25 s from one without end."""
    fit, final = warming(25.0)
    told = with_profile_intervals(fit, final, [WARM_UP], SIGMA).parameter("sensor_warmup_time")
    assert told.ci95 is not None
    assert told.upper is not None
    assert told.ci95[0] < 25.0 < told.ci95[1] == told.upper
    assert (told.ci_method, told.verdict) == ("profile", "weakly identified")
    assert told.reason == "the logs set it no upper limit within its bounds"


def test_remarks_are_those_on_the_intervals_that_are_told() -> None:
    """The other remarks, before and behind those on parameters, stay where they were."""
    fit, final = warming(25.0)
    first, last = Issue("a", "info", "first"), Issue("b", "info", "last")
    earlier = [i for p in fit.parameters if (i := estimate_issue(p)) is not None]
    fit = replace(fit, issues=(first, *earlier, last))
    known = with_profile_intervals(fit, final, [WARM_UP], SIGMA)
    assert (known.issues[0], known.issues[-1]) == (first, last)
    told = [i.message for i in known.issues if "sensor_warmup_time" in i.message]
    reason = "the logs set it no upper limit within its bounds"
    assert told == [f"sensor_warmup_time is weakly identified: {reason}"]


def test_ends_lie_where_the_cost_has_risen() -> None:
    """A rise over 8 s is known to a factor of two. At either end a refit leaves 3.84 more than the
    optimum, for the noise is white and of the size that it is weighted by; 2.8 to 5.5 allow for an
    inflation that is estimated."""
    fit, final = warming(8.0)
    told = with_profile_intervals(fit, final, [WARM_UP], SIGMA).parameter("sensor_warmup_time")
    usual = fit.parameter("sensor_warmup_time")
    assert told.ci_method == "profile"
    assert told.ci95 is not None
    assert usual.ci95 is not None
    assert told.verdict == usual.verdict
    for end, other in zip(told.ci95, usual.ci95, strict=True):
        assert end == pytest.approx(other, rel=0.2)
        held = final.problem.parameters.with_fixed({"sensor_warmup_time": end})
        problem = Problem(final.problem.model, held, final.problem.logs)
        best = converged(standing(problem, problem.unknowns(final.parameters), SIGMA), SIGMA)
        assert 2.8 < best.squares - final.squares < 5.5


def test_beside_a_bound_the_others_are_profiled_too() -> None:
    """A size that is known to 7 %: its interval from the covariance has the time held where it is,
    and is a fraction of the one in which the time may go back."""
    fit, final = warming(8.0)
    usual = fit.parameter("sensor_warmup_size")
    well = replace(usual, stderr=0.01 * abs(usual.value))
    held = replace(fit.parameter("sensor_warmup_time"), at_bound=True, stderr=1e-9)
    others = tuple(p for p in fit.parameters if p.name not in (usual.name, held.name))
    for time, method in ((held, "profile"), (replace(held, at_bound=False), usual.ci_method)):
        known = replace(fit, parameters=(*others, well, time))
        told = with_profile_intervals(known, final, [WARM_UP], SIGMA).parameter(usual.name)
        assert told.ci_method == method


def test_what_is_well_known_or_no_effect_of_these_stays() -> None:
    fit, final = warming(8.0)
    told = with_profile_intervals(fit, final, [WARM_UP], SIGMA)
    for before, after in zip(fit.parameters, told.parameters, strict=True):
        is_rough = before.stderr is not None and before.stderr > 0.1 * abs(before.value)
        changed = is_rough and before.name.startswith("sensor_warmup")
        assert (before is not after) is changed
    assert with_profile_intervals(fit, final, [], SIGMA) is fit


@pytest.mark.parametrize("named", [True, False])
def test_a_named_cause_takes_the_intervals_of_the_fit(named: bool) -> None:
    """What is no more than a description keeps those by which it was judged."""
    fit, final = warming(8.0)
    own = [p for p in fit.parameters if p.name.startswith("sensor_warmup")]
    told = cause("sensor_warmup", own, before=2.0, after=1.0)
    links: Any = (SimpleNamespace(added=WARM_UP),)
    known, (after,) = with_intervals(fit, [told], [named], Chain(links, None, final), SIGMA)
    assert known is not None
    assert (known is fit) is not named
    assert after.parameters == tuple(known.parameter(p.name) for p in own)
    assert ("profile" in {p.ci_method for p in after.parameters}) is named
