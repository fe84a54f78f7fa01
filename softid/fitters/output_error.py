"""Simultaneous output-error fit: all logs and outputs at once, from several starts, and checked.

Minimises Σ_c Σ_k (y_ck − ŷ_ck)²/σ_c² over the unknowns of a `Problem`, σ_c being the residual's own
standard deviation when several channels are fitted together, with a prior so weak that it only
holds what the data cannot see. The optimiser's word is not taken for
success: the distance from the optimum in standard errors must be small at the end, and perturbed
restarts must not find anything better.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.fitters.levenberg_marquardt import Minimum, attainable_offset, movable
from softid.fitters.normal_equations import Linearised
from softid.fitters.objective import (
    DRAFT_EVALUATIONS,
    RESTING_OFFSET,
    SCOUT_EVALUATIONS,
    Objective,
)
from softid.fitters.problem import Problem
from softid.fitters.rivals import best_rival
from softid.fitters.scouting import cost_of, scouts, searched
from softid.parallel import in_parallel
from softid.results import FitStatus

Array = npt.NDArray[np.float64]
Progress = Callable[[str, float], None]

POLISH_EVALUATIONS = 400
"""Evaluations of a run that is to reach the optimum. A backstop: the tolerance or a stall is meant
to end it before, and a run that ends here is judged by its offset."""

NUISANCE_EVALUATIONS = 40
"""Evaluations that look for initial states alone; zeros move by themselves. A few do, unless the
motion sticks and slips: then it bends so much that no number would."""

OFFSET_TOLERANCE = 5e-2
"""Largest `attainable_offset` at which the optimum counts as reached: the estimate is then within a
twentieth of its own white-noise standard error of it. The optimiser itself aims at a thousandth;
where the parameters make up for each other almost exactly, rounding stops it in between."""

RESTARTS = 3
"""Perturbed restarts of a round, each with the evaluations of a scout; a judgement."""

RESTART_SPREAD = 0.3
"""Standard deviation of a perturbation, in units of half the unknown's reach or of the unknown, at
least 1, whichever is less: 35 % of a parameter on a logarithmic scale. A judgement."""

MAX_ROUNDS = 4
"""Rounds of restarts at most. Each one that finds something better calls for another; a fit that
still improves in the last is not called converged."""

LEAST_COST_DROP = 1e-3
"""Share by which the cost of a rival is lower: a thousandth, below which rivals are alike."""

BETTER_SAMPLES = 4.0
"""Samples of white noise whose weight a rival's cost is lower by at least, where that is less than
`LEAST_COST_DROP`, beyond 4000 samples: a cost lower by what four of them weigh is a χ² lower by 4,
two standard errors of one parameter."""

RELEASE_EVALUATIONS = 60
"""Evaluations of the last run, without the prior. It begins at the optimum with the prior, which
stays where so many do not suffice."""

RELEASE_REACHES = 3.0
"""Farthest move without the prior, in units of what is plausible; farther, the prior was needed."""

RESIDUAL_FLOOR = 1e-9
"""Residuals below this share of the range of a channel are rounding: no weight is finer, and rivals
of such an optimum are not asked."""

_REWEIGHTS = 4
"""Turns of weights and optimum, each weighted by the residual of the one before. A judgement:
whether the weights have settled is not asked."""


@dataclass(frozen=True, eq=False)
class Optimum:
    """Where an output-error fit ended.

    Attributes
    ----------
    unknowns
        Vector of unknowns of the `Problem`, shape (U,).
    cost
        Half the weighted sum of squares, without the prior.
    sigma
        Output channel → weight σ_c.
    status
        Whether the optimum was reached.
    offset
        `attainable_offset` at the end.
    evaluations
        Simulations of all logs, over all starts.
    at_bound
        Which unknowns lie on a bound, shape (U,).
    start
        Unknowns at the start that led here, shape (U,).
    linearised
        The normal equations there, which may still hold columns or residuals; None without them.
    """

    unknowns: Array
    cost: float
    sigma: Mapping[str, float]
    status: FitStatus
    offset: float
    evaluations: int
    at_bound: npt.NDArray[np.bool_]
    start: Array
    linearised: Linearised | None = None


def output_error(
    problem: Problem,
    starts: Sequence[Mapping[str, float]],
    *,
    rng: np.random.Generator,
    rounds: int = MAX_ROUNDS,
    thorough: bool = True,
    progress: Progress | None = None,
) -> Optimum:
    """Fit a problem from several starts.

    Parameters
    ----------
    problem
        What to fit.
    starts
        Parameter name → value, one mapping per start, the most promising one first.
    rng
        Draws the perturbed restarts.
    rounds
        How often at most a better optimum is looked for, at least once.
    thorough
        As in `best_rival`.
    progress
        Called with a sentence and the fraction done.

    Returns
    -------
    Optimum
        The best point found; its status says whether it may be trusted.
    """
    report = progress or (lambda message, fraction: None)
    objective = Objective(problem, {name: _span(problem, name) for name in problem.outputs})
    report("searching from several starts", 0.1)
    scouted, alone = searched(objective, starts, alone_if_white=True, far=True)
    if not scouted:
        return _nothing(objective, [problem.unknowns(start) for start in starts[:1]])
    report("refining the best starts", 0.3)
    is_rival = False
    if alone:
        best, start = scouted[0]  # the data hold every parameter, and need no prior
    else:
        best, start, is_rival = _basin(objective, scouted[:2], report, thorough=thorough)
    best = objective.solve(best.point, POLISH_EVALUATIONS)
    best = _reweighted(objective, best)
    report("looking for a better optimum", 0.6)
    stable = alone
    if not alone:
        best, stable = _challenge(objective, best, start, rng, rounds)
    if not alone and not is_rival:
        report("looking for a better optimum", 0.7)
        rival = _rival(objective, best, thorough=thorough)
        if rival is not None:
            report("looking for a better optimum", 0.8)
            best, stable = _challenge(objective, *rival, rng, rounds)
            start = rival[1]
    report("checking the optimum", 0.9)
    best = objective.with_columns(_released(objective, best))
    return _judge(objective, best, start, stable=stable)


def draft_fit(
    problem: Problem, starts: Sequence[Mapping[str, float]], *, far: bool = True
) -> Optimum:
    """Fit a problem roughly: one contender, few evaluations, no search for a better optimum.

    Parameters
    ----------
    problem, starts
        As in `output_error`.
    far
        Whether the starts may be far off, so that fewer samples lead the way to the optimum.
    """
    objective = Objective(problem, {name: _span(problem, name) for name in problem.outputs})
    scouted, _ = searched(objective, starts, alone_if_white=False, far=far)
    if not scouted:
        return _nothing(objective, [problem.unknowns(start) for start in starts[:1]])
    best, start = _polished(objective, scouted[0], DRAFT_EVALUATIONS)
    best = objective.solve(best.point, DRAFT_EVALUATIONS)
    return _judge(objective, _reweighted(objective, best), start, stable=True)


def refit_nuisance(problem: Problem) -> Optimum:
    """Estimate zeros and initial states; parameters are fixed but for a few near their values."""
    objective = Objective(problem, {name: _span(problem, name) for name in problem.outputs})
    start = problem.unknowns(problem.parameters.values_dict())
    return _judge(objective, objective.solve(start, NUISANCE_EVALUATIONS), start, stable=True)


def _span(problem: Problem, name: str) -> float:
    rows = ((s.outputs[name], s.used[name]) for s in problem.segments)
    parts = [y if used.all() else y[used] for y, used in rows if used.any()]
    span = max(float(y.max()) for y in parts) - min(float(y.min()) for y in parts) if parts else 0.0
    return span if span > 0.0 else 1.0


def _basin(
    objective: Objective,
    contenders: Sequence[tuple[Minimum, Array]],
    report: Progress,
    *,
    thorough: bool,
) -> tuple[Minimum, Array, bool]:
    """The better one of the contenders at its optimum, its start, and whether a rival led there.

    A contender that a draft does not settle creeps along a valley, often one with a false optimum
    at its end: before it is followed there, rivals are asked. Where several channels are fitted,
    their weights have to settle first.
    """
    polished = _all_polished(objective, contenders, DRAFT_EVALUATIONS)
    creeping = [row for row in polished if row[0].offset > RESTING_OFFSET]
    best, start = min(polished, key=cost_of)
    objective.set_prior(start, best)
    report("refining the best starts", 0.4)
    if creeping and len(objective.problem.outputs) == 1:
        rival = _rival(objective, best, thorough=thorough)
        if rival is not None:
            return *rival, True
    if creeping:
        report("refining the best starts", 0.5)
        polished += _all_polished(objective, creeping, POLISH_EVALUATIONS)
        best, start = min(polished, key=cost_of)
        objective.set_prior(start, best)
    return best, start, False


def _all_polished(
    objective: Objective, rows: Sequence[tuple[Minimum, Array]], evaluations: int
) -> list[tuple[Minimum, Array]]:
    """Contenders nearer to their optima, side by side."""

    def polished(row: tuple[Minimum, Array]) -> tuple[tuple[Minimum, Array], int]:
        alone = Objective(objective.problem, objective.sigma)
        alone.begin_with(row[0].normal)
        return _polished(alone, row, evaluations), alone.evaluations

    found = in_parallel(polished, rows, small=True)
    objective.evaluations += sum(taken for _, taken in found)
    rows = [row for row, _ in found]
    objective.begin_with(min(rows, key=cost_of)[0].normal)
    return rows


def _polished(
    objective: Objective, row: tuple[Minimum, Array], evaluations: int
) -> tuple[Minimum, Array]:
    """A contender nearer to its optimum, held near its start."""
    found, start = row
    objective.set_prior(start, found)
    return objective.solve(found.point, evaluations), start


def _rival(objective: Objective, best: Minimum, *, thorough: bool) -> tuple[Minimum, Array] | None:
    """A better basin than that of an optimum, at its own optimum, and the start there."""
    problem = objective.problem
    point, used = best_rival(problem, objective.sigma, best, thorough=thorough)
    objective.evaluations += used
    if point is best.point:
        return None
    objective.set_prior(point, best)
    return objective.solve(point, POLISH_EVALUATIONS), point


def _reweighted(objective: Objective, best: Minimum) -> Minimum:
    """With several channels, let each weight be its own residual's standard deviation."""
    if len(objective.problem.outputs) == 1:
        return best
    for _ in range(_REWEIGHTS):
        parts: dict[str, list[Array]] = {name: [] for name in objective.problem.outputs}
        for block in objective.problem.blocks(best.point, derivatives=False):
            parts[block.channel].append(block.residual)
        for name, residuals in parts.items():
            floor = RESIDUAL_FLOOR * _span(objective.problem, name)
            objective.sigma[name] = max(float(np.std(np.concatenate(residuals))), floor)
        best = objective.solve(best.point, POLISH_EVALUATIONS)
    return best


