"""Candidate causes: the base model with effects added, refitted to the same logs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.state_sizes import bounds_of, reach_of
from softid.diagnosis.refit.whitening import Place, Whitener
from softid.effects import ExtendedModel
from softid.effects.base import Effect
from softid.fitters.levenberg_marquardt import Minimum, NormalEquations, cautiously, minimise
from softid.fitters.objective import Objective, Prior
from softid.fitters.problem import Problem
from softid.models.division import Division, divided
from softid.segment import Segment

if TYPE_CHECKING:
    from softid.models.second_order import Law

Array = npt.NDArray[np.float64]

BASE_SD = 1.5
"""Standard deviation of the log-normal prior about the base fit: a flat direction cannot run away
and make a wrong name look good."""

RESTING_OFFSET = 1e-2
"""A refit rests within a hundredth of a standard error of its optimum."""

PULLS = 2.0
"""Cost of the prior, in variances of the residual, from which it holds back a refit that the logs
want elsewhere: by two standard deviations along one direction. Two levels of the input leave a base
anywhere along a valley of its curves, ten and more away from where a cause would have it."""

COARSE_STEPS = 1
"""Most steps in a sampling interval while candidates race; twice as many where an affine law
oscillates, and few nodes in each at which effects on the input act. Overdamped and sharp laws ask
for more to reach 1e-4 of the range; noise is far above what this costs."""

FINE_STEPS = 2
"""Most steps in a sampling interval while candidates are compared; twice as many where an affine
law oscillates."""

EFFECT_SD = 3.0
"""Standard deviation of the prior of an effect's parameters about their start, in logarithms: a
start knows a size to a factor of twenty, and a time constant hardly better."""


@dataclass(frozen=True, eq=False)
class TemperedPrior(Prior):
    """A prior that knows for which variance of the residual its weight was made.

    Attributes
    ----------
    variance
        Variance of the weighted residual.
    """

    variance: float = 1.0


@dataclass(frozen=True, eq=False)
class Candidate:
    """The base with effects, somewhere on its way to the optimum.

    Attributes
    ----------
    effects
        Its effects in the order in which they were added; none for the base itself.
    problem
        The extended model and the logs.
    minimum
        Where it stands now.
    prior
        What holds its flat directions.
    whitener
        The noise model by which its cost was last computed; None for white noise.
    """

    effects: tuple[Effect, ...]
    problem: Problem
    minimum: Minimum
    prior: TemperedPrior
    whitener: Whitener | None = field(default=None)

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of its effects."""
        return tuple(effect.key for effect in self.effects)

    @property
    def names(self) -> frozenset[str]:
        """Names of the effects, in whatever form."""
        return frozenset(effect.name for effect in self.effects)

    @property
    def acting(self) -> tuple[Effect, ...]:
        """Its effects in the order in which they act within their stage."""
        model = self.problem.model
        return model.effects if isinstance(model, ExtendedModel) else ()

    @property
    def squares(self) -> float:
        """Weighted sum of squares, without the prior."""
        cost = self.minimum.normal.cost - self.prior.cost(self.minimum.point)
        return 2.0 * max(cost, 0.0)

    @property
    def is_pulled(self) -> bool:
        """Whether the prior keeps it away from the optimum of the logs alone."""
        return self.prior.cost(self.minimum.point) > PULLS * self.prior.variance

    @property
    def has_spring(self) -> bool:
        """Whether anything pulls the motion back to a rest."""
        law = self.problem.model.motion_law(self.problem.theta(self.minimum.point))
        if law is None:
            return True
        u = np.concatenate([segment.input for segment in self.problem.segments])
        return bool(np.any(law.coefficients(u)[1] > 0.0))

    @property
    def parameters(self) -> dict[str, float]:
        """Parameter → value where it stands."""
        return self.problem.values(self.minimum.point)

    @property
    def at_bound(self) -> frozenset[str]:
        """Free parameters that lie on a bound where it stands."""
        held = self.problem.at_bound(self.minimum.point)
        return frozenset(n for n, is_held in zip(self.problem.free, held, strict=False) if is_held)

    @property
    def at_upper_bound(self) -> frozenset[str]:
        """Free parameters that lie on their upper bound where it stands."""
        values, rows = self.parameters, self.problem.parameters
        nearer = {n for n in self.at_bound if values[n] > 0.5 * (rows[n].lower + rows[n].upper)}
        return frozenset(nearer)


