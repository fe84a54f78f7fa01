"""Candidate causes: extended problems, their priors, and steps towards their optimum."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, Bow, base_problem, linear_log, linear_problem, standing

from softid.diagnosis.refit.candidates import (
    BASE_SD,
    COARSE_STEPS,
    EFFECT_SD,
    FINE_STEPS,
    TemperedPrior,
    WhitenedObjective,
    advance,
    let_go,
    limited_plans,
    prior_about,
)
from softid.diagnosis.refit.extension import extend, named_values, start_unknowns
from softid.diagnosis.refit.whitening import Whitener
from softid.effects import ExtendedModel, effect_of
from softid.fitters.problem import Problem
from softid.models.division import NODES_PER_STEP, SMOOTH_NODES
from softid.parameters import Parameter

DRIFT, LAG, FRICTION = (
    effect_of(name) for name in ("sensor_drift", "pneumatic_lag", "coulomb_friction")
)
KNOWN = ("M", "N", "Q")
SIGMA_OF = {(0, "angle"): SIGMA["angle"]}


def test_weights_of_the_prior() -> None:
    """Closed form s²/sd²: 1.5 and 3 in logarithms, 1.5 sizes for a linear one that was known.

    Sensor zeros, and linear parameters of an effect, are held by nothing.
    """
    base, scale = base_problem()
    free = Parameter("offset", 4.0, "kPa", -50.0, 50.0)
    base = Problem(base.model, base.parameters.replacing(free), base.logs)
    problem = extend(base, [DRIFT, LAG], scale)
    centre = np.ones(problem.size)
    centre[problem.free.index("offset")] = -4.0
    prior = prior_about(problem, centre, base.free, variance=9.0)
    weight = dict(zip(problem.free, prior.weight.tolist(), strict=False))
    assert [weight[name] for name in KNOWN] == pytest.approx([9.0 / BASE_SD**2] * 3)
    assert weight["pneumatic_lag_tau"] == pytest.approx(9.0 / EFFECT_SD**2)
    assert weight["offset"] == pytest.approx(9.0 / (4.0 * BASE_SD) ** 2)
    assert weight["sensor_drift_rate"] == 0.0
    assert prior.weight[-1] == 0.0
    assert prior.variance == 9.0


def test_squares_are_those_of_the_residual_alone() -> None:
    """The prior's part of the cost is taken off again."""
    problem, _ = base_problem()
    candidate = standing(problem, problem.unknowns(TRUTH))
    away = candidate.minimum.point + 1.0
    prior = TemperedPrior(away, np.full(problem.size, 2.0))
    normal = candidate.minimum.normal
    raised = replace(normal, cost=normal.cost + prior.cost(candidate.minimum.point))
    held = replace(candidate, prior=prior, minimum=replace(candidate.minimum, normal=raised))
    assert raised.cost - normal.cost == pytest.approx(0.5 * 2.0 * problem.size)
    assert held.squares == pytest.approx(candidate.squares)


def test_steps_in_an_interval_are_capped() -> None:
    """Sharp friction asks for many steps: no more than the cap, and as many as asked below it."""
    base, scale = base_problem()
    problem = extend(base, [FRICTION], scale)
    values = named_values(FRICTION, FRICTION.starts(scale)[0])
    z = start_unknowns(problem, base, base.unknowns(TRUTH), values)
    (whole,) = problem.plans(z)
    assert whole is not None
    assert whole.counts.max() > FINE_STEPS
    for most in (COARSE_STEPS, FINE_STEPS):
        (plan,) = limited_plans(problem, z, most)
        assert plan is not None
        assert np.array_equal(plan.counts, np.minimum(whole.counts, most))  # it is overdamped
    (same,) = limited_plans(problem, z, 10_000)
    assert same is not None
    assert np.array_equal(same.counts, whole.counts)


