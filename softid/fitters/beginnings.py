"""Fits to the beginnings of all segments, which grow until they are the whole.

A motion that rings goes out of step with a simulation the more, the longer both run: the beginning
of a log has few false minima, and its start values are good. What it teaches leads through the
rest, a part at a time. Pieces from anywhere in a log (`softid.fitters.multiple_shooting`) need
initial states that noise hides where the motion is small; a beginning at rest needs none.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from softid.fitters.levenberg_marquardt import Minimum
from softid.fitters.objective import DRAFT_EVALUATIONS, SCOUT_EVALUATIONS, Objective
from softid.fitters.problem import Problem

FIRST_SHARES = (0.1, 0.16)
"""Part of every segment with which a way begins. Where it holds too little motion its start values
are poor, and where it holds too much they have false minima already; which length is right depends
on the log, so that two are tried."""

GROWTH = 2.0**0.5
"""Each beginning is so many times longer than the one before."""

LEAST_WAY = 0.5
"""A beginning tells enough when its input travels so large a part of what its length would have."""

LEAST_SAMPLES = 50
"""A beginning is no shorter."""

MOST_STARTS = 2
"""Start values of each first beginning that are continued over longer ones."""


def beginning_of(whole: Problem, share: float) -> Problem:
    """A problem over the beginning of every segment, with the same unknowns.

    Parameters
    ----------
    whole
        The problem.
    share
        Part of the samples of every segment that is kept.
    """
    segments = (
        segment.part(slice(max(LEAST_SAMPLES, round(share * segment.time_s.size))))
        for segment in whole.segments
    )
    return Problem.with_segments(whole, list(segments))


def informative_beginning(problem: Problem, enough: int) -> Problem:
    """A problem over as short a beginning of all segments as tells enough; itself where all does.

    Parameters
    ----------
    problem
        The problem.
    enough
        Samples to keep at least, over all segments.
    """
    share = enough / max(problem.n_samples, 1)
    while share < 1.0:
        if _travels_enough(problem, share):
            return beginning_of(problem, share)
        share *= 2.0
    return problem


def _travels_enough(problem: Problem, share: float) -> bool:
    """Whether the beginnings hold half of their share of the way of the input.

    A log may begin with a long rest, of which nothing is learnt.
    """
    way = within = 0.0
    for segment in problem.segments:
        moves = np.abs(np.diff(segment.input))
        way += float(moves.sum())
        within += float(moves[: round(share * moves.size)].sum())
    return within >= LEAST_WAY * share * way


def optima_by_beginnings(
    problem: Problem, sigma: Mapping[str, float]
) -> Iterator[tuple[Minimum, int]]:
    """Optima of the whole that start values of beginnings lead to, the best start of each first.

    Parameters
    ----------
    problem, sigma
        What is to be fitted, and the weights of the channels.

    Yields
    ------
    optimum, evaluations
        And the simulations, of parts or of the whole, that it took.
    """
    ways = [_growing(problem, share) for share in FIRST_SHARES]
    guesses = [problem.model.guess(way[0].plain_segments, problem.outputs[0]) for way in ways]
    for rank in range(MOST_STARTS):
        for way, starts in zip(ways, guesses, strict=True):
            if rank < len(starts):
                yield _continued(way, starts[rank].values_dict(), sigma)


def _growing(problem: Problem, first: float) -> list[Problem]:
    """The problem over beginnings that grow from a first share, and at last over all."""
    count = math.ceil(math.log(1.0 / first) / math.log(GROWTH))
    parts = [beginning_of(problem, first * GROWTH**k) for k in range(count)]
    return [*parts, problem]


def _continued(
    way: Sequence[Problem], values: Mapping[str, float], sigma: Mapping[str, float]
) -> tuple[Minimum, int]:
    """The optimum of the last of a sequence of problems, each begun at that of the one before."""
    evaluations = 0
    for part in way:
        search = Objective(part, sigma)
        most = DRAFT_EVALUATIONS if part is way[-1] else SCOUT_EVALUATIONS
        ended = search.solve(part.unknowns(values), most)
        evaluations += search.evaluations
        values = part.values(ended.point)
    return ended, evaluations
