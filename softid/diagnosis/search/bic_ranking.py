"""The comparison of refitted candidates under one noise model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from softid.diagnosis.refit.candidates import Candidate, advance
from softid.diagnosis.refit.whitening import Whitener, whitener_of
from softid.diagnosis.residual.noise_model import noise_model_of
from softid.diagnosis.search.catching_up import by_squares, can_catch_up
from softid.parallel import in_parallel

WHITE_ROUNDS = (8, 16)
"""Evaluations of the rounds under the noise model; who cannot catch up stays out of them."""

LAST_ROUND = 32
"""Evaluations of one more round under the noise model, for candidates that are still on their way:
a motion that adds up its force bends so much that they are soon nowhere near their optimum under
another noise model."""

ON_ITS_WAY = 1.0
"""Standard errors from its optimum beyond which a candidate is still on its way."""


@dataclass(frozen=True, eq=False)
class Ranked:
    """A refitted candidate under the noise model that all share.

    Attributes
    ----------
    candidate
        The candidate at its whitened optimum.
    plain
        The candidate at its optimum for white noise, which is the one to simulate with: whitening
        makes slow errors cheap.
    bic
        n ln(S/n) + k ln n with S the whitened sum of squares and k the number of unknowns.
    """

    candidate: Candidate
    plain: Candidate
    bic: float

    @property
    def misfit(self) -> float:
        """The part of the BIC that is no price of parameters, n ln(S/n)."""
        n, k = self.candidate.minimum.normal.n, self.candidate.problem.size
        return self.bic - k * float(np.log(n))


def rank(
    candidates: Sequence[Candidate],
    sigma: Mapping[str, float],
    *,
    whitener: Whitener | None = None,
) -> list[Ranked]:
    """Refit all under the noise model of the best one and compare them by BIC, best first.

    What cannot catch up is only evaluated, but for the one that all others extend.

    Parameters
    ----------
    candidates
        What has been refitted, the base among them, best first.
    sigma
        Output channel → scale that its residual is divided by, which floors the noise.
    whitener
        A noise model; None fits it to what the best candidate leaves.
    """
    best = by_squares(candidates)[0]
    model = whitener or noise_model_of(best, sigma)

    placed = [
        replace(c, minimum=replace(c.minimum, damping=None), whitener=model) for c in candidates
    ]
    white = in_parallel(lambda c: advance(c, sigma, 1), placed)
    fewest, *others = sorted(len(c.effects) for c in candidates)
    all_extend_one = fewest not in others

    def polished(candidate: Candidate, leader: float, evaluations: int) -> Candidate:
        is_extended = all_extend_one and len(candidate.effects) == fewest
        if not is_extended and not can_catch_up(candidate, leader):
            return candidate
        return advance(candidate, sigma, evaluations)

    for evaluations in WHITE_ROUNDS:
        leader = min(c.squares for c in white)
        white = in_parallel(partial(polished, leader=leader, evaluations=evaluations), white)
    leader = min(c.squares for c in white)
    going = [k for k, c in enumerate(white) if c.minimum.offset > ON_ITS_WAY]
    last = in_parallel(
        partial(polished, leader=leader, evaluations=LAST_ROUND), [white[k] for k in going]
    )
    for k, candidate in zip(going, last, strict=True):
        white[k] = candidate
    ranked = [Ranked(w, c, bic_of(w)) for w, c in zip(white, candidates, strict=True)]
    return sorted(ranked, key=lambda r: r.bic)


def rank_either_way(
    candidates: Sequence[Candidate], sigma: Mapping[str, float]
) -> list[list[Ranked]]:
    """As `rank`, and where jumps of the input may have come at other moments, as drawn besides.

    What the input did between its samples beside a jump is not its moment alone: a law may follow
    the rest, or the moments.

    Parameters
    ----------
    candidates, sigma
        As in `rank`.
    """
    ranked = rank(candidates, sigma)
    whitener = ranked[0].candidate.whitener
    if whitener is None or not whitener.unknown:
        return [ranked]
    best = by_squares(candidates)[0]
    as_drawn = whitener_of(best.problem, best.minimum.point, sigma)
    return [ranked, rank(candidates, sigma, whitener=as_drawn)]


def is_likelier(one: Candidate, other: Candidate, sigma: Mapping[str, float]) -> bool:
    """Whether the BIC of one model is below that of another, under one noise model.

    Parameters
    ----------
    one, other
        Models at their optimum for white noise.
    sigma
        Output channel → scale that its residual is divided by.
    """
    return rank([one, other], sigma)[0].plain is one


def bic_of(white: Candidate) -> float:
    """N ln(S/n) + k ln n with S the whitened sum of squares and k the number of unknowns.

    Parameters
    ----------
    white
        A candidate under a noise model.
    """
    n, k = white.minimum.normal.n, white.problem.size
    spread = max(white.squares, np.finfo(float).tiny)
    return float(n * np.log(spread / n) + k * np.log(n))