class WhitenedObjective(Objective):
    """Cost and normal equations of residuals that a noise model has made white."""

    def __init__(
        self, problem: Problem, sigma: Mapping[str, float], whitener: Whitener | None
    ) -> None:
        super().__init__(problem, sigma)
        self.whitener = whitener

    def __call__(self, z: Array) -> NormalEquations:
        """Cost ½Σ(W r/σ)² and its normal equations at ``z``."""
        if self.whitener is None:
            return super().__call__(z)
        found = self._at(z, columns=True).with_zeros_of(z)
        size = self.problem.size
        cost, n = 0.0, 0
        gradient, matrix = np.zeros(size), np.zeros((size, size))
        with np.errstate(all="ignore"):
            kept = found.blocks(derivatives=True) if found.kept else None
            for block in kept or self.problem.blocks(z, derivatives=True, plans=self.plans):
                assert block.jacobian is not None
                rows = np.column_stack((block.residual, block.jacobian))
                white = self.whitener.whiten(rows, Place.of(block, self.problem))
                r, jacobian = white[:, 0], white[:, 1:]
                cost += 0.5 * float(r @ r)
                gradient += jacobian.T @ r
                matrix += jacobian.T @ jacobian
                n += r.size
        if not (np.isfinite(cost) and np.isfinite(gradient).all() and np.isfinite(matrix).all()):
            return NormalEquations(z, np.inf, np.zeros(size), np.eye(size), n)
        whitened = replace(found, cost=cost, gradient=gradient, matrix=matrix, n=n)
        return self._with_prior(whitened)

    def second_derivative(self, z: Array, step: Array, normal: NormalEquations) -> Array | None:
        """Geodesic acceleration for white noise; None, so no correction, for whitened residuals."""
        return super().second_derivative(z, step, normal) if self.whitener is None else None


def prior_about(
    problem: Problem, centre: Array, known: Sequence[str], variance: float
) -> TemperedPrior:
    """The prior of a refit.

    Parameters
    ----------
    problem
        The extended problem.
    centre
        Base fit and start of the added parameters, shape (U,).
    known
        Free parameters of what is extended.
    variance
        Variance of the weighted residual; where what is extended has no finite response, it is
        taken as 1, which the weights make it.
    """
    variance = max(variance, float(np.finfo(float).tiny)) if np.isfinite(variance) else 1.0
    weight = np.zeros(problem.size)
    for k, name in enumerate(problem.free):
        p = problem.parameters[name]
        if p.scale == "log":
            weight[k] = variance / (BASE_SD if name in known else EFFECT_SD) ** 2
        elif name in known:
            weight[k] = variance / max(abs(centre[k]), 1.0) ** 2 / BASE_SD**2
    return TemperedPrior(centre.copy(), weight, variance)


def standing_at(point: Array, minimum: Minimum, prior: TemperedPrior, squares: float) -> Minimum:
    """Where a candidate begins, before anything is evaluated there.

    The cost holds the prior's part, which belongs to the point: a cost that was computed elsewhere
    would count it into the sum of squares, or leave less than nothing of that.

    Parameters
    ----------
    point
        Unknowns, shape (U,).
    minimum
        Where it comes from.
    prior
        The prior under which it will go on.
    squares
        What is known of its weighted sum of squares.
    """
    normal = replace(minimum.normal, cost=0.5 * squares + prior.cost(point))
    return replace(minimum, point=point, normal=normal, damping=None)


def begun(known: Candidate, effects: Sequence[Effect], problem: Problem, z: Array) -> Candidate:
    """A candidate with other effects, at unknowns that come from a model that stands.

    Parameters
    ----------
    known
        That model; what only the candidate has is held by the wider prior.
    effects
        The effects of the candidate.
    problem
        Its problem.
    z
        Its unknowns, shape (U,).
    """
    variance = known.squares / max(problem.n_samples - problem.size, 1)
    prior = prior_about(problem, z, known.problem.free, variance)
    placed = standing_at(z, known.minimum, prior, known.squares)
    return Candidate(tuple(effects), problem, placed, prior)


def let_go(candidate: Candidate) -> Candidate:
    """A candidate with its prior about where it stands, if that pulls it back to where it began.

    A direction that the logs do not see stays held: nothing leads along it.

    Parameters
    ----------
    candidate
        Where it stands.
    """
    if not candidate.is_pulled:
        return candidate
    point = candidate.minimum.point
    prior = replace(candidate.prior, centre=point.copy())
    minimum = standing_at(point, candidate.minimum, prior, candidate.squares)
    return replace(candidate, prior=prior, minimum=minimum)