def _challenge(
    objective: Objective, best: Minimum, start: Array, rng: np.random.Generator, rounds: int
) -> tuple[Minimum, bool]:
    """Restart near the optimum until nothing better turns up; False when it never settles.

    The first restart also takes back what has drifted far from its start: a term that has faded
    away has no gradient left by which it could return.
    """
    n_free = len(objective.problem.free)
    if n_free == 0:
        return best, True
    reach = objective.problem.reach()[:n_free]
    for _ in range(rounds):
        points = []
        for k in range(RESTARTS):
            point = best.point.copy()
            if k == 0:
                drifted = np.abs(point[:n_free] - start[:n_free]) > reach
                point[:n_free][drifted] = start[:n_free][drifted]
            size = np.minimum(reach / 2.0, np.maximum(np.abs(point[:n_free]), 1.0))
            point[:n_free] += RESTART_SPREAD * size * rng.standard_normal(n_free)
            points.append(point)
        if best.normal.cost <= 0.5 * best.normal.n * RESIDUAL_FLOOR**2:
            return best, True  # what is left is rounding, and a rival's is as likely to be less
        rivals = scouts(objective, points, SCOUT_EVALUATIONS)
        margin = min(LEAST_COST_DROP, BETTER_SAMPLES / max(best.normal.n, 1))
        if not rivals or rivals[0][0].normal.cost > best.normal.cost * (1 - margin):
            return best, True
        rival = objective.solve(rivals[0][0].point, POLISH_EVALUATIONS)
        if rival.normal.cost > best.normal.cost * (1 - margin):
            return best, True  # it was better by its own division of the steps only
        best = rival
    return best, False