@pytest.mark.parametrize(
    ("most", "nodes"), [(COARSE_STEPS, SMOOTH_NODES), (FINE_STEPS, NODES_PER_STEP)]
)
def test_a_race_takes_few_nodes(most: int, nodes: int) -> None:
    """A delayed step is where it belongs all the same: the angle errs by a thousandth of its range.

    Beside the steps that an exact simulation takes, with all nodes.
    """
    problem, scale = base_problem()
    delayed = extend(problem, (effect_of("delay"),), scale)
    z = delayed.unknowns({**TRUTH, "delay_tau": 0.053})
    plans = limited_plans(delayed, z, most)
    assert [plan.nodes_per_step for plan in plans if plan is not None] == [nodes]
    rough, exact = (delayed.response(z, 0, plan=p).outputs["angle"] for p in (plans[0], None))
    assert np.abs(rough - exact).max() < 1e-3 * np.ptp(exact)


def test_more_steps_where_the_law_swings() -> None:
    """A hundredth of the damping swings: it asks for several steps, and may have twice the cap."""
    problem, _ = base_problem()
    z = problem.unknowns({**TRUTH, "M": 0.005, "N": 0.1})
    (whole,) = problem.plans(z)
    (plan,) = limited_plans(problem, z, COARSE_STEPS)
    assert whole is not None
    assert plan is not None
    assert whole.counts.max() > 2 * COARSE_STEPS
    assert plan.counts.max() == 2 * COARSE_STEPS


def test_a_step_ends_at_the_optimum() -> None:
    """Known truth: from factors of e^0.5 away back to it, within four standard errors."""
    problem, _ = base_problem()
    truth = problem.unknowns(TRUTH)
    lost = standing(problem, truth + np.array([0.5, -0.5, 0.3, 0.0]))
    found = advance(lost, SIGMA, 60)
    errors = np.sqrt(np.diag(np.linalg.inv(found.minimum.normal.matrix)))
    assert np.all(np.abs(found.minimum.point - truth)[:3] < 4.0 * errors[:3])
    assert found.squares == pytest.approx(996.0, rel=4.0 * np.sqrt(2.0 / 996.0))
    assert found.minimum.offset < 0.05


@pytest.mark.parametrize(
    "whitener", [None, Whitener({(0, "angle"): np.array([0.7])}, {(0, "angle"): 0.01})]
)
def test_what_goes_on_is_not_simulated_again(
    monkeypatch: pytest.MonkeyPatch, whitener: Whitener | None
) -> None:
    """Invariant: a run of one evaluation from where another ended costs the same, at once.

    Where white noise ends a noise model begins with the same columns, and over other logs nothing
    is known.
    """
    problem, scale = base_problem()
    extended = extend(problem, (Bow(),), scale)
    begun = standing(extended, extended.unknowns({**TRUTH, "bow_c": 0.1}))
    known = advance(begun, SIGMA, 3)
    anew = WhitenedObjective(extended, SIGMA, whitener)
    anew.plans = limited_plans(extended, known.minimum.point, FINE_STEPS)
    wanted = anew(known.minimum.point).cost
    elsewhere = Problem(extended.model, extended.parameters, extended.logs)

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("simulated")

    monkeypatch.setattr(ExtendedModel, "response", refuse)
    again = advance(replace(known, whitener=whitener), SIGMA, 1)
    assert again.squares == pytest.approx(2.0 * wanted, rel=1e-9)
    assert advance(again, SIGMA, 1).squares == pytest.approx(again.squares, rel=1e-9)
    with pytest.raises(AssertionError, match="simulated"):
        advance(replace(again, problem=elsewhere), SIGMA, 1)


def test_the_prior_goes_with_the_residual() -> None:
    """Its weight is made for a variance: with a tenth of the residual it weighs a tenth.

    Under a noise model the rows are white, of variance one.
    """
    problem, _ = base_problem()
    candidate = standing(problem, problem.unknowns(TRUTH))
    variance = candidate.squares / (problem.n_samples - problem.size)
    prior = prior_about(problem, candidate.minimum.point, problem.free, 10.0 * variance)
    weighed = advance(replace(candidate, prior=prior), SIGMA, 1).prior
    assert weighed.variance == pytest.approx(variance)
    assert weighed.weight == pytest.approx(0.1 * prior.weight)
    white = Whitener({(0, "angle"): np.zeros(0)}, {(0, "angle"): 0.01})
    whitened = advance(replace(candidate, prior=prior, whitener=white), SIGMA, 1).prior
    assert whitened.variance == 1.0
    assert whitened.weight == pytest.approx(prior.weight / (10.0 * variance))


