"""Where a refit with one more effect begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import RATE_HZ, SIGMA, TRUTH, Bow, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.search.effect_starts import (
    LIGHT,
    candidate_from,
    forms_of,
    slow_candidate,
    squares_at,
)
from softid.diagnosis.search.screening import screen
from softid.effects import effect_of
from softid.effects.scale import Scale
from softid.fitters.problem import Problem
from softid.log import Log

BOW_SIZE = 0.02


def base_of(problem: Problem) -> tuple[Candidate, Scale]:
    """The truth with the best sensor zero."""
    z = problem.unknowns(TRUTH)
    return standing(problem, z), scale_of(problem, z)


def test_a_candidate_starts_where_the_signature_points() -> None:
    """The whole step is the best fraction where all is linear: nothing is left at once.

    A proposal that is ten times too long is tried at a tenth, which is exact as well.
    """
    plain = linear_log()
    log = linear_log(added=BOW_SIZE * (plain.time_s / plain.time_s[-1]) ** 2)
    base, scale = base_of(linear_problem([log], fixed=True))
    (found,) = screen(base, [Bow()], scale, SIGMA)
    long = replace(found, values={"c": 10.0 * found.values["c"]}, shift=10.0 * found.shift)
    for signature in (found, long):
        made = candidate_from(base, signature, scale, SIGMA, variance=1.0)
        assert made.keys == ("bow",)
        assert made.parameters["bow_c"] == pytest.approx(BOW_SIZE, rel=1e-4)
        (block,) = made.problem.blocks(made.minimum.point, derivatives=False)
        assert np.max(np.abs(block.residual)) < 1e-5
        assert made.prior.centre[0] == pytest.approx(made.minimum.point[0])


def test_a_slow_one_begins_with_a_light_inertia() -> None:
    """At the slowest of its own starts, and the prior where the base was fitted."""
    base, scale = base_of(linear_problem([linear_log(noise=0.01)]))
    ringing = effect_of("line_resonance")
    made = slow_candidate(base, ringing, scale, variance=1.0)
    assert made.parameters["M"] == pytest.approx(LIGHT * TRUTH["M"])
    assert made.parameters["N"] == pytest.approx(TRUTH["N"])
    slowest = max(start["period"] for start in ringing.starts(scale))
    assert made.parameters["line_resonance_period"] == pytest.approx(slowest)
    at = made.problem.free.index("M")
    assert made.prior.centre[at] == pytest.approx(np.log(TRUTH["M"]))


def test_a_slow_one_needs_no_inertia() -> None:
    """With everything of the base held it begins at its own values alone."""
    base, scale = base_of(linear_problem([linear_log(noise=0.01)], fixed=True))
    made = slow_candidate(base, effect_of("pneumatic_lag"), scale, variance=1.0)
    assert made.parameters["M"] == pytest.approx(TRUTH["M"])


def test_a_response_that_is_lost_has_no_sum_of_squares() -> None:
    """By hand: a held input and a spring of 1e-25 hold the angle at 6e26 rad, of which the zero
    takes away all, and the measured angle of 0.1 rad with it."""
    channels = {"pressure": np.full(200, 60.0), "angle": np.full(200, 0.1)}
    log = Log.from_arrays(np.arange(200) / RATE_HZ, channels, units={"angle": "rad"})
    problem = linear_problem([log])
    usual, lost = problem.unknowns(TRUTH), problem.unknowns(TRUTH | {"Q": 1e-25})
    lost[problem.free.index("Q")] = np.log(1e-25)
    assert np.isfinite(squares_at(problem, usual, SIGMA))
    assert squares_at(problem, lost, SIGMA) == np.inf


@pytest.mark.parametrize(
    ("plain", "richer", "own"),
    [
        ("coulomb_friction", "coulomb_friction.stribeck", "coulomb_friction_vb"),
        ("coulomb_friction.stribeck", "coulomb_friction", None),
    ],
)
def test_another_form_begins_at_each_of_its_starts(
    plain: str, richer: str, own: str | None
) -> None:
    """Where the first form stands, with every start of what only the other one has."""
    base, scale = base_of(linear_problem([linear_log(noise=0.01)]))
    effect, other = effect_of(plain), effect_of(richer)
    first = slow_candidate(base, effect, scale, variance=1.0)
    begun = forms_of(base, first, other, scale, 1.0)
    starts = {start["vb"] for start in other.starts(scale)} if own else set[float]()
    assert len(begun) == max(len(starts), 1)
    for candidate in begun:
        assert candidate.keys == (richer,)
        for name in ("M", "N", "Q", "coulomb_friction_Fc", "coulomb_friction_vs"):
            assert candidate.parameters[name] == pytest.approx(first.parameters[name])
    if own:
        assert sorted(c.parameters[own] for c in begun) == pytest.approx(sorted(starts))
