"""Rounds of a race: every candidate a few evaluations nearer to its optimum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice

import numpy as np

from softid.diagnosis.refit.candidates import Candidate, advance, let_go
from softid.diagnosis.search.catching_up import (
    can_catch_up,
    gain,
    is_outdone,
    one_of_each_place,
)
from softid.parallel import in_parallel

RACING_TOLERANCE = 0.2
"""A candidate in the race rests within a fifth of a standard error of its optimum."""

SECOND_ROUND = 8
"""Evaluations of the second round of a race."""

FAR_ROUND = 24
"""Evaluations of the second round of candidates that began elsewhere, or that follow where another
law has led."""


def run_round(
    candidates: Sequence[Candidate],
    sigma: Mapping[str, float],
    evaluations: int,
    substeps: int,
) -> list[Candidate]:
    """One round of all candidates, on all cores; what the round before pulled back is let go.

    Parameters
    ----------
    candidates
        Where they stand.
    sigma
        Output channel → scale that its residual is divided by.
    evaluations, substeps
        As in `advance`.
    """
    (found,) = run_rounds([(candidates, evaluations)], sigma, substeps)
    return found


def run_rounds(
    rounds: Sequence[tuple[Sequence[Candidate], int]], sigma: Mapping[str, float], substeps: int
) -> list[list[Candidate]]:
    """Several rounds side by side, so that no core waits between them.

    Parameters
    ----------
    rounds
        Candidates and how many evaluations each of them takes; those that take long come first.
    sigma, substeps
        As in `run_round`.
    """
    asked = [(candidate, most) for candidates, most in rounds for candidate in candidates]
    found = iter(in_parallel(lambda task: one_round(task[0], sigma, task[1], substeps), asked))
    return [list(islice(found, len(candidates))) for candidates, _ in rounds]


def one_round(
    candidate: Candidate,
    sigma: Mapping[str, float],
    evaluations: int,
    substeps: int,
    *,
    straight: bool = False,
) -> Candidate:
    """The round of one candidate; what the round before pulled back is let go.

    Parameters
    ----------
    candidate
        Where it stands.
    sigma
        Output channel → scale that its residual is divided by.
    evaluations, substeps, straight
        As in `advance`.
    """
    return advance(
        let_go(candidate),
        sigma,
        evaluations,
        substeps=substeps,
        tolerance=RACING_TOLERANCE,
        straight=straight,
    )


def run_in_reach(
    running: Sequence[Candidate],
    others: Sequence[Candidate],
    sigma: Mapping[str, float],
    evaluations: int,
    substeps: int,
    *,
    known: float = np.inf,
) -> tuple[list[Candidate], list[Candidate]]:
    """Candidates after a round: those that may still catch up with the leader, and the others.

    Parameters
    ----------
    running
        Those that run.
    others
        Those that do not, but may lead.
    sigma
        Output channel → scale that its residual is divided by.
    evaluations, substeps
        As in `advance`.
    known
        As in `those_in_reach`.
    """
    after = run_round(running, sigma, evaluations, substeps)
    return those_in_reach(running, after, others, known=known)


def those_in_reach(
    before: Sequence[Candidate],
    after: Sequence[Candidate],
    others: Sequence[Candidate],
    *,
    known: float = np.inf,
) -> tuple[list[Candidate], list[Candidate]]:
    """Candidates that may still catch up with the leader, and those that cannot.

    Parameters
    ----------
    before, after
        Candidates before a round and after it.
    others
        Those that did not run, but may lead, or stand where one of these does.
    known
        A sum of squares down to which every start leads: what falls to it is no gain.
    """
    all_there = [*after, *others]
    leader = min((c.squares for c in all_there), default=0.0)
    places = one_of_each_place(all_there)
    in_reach, out_of_reach = list[Candidate](), list[Candidate]()
    for began, candidate in zip(before, after, strict=True):
        gained = gain(min(began.squares, known), candidate)
        may_catch_up = candidate in places and can_catch_up(candidate, leader, gained=gained)
        may_catch_up = may_catch_up and not is_outdone(candidate, all_there, gained=gained)
        (in_reach if may_catch_up else out_of_reach).append(candidate)
    return in_reach, out_of_reach


def variance_of(fitted: Candidate) -> float:
    """Variance of the weighted residual.

    Parameters
    ----------
    fitted
        Where it stands.
    """
    return fitted.squares / max(fitted.problem.n_samples - fitted.problem.size, 1)
