"""How far candidates are apart in a race, and who may still catch up with the leader."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from softid.diagnosis.refit.candidates import Candidate

CLOSE_BEHIND = 0.3
"""A candidate may catch up with the leader whose ln(S) is so little above the leader's: that may be
little where none explains the misfit."""

TIMES_PREDICTED = 4.0
"""A candidate may catch up with the leader also where it would be there if its sum of squares fell
by so many times what its quadratic model predicts; one for which that is all of the sum may come
from anywhere."""

PACE = 3.0
"""A candidate may catch up with the leader also where its distance is less than so many times what
it gained in the round."""

STANDS_STILL = 0.1
"""A candidate that gained less in the round than this share of what its quadratic model still
predicts goes nowhere: a bound, or a curve of the cost that no parabola is like, holds it."""

SAME_PLACE = 2.0
"""Two candidates with the same effects stand at one optimum when they are less than so many
standard errors apart, root mean square over the unknowns: each may be one away from it where it
counts as there."""

SMALLEST_GAIN = 4.0
"""When nobody has lowered n ln(S) by this much after two rounds, the race is over."""


def by_squares(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Those that did not run away, the least sum of squares first."""
    finite = [c for c in candidates if np.isfinite(c.minimum.normal.cost)]
    return sorted(finite, key=lambda c: c.squares)


def best_of_each(candidates: Sequence[Candidate]) -> list[Candidate]:
    """The best candidate of every set of effects, the least sum of squares first."""
    best: dict[tuple[str, ...], Candidate] = {}
    for candidate in by_squares(candidates):
        best.setdefault(candidate.keys, candidate)
    return list(best.values())


def one_of_each_place(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Of those that stand at one optimum the best, the least sum of squares first."""
    kept: list[Candidate] = []
    for candidate in by_squares(candidates):
        if not any(is_at_same_place(candidate, better) for better in kept):
            kept.append(candidate)
    return kept


def is_at_same_place(candidate: Candidate, other: Candidate) -> bool:
    """Whether a candidate stands where another one does, by the curvature there.

    It would only follow to the same optimum. The same effects in another order are another model.

    Parameters
    ----------
    candidate, other
        Two candidates, each at its present unknowns.
    """
    mine, problem = candidate.problem, other.problem
    if candidate.keys != other.keys or mine.free != problem.free or mine.size != problem.size:
        return False
    if [effect.key for effect in candidate.acting] != [effect.key for effect in other.acting]:
        return False
    variance = other.squares / max(problem.n_samples - problem.size, 1)
    step = candidate.minimum.point - other.minimum.point
    apart = float(step @ other.minimum.normal.matrix @ step)
    return apart <= SAME_PLACE**2 * problem.size * variance


def gain(squares: float, candidate: Candidate) -> float:
    """Fall of n ln(S) from a sum of squares to a candidate's; n is free of the unknowns.

    Parameters
    ----------
    squares
        The sum of squares before.
    candidate
        Where it stands now; one that ran away has lost everything.
    """
    n = max(candidate.problem.n_samples - candidate.problem.size, 1)
    tiny = float(np.finfo(float).tiny)
    if not np.isfinite(candidate.squares):
        return -np.inf
    return float(n * np.log(max(squares, tiny) / max(candidate.squares, tiny)))


def can_catch_up(candidate: Candidate, leader: float, *, gained: float = 0.0) -> bool:
    """Whether a candidate may still come near the leader's sum of squares.

    Parameters
    ----------
    candidate
        Where it stands.
    leader
        The leader's sum of squares.
    gained
        Fall of n ln(S) in the last round.
    """
    n = max(candidate.problem.n_samples - candidate.problem.size, 1)
    distance = -gain(leader, candidate)
    return distance <= CLOSE_BEHIND * n + _hoped_for(candidate) or distance <= PACE * gained


def is_outdone(candidate: Candidate, others: Sequence[Candidate], *, gained: float) -> bool:
    """Whether another candidate with the same effects is better, and this one cannot pass it.

    Of one law only the best optimum counts, so being near is not enough, nor is a promise that a
    round did not begin to keep.

    Parameters
    ----------
    candidate
        Where it stands.
    others
        All that ran with it, itself among them.
    gained
        Fall of n ln(S) in the last round, negative where that changed the samples.
    """
    mine = min(c.squares for c in others if c.keys == candidate.keys)
    if not candidate.squares > mine:
        return False
    stands_still = 0.0 <= gained < STANDS_STILL * _promised(candidate)
    hoped_for = max(0.0 if stands_still else _hoped_for(candidate), PACE * gained)
    return -gain(mine, candidate) + SMALLEST_GAIN > hoped_for


def _promised(candidate: Candidate) -> float:
    """Fall of the sum of squares that the quadratic model predicts, in variances of the residual.

    So long as it is small beside n, it is that of n ln(S), too.
    """
    return float(candidate.minimum.offset**2 * candidate.problem.size)


def _hoped_for(candidate: Candidate) -> float:
    """Fall of n ln(S) if the sum of squares fell by `TIMES_PREDICTED` times as much."""
    n = max(candidate.problem.n_samples - candidate.problem.size, 1)
    share = TIMES_PREDICTED * _promised(candidate) / n
    return float(-n * np.log1p(-share)) if share < 1.0 else np.inf
