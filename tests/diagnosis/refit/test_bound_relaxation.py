"""Bounds that go by the force of a base that misses the actuator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem, standing

from softid.diagnosis.refit.bound_relaxation import released, with_own_bounds
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns, with_fewer_effects
from softid.diagnosis.refit.rough_copy import over_samples_of
from softid.diagnosis.search.effect_starts import with_effect
from softid.diagnosis.search.forward_selection import converged
from softid.effects import ExtendedModel, effect_of
from softid.effects.stiffening import Stiffening

LOG = linear_log(noise=0.01)
EFFECT, DRIFT = Stiffening(), effect_of("sensor_drift")
SCALE = scale_of(linear_problem([LOG]), linear_problem([LOG]).unknowns(TRUTH))


def standing_at(share: float, *, force: float) -> Candidate:
    """The truth with a stiffening at a share of its upper bound, for so small a share of the force.

    The bound is ten times the force over the cube of the position.
    """
    base = linear_problem([LOG])
    z = base.unknowns(TRUTH)
    scale = scale_of(base, z)
    problem = extend(base, (EFFECT,), replace(scale, force=force * scale.force))
    upper = problem.parameters["stiffening_k3"].upper
    begun = start_unknowns(problem, base, z, {"stiffening_k3": share * upper})
    found: Candidate = replace(standing(problem, begun, SIGMA), effects=(EFFECT,))
    return found


def test_a_size_at_the_bound_of_a_weak_base_gets_its_own() -> None:
    """By hand: the bound goes with the force, so it is a hundred times what the base allowed."""
    held = standing_at(1.0, force=0.01)
    freed = with_own_bounds(held)
    before, after = (c.problem.parameters["stiffening_k3"] for c in (held, freed))
    assert after.upper == pytest.approx(100.0 * before.upper)
    assert after.lower <= before.lower
    assert np.array_equal(freed.minimum.point, held.minimum.point)
    model = freed.problem.model
    assert isinstance(model, ExtendedModel)
    assert model.parameters()["stiffening_k3"].upper == pytest.approx(after.upper)
    assert freed.problem.parameters["Q"] == held.problem.parameters["Q"]


def test_what_stays_or_comes_back_stands_where_it_stood() -> None:
    """Bounds of its own are kept when another effect goes and when it is added again.

    Clipped to those of the base it would begin at a hundredth of its size.
    """
    freed = with_own_bounds(standing_at(1.0, force=0.01))
    weak = replace(SCALE, force=0.01 * SCALE.force)
    base, whole = linear_problem([LOG]), extend(freed.problem, (DRIFT,), weak)
    size = 50.0 * freed.parameters["stiffening_k3"]
    start = {"stiffening_k3": size, "sensor_drift_rate": 0.0}
    both = start_unknowns(whole, base, base.unknowns(TRUTH), start)
    alone, z = with_fewer_effects(whole, both, base, (EFFECT,), weak)
    assert alone.values(z)["stiffening_k3"] == pytest.approx(size)
    lower, upper = alone.bounds()
    assert np.all((z >= lower) & (z <= upper))
    fitted, standing_both = standing(base, base.unknowns(TRUTH)), standing(whole, both)
    again = with_effect(fitted, standing_both, EFFECT, weak)
    assert again.parameters["stiffening_k3"] == pytest.approx(size)


def test_what_is_seen_over_other_samples_keeps_its_bounds() -> None:
    """A race over averages, and the refit after it, begin where the candidate stands."""
    freed = with_own_bounds(standing_at(1.0, force=0.01))
    weak = replace(SCALE, force=0.01 * SCALE.force)
    base = linear_problem([LOG])
    fitted = standing(base, base.unknowns(TRUTH))
    there = over_samples_of(freed, fitted, weak)
    assert there.problem.parameters["stiffening_k3"] == freed.problem.parameters["stiffening_k3"]
    assert there.parameters == freed.parameters
    lower, upper = there.problem.bounds()
    point = there.minimum.point
    assert np.all((point >= lower) & (point <= upper))


@pytest.mark.parametrize(("share", "force"), [(0.5, 0.01), (1.0, 1.0)])
def test_others_keep_theirs(share: float, force: float) -> None:
    """A size within its bounds is not held, and a base with the true force knows its bounds."""
    candidate = standing_at(share, force=force)
    assert with_own_bounds(candidate) is candidate


def test_a_limit_of_the_sensor_goes_with_the_zero_of_its_log() -> None:
    """By hand: a base whose zero was one radian higher had every bound one radian lower."""
    base, clipping = linear_problem([LOG]), effect_of("sensor_clipping.lower")
    z = base.unknowns(TRUTH)
    below = replace(SCALE, y_low=SCALE.y_low - 1.0, y_high=SCALE.y_high - 1.0)
    problem = extend(base, (clipping,), below)
    upper = problem.parameters["sensor_clipping_lower"].upper
    begun = start_unknowns(problem, base, z, {"sensor_clipping_lower": upper})
    held = replace(standing(problem, begun, SIGMA), effects=(clipping,))
    freed = with_own_bounds(held)
    after = freed.problem.parameters["sensor_clipping_lower"]
    # The range reaches from the lower of both ends to the higher; seven tenths of it may be cut.
    assert after.upper == pytest.approx(upper + 0.7, abs=0.02)
    assert after.lower <= held.problem.parameters["sensor_clipping_lower"].lower
    assert np.array_equal(freed.minimum.point, held.minimum.point)
    right = extend(base, (clipping,), SCALE)
    at = right.parameters["sensor_clipping_lower"].upper
    there = start_unknowns(right, base, z, {"sensor_clipping_lower": at})
    known = replace(standing(right, there, SIGMA), effects=(clipping,))
    assert with_own_bounds(known) is known


def test_what_an_earlier_effect_needed_at_its_bound_is_let_go() -> None:
    """The log has no stiffening: a start away from the bound leads back to what leaves less."""
    held = standing_at(1.0, force=1.0)
    free = released(held, (EFFECT,), SIGMA)
    assert "stiffening_k3" in held.at_bound
    assert "stiffening_k3" not in free.at_bound
    assert free.squares < held.squares


def test_only_earlier_effects_at_their_bounds_are_let_go() -> None:
    """Not one that was added last, nor one within its bounds."""
    held, within = standing_at(1.0, force=1.0), standing_at(0.5, force=1.0)
    assert released(held, (), SIGMA) is held
    assert released(within, (EFFECT,), SIGMA) is within


def test_settling_goes_on_behind_the_bound() -> None:
    """The answer of a spring of 40 kPa/rad³, for which the base would allow 24: within three sd.

    They are those of white noise, with the input at which the spring rests unknown, 1.2 kPa/rad³.
    """
    true = standing_at(0.5, force=1.0).problem
    theta = true.theta(true.unknowns({**TRUTH, "offset": 0.0, "stiffening_k3": 40.0}))
    (segment,) = true.segments
    exact = true.model.response(theta, segment, ("angle",), start=None, derivatives=False)
    noise = 0.01 * np.random.default_rng(5).standard_normal(segment.time_s.size)
    angle = replace(LOG.channels["angle"], values=exact.outputs["angle"] + noise)
    base = linear_problem([replace(LOG, channels=dict(LOG.channels) | {"angle": angle})])
    z = base.unknowns(TRUTH)
    scale = scale_of(base, z)
    weaker = replace(scale, force=2.4 * scale.x_span * scale.x_high**2)
    weak = extend(base, (EFFECT,), weaker)
    assert weak.parameters["stiffening_k3"].upper == pytest.approx(24.0)
    begun = start_unknowns(weak, base, z, {"stiffening_k3": 5.0})
    candidate = replace(standing(weak, begun, SIGMA), effects=(EFFECT,))
    settled = converged(candidate, SIGMA)
    at = settled.problem.free.index("stiffening_k3")
    sd = float(np.sqrt(np.linalg.inv(settled.minimum.normal.matrix)[at, at]))
    assert sd < 1.5
    assert abs(settled.parameters["stiffening_k3"] - 40.0) < 3.0 * sd