def _released(objective: Objective, best: Minimum) -> Minimum:
    """The optimum without the prior, if the data hold every parameter near where it is."""
    if best.offset > OFFSET_TOLERANCE or objective.prior is None:
        return best
    prior, objective.prior = objective.prior, None
    free = objective.solve(best.point, RELEASE_EVALUATIONS)
    moved = np.abs(free.point - best.point) / objective.problem.reach()
    far = np.max(moved[: len(objective.problem.free)], initial=0.0)
    if np.isfinite(free.normal.cost) and free.offset <= OFFSET_TOLERANCE and far <= RELEASE_REACHES:
        return free
    objective.prior = prior
    return best


def _judge(objective: Objective, best: Minimum, start: Array, *, stable: bool) -> Optimum:
    z, normal = best.point, best.normal
    lower, upper = objective.problem.bounds()
    reach = objective.problem.reach()
    at_bound = objective.problem.at_bound(z)
    told = slice(len(objective.problem.free) or None)  # zeros move by themselves
    moving = movable(z, normal.gradient, lower, upper)
    offset = attainable_offset(normal, moving, reach, floor=RESIDUAL_FLOOR)
    if not np.isfinite(normal.cost):
        status = FitStatus.NON_FINITE
    elif offset <= OFFSET_TOLERANCE and stable:
        status = FitStatus.CONVERGED
    elif np.allclose(z[told], np.clip(start, lower, upper)[told], rtol=2e-3, atol=1e-12):
        status = FitStatus.NOT_MOVED
    elif not stable:
        status = FitStatus.STILL_IMPROVING
    else:
        status = FitStatus.MAX_EVALUATIONS if best.used_up else FitStatus.NOT_OPTIMAL
    return Optimum(
        z,
        normal.cost - (objective.prior.cost(z) if objective.prior else 0.0),
        dict(objective.sigma),
        status,
        offset,
        objective.evaluations,
        at_bound,
        start,
        normal if isinstance(normal, Linearised) else None,
    )


def _nothing(objective: Objective, points: Sequence[Array]) -> Optimum:
    z = points[0] if points else np.zeros(objective.problem.size)
    return Optimum(
        z,
        np.inf,
        dict(objective.sigma),
        FitStatus.NON_FINITE,
        np.inf,
        objective.evaluations,
        np.zeros(z.size, bool),
        z,
    )
