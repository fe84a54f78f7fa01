"""Short runs from many starts, which only have to tell the good ones from the bad."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from softid.fitters.levenberg_marquardt import Minimum
from softid.fitters.noise_level import at_noise_level
from softid.fitters.objective import SCOUT_EVALUATIONS, Objective
from softid.fitters.problem import Problem
from softid.fitters.thinned import WarmStart, rough_problem, warm_start, warm_starts
from softid.parallel import in_parallel

Array = npt.NDArray[np.float64]

SCOUTS = 2
"""Starts that are scouted at a time, after the most promising one alone; when one of them ends at
the noise level, the last."""

FIRST_TIMES = 2
"""The most promising start, which usually is the only one, gets so many times the evaluations."""


def searched(
    objective: Objective,
    starts: Sequence[Mapping[str, float]],
    *,
    alone_if_white: bool,
    far: bool,
) -> tuple[list[tuple[Minimum, Array]], bool]:
    """Scouts from the starts in turn, best first, and whether one has ended at the noise level.

    Parameters
    ----------
    objective
        What they minimise.
    starts
        Parameter name → value, one mapping per start, the most promising one first.
    alone_if_white
        Whether the search ends with the first one that leaves no more than white noise.
    far
        Whether the starts may be far off, so that fewer samples lead the way.
    """
    starts = [start for start in starts if keeps_ties(objective.problem, start)]
    rough: Problem | None = None
    first = 1 if alone_if_white else SCOUTS
    most = FIRST_TIMES * SCOUT_EVALUATIONS
    if starts and far:
        rough = rough_problem(objective.problem, objective.problem.free_unknowns(starts[0]))
    points = [objective.problem.unknowns(start, with_zeros=False) for start in starts]
    warm = warm_starts(objective, points, rough, most) if rough is not None else []
    begins: Sequence[Array | WarmStart] = [*warm, *points[len(warm) :]]
    scouted: list[tuple[Minimum, Array]] = []
    for begin, end in itertools.pairwise([0, *range(first, len(starts), SCOUTS), len(starts)]):
        limit = most if begin == 0 and alone_if_white else SCOUT_EVALUATIONS
        found = scouts(objective, begins[begin:end], limit, rough)
        scouted = sorted([*scouted, *found], key=cost_of)
        if not (alone_if_white and scouted):
            continue
        scouted[0] = objective.with_columns(scouted[0][0]), scouted[0][1]
        if at_noise_level(objective.problem, scouted[0][0]):
            return scouted, True
    return scouted, False


def keeps_ties(problem: Problem, start: Mapping[str, float]) -> bool:
    """Whether every tie stays within its bounds at a start.

    Parameters
    ----------
    problem
        What is to be fitted.
    start
        Parameter name → value.
    """
    return bool(np.isfinite(problem.theta(problem.free_unknowns(start))).all())


def scouts(
    objective: Objective,
    begins: Sequence[Array | WarmStart],
    limit: int,
    rough: Problem | None = None,
) -> list[tuple[Minimum, Array]]:
    """Short runs from every start, best first.

    Where there is a rough problem they lead through it, and go on over all samples from there.

    Parameters
    ----------
    objective
        What they minimise; it goes on from the last evaluation of the best one.
    begins
        Unknowns of shape (U,), or warm starts that are known already.
    limit
        Evaluations of each.
    rough
        A problem of fewer samples that leads the way.
    """

    def run(begin: Array | WarmStart) -> tuple[Minimum, Array, Objective]:
        own = Objective(objective.problem, objective.sigma)
        if isinstance(begin, WarmStart):
            warm = begin
        else:
            warm = (
                WarmStart(begin, begin) if rough is None else warm_start(own, begin, rough, limit)
            )
        own.prior = objective.prior
        found = own.solve(warm.point, limit, damping=warm.damping)
        return found, warm.start, own

    rows = in_parallel(run, begins, small=True)
    objective.evaluations += sum(own.evaluations for _, _, own in rows)
    rows = sorted((row for row in rows if np.isfinite(row[0].normal.cost)), key=cost_of)
    if rows:
        objective.adopt(rows[0][2])
    return [(found, point) for found, point, _ in rows]


def cost_of(row: tuple[Minimum, Array] | tuple[Minimum, Array, Objective]) -> float:
    """Cost at the end of a run, with the prior's part."""
    return row[0].normal.cost
