"""How far candidates are apart in a race, and who may still catch up with the leader."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from softid.diagnosis.refit.candidates import Candidate

NEAR = 0.3
"""A candidate may catch up with the leader whose ln(S) is so little above the leader's: that may be
little where none explains the misfit."""

REACH = 4.0
"""So may one whose distance, in n ln(S), is less than so many times what its quadratic model
predicts."""

PACE = 3.0
"""And one whose distance is less than so many times what it gained in the round."""

STANDS_STILL = 0.1
"""One that gained less in the round than this share of what its quadratic model still predicts goes
nowhere: a bound, or a curve of the cost that no parabola is like, holds it."""

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
    promised = candidate.minimum.offset**2 * candidate.problem.size
    distance = -gain(leader, candidate)
    return distance <= NEAR * n + REACH * promised or distance <= PACE * gained


def is_outdone(candidate: Candidate, others: Sequence[Candidate], *, gained: float) -> bool:
    """Whether a better one with the same effects will not be left behind by this one.

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
    promised = candidate.minimum.offset**2 * candidate.problem.size
    stands_still = 0.0 <= gained < STANDS_STILL * promised
    hoped_for = max(0.0 if stands_still else REACH * promised, PACE * gained)
    return -gain(mine, candidate) + SMALLEST_GAIN > hoped_for