def test_what_the_prior_pulls_back_is_let_go() -> None:
    """It begins a factor of e⁶ off in all parameters, four standard deviations of the prior, and
    the logs want it at the truth: there the prior costs 3 · 4²/2 variances and is none."""
    problem = linear_problem([linear_log(noise=0.01)])
    far = problem.unknowns({name: np.exp(6.0) * value for name, value in TRUTH.items()})
    begun = standing(problem, problem.unknowns(TRUTH))
    prior = prior_about(problem, far, problem.free, begun.squares / problem.n_samples)
    held = advance(replace(begun, prior=prior), SIGMA, 10)
    assert held.is_pulled
    assert held.prior.cost(held.minimum.point) == pytest.approx(24.0 * held.prior.variance, rel=0.1)
    free = let_go(held)
    assert not free.is_pulled
    assert free.squares == pytest.approx(held.squares)
    assert let_go(free) is free


def test_white_noise_whitens_to_the_plain_objective() -> None:
    """Invariant: without memory the noise model only divides by the standard deviation."""
    problem, _ = base_problem()
    white = Whitener({(0, "angle"): np.zeros(0)}, SIGMA_OF)
    plain = WhitenedObjective(problem, SIGMA, None)(problem.unknowns(TRUTH) + 0.1)
    same = WhitenedObjective(problem, SIGMA, white)(plain.point)  # whose zero is the best one
    assert same.cost == pytest.approx(plain.cost)
    assert same.gradient == pytest.approx(plain.gradient, abs=1e-6)
    assert same.matrix == pytest.approx(plain.matrix)


def test_the_gradient_of_a_whitened_cost() -> None:
    """Stands on central differences of the cost, with coloured noise and a prior."""
    problem, _ = base_problem()
    z = problem.unknowns(TRUTH) + 0.1
    objective = WhitenedObjective(
        problem, SIGMA, Whitener({(0, "angle"): np.array([0.7])}, SIGMA_OF)
    )
    objective.prior = TemperedPrior(z - 0.3, np.full(problem.size, 50.0))
    found = objective(z)
    for k, step in enumerate(1e-5 * np.eye(problem.size)):
        slope = (objective(z + step).cost - objective(z - step).cost) / 2e-5
        assert -found.gradient[k] == pytest.approx(slope, rel=1e-4), k


def test_a_lost_candidate_keeps_its_prior() -> None:
    """Where the response ran away there is no variance; zero times that would be no number."""
    problem, _ = base_problem()
    candidate = standing(problem, problem.unknowns(TRUTH))
    prior = prior_about(problem, candidate.minimum.point, problem.free, 1.0)
    lost = replace(candidate.minimum, normal=replace(candidate.minimum.normal, cost=np.inf))
    kept = advance(replace(candidate, prior=prior, minimum=lost), SIGMA, 1).prior
    np.testing.assert_array_equal(kept.weight, prior.weight)


def test_values_are_named_after_their_effect() -> None:
    """As in an extended model."""
    assert named_values(Bow(), {"c": 2.0}) == {"bow_c": 2.0}


def test_a_base_without_a_finite_response_has_a_prior_all_the_same() -> None:
    """With an infinite variance it would hold everything where it is, and be no number there."""
    problem = linear_problem([linear_log()])
    z = problem.unknowns(TRUTH)
    lost = prior_about(problem, z, problem.free, np.inf)
    usual = prior_about(problem, z, problem.free, 1.0)
    assert lost.weight.tolist() == usual.weight.tolist()
    assert lost.cost(z) == 0.0