@cautiously()  # also where a thread of its own refits
def advance(
    candidate: Candidate,
    sigma: Mapping[str, float],
    evaluations: int,
    *,
    substeps: int = FINE_STEPS,
    tolerance: float = RESTING_OFFSET,
    straight: bool = False,
) -> Candidate:
    """Take a candidate nearer to its optimum.

    Parameters
    ----------
    candidate
        Where it stands.
    sigma
        Output channel → scale that its residual is divided by.
    evaluations
        At most so many simulations with derivatives.
    substeps
        At most so many steps in a sampling interval.
    tolerance
        Stop within this many standard errors of the optimum.
    straight
        Whether steps go straight instead of along the bend of the response, which costs another
        simulation each.
    """
    objective = WhitenedObjective(candidate.problem, sigma, candidate.whitener)
    candidate = _tempered(candidate)
    objective.prior = candidate.prior
    point = candidate.minimum.point
    objective.plans = limited_plans(candidate.problem, point, substeps)
    objective.begin_with(candidate.minimum.normal)
    lower, upper = bounds_of(candidate.problem)
    found = minimise(
        objective,
        point,
        lower,
        upper,
        reach_of(candidate.problem),
        evaluations=evaluations,
        tolerance=tolerance,
        second_derivative=None if straight else objective.second_derivative,
        damping=candidate.minimum.damping,
    )
    return replace(candidate, minimum=found)


def _tempered(candidate: Candidate) -> Candidate:
    """The prior in proportion to the variance of the residual as it is now, if that is finite."""
    prior = candidate.prior
    n = max(candidate.problem.n_samples - candidate.problem.size, 1)
    variance = 1.0 if candidate.whitener is not None else candidate.squares / n
    if not np.isfinite(variance):
        return candidate
    variance = max(variance, float(np.finfo(float).tiny))
    factor = variance / prior.variance
    return replace(candidate, prior=replace(prior, weight=prior.weight * factor, variance=variance))


def limited_plans(problem: Problem, unknowns: Array, substeps: int) -> list[Division | None]:
    """The division of the sampling intervals with no more than so many steps in each.

    Where the law oscillates twice as many are allowed: errors of its phase add up.
    """
    law = problem.model.motion_law(problem.theta(unknowns))
    return [
        limited_plan(plan, segment, law, substeps)
        for plan, segment in zip(problem.plans(unknowns), problem.segments, strict=True)
    ]


def limited_plan(
    plan: Division | None, segment: Segment, law: Law | None, substeps: int
) -> Division | None:
    """The division of one segment's sampling intervals, as in `limited_plans`.

    Parameters
    ----------
    plan
        The division that an exact simulation would take; None where the model has none.
    segment
        What is simulated.
    law
        Its law of motion.
    substeps
        As there.
    """
    if plan is None:
        return None
    if substeps == COARSE_STEPS:
        plan = replace(plan, bends_in_s=np.inf)
    if plan.counts.max(initial=1) <= substeps:
        return plan
    most = np.where(_oscillates(law, segment.input), 2 * substeps, substeps)
    counts = np.minimum(plan.counts, most)
    return divided(segment.time_s, segment.input, counts, bends_in_s=plan.bends_in_s)


def _oscillates(law: Law | None, u: Array) -> npt.NDArray[np.bool_]:
    """Whether a law swings about its rest within every sampling interval, shape (n − 1,)."""
    if law is None:
        return np.zeros(u.size - 1, bool)
    damping, stiffness, _ = law.coefficients(u)
    with np.errstate(over="ignore"):
        swings = damping**2 < 4.0 * law.mass * stiffness
    return np.asarray(swings[1:] | swings[:-1], bool)


def prior_sd(model: Candidate, place: int) -> float:
    """Standard deviation of a prior that knows a free parameter to a factor of 4.5.

    Parameters
    ----------
    model
        A refit.
    place
        Of the parameter among the free ones.

    Returns
    -------
    float
        On the parameter's own scale.
    """
    problem = model.problem
    is_relative = problem.parameters[problem.free[place]].scale == "log"
    return BASE_SD * (1.0 if is_relative else max(abs(float(model.minimum.point[place])), 1.0))
