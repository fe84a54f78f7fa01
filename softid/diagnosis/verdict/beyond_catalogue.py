"""What a misfit is like that no effect of the catalogue accounts for: laws in no catalogue.

None of them is named as a cause. One that takes away nearly all, also on what is held out, is told
as what is worth looking at.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.assessment import held_out_share
from softid.diagnosis.residual.one_step import is_one_step
from softid.diagnosis.search.bic_ranking import rank
from softid.diagnosis.search.contenders import INDISTINCT
from softid.diagnosis.search.forward_selection import select_forward
from softid.diagnosis.verdict.refitted_laws import refitted_with, standing_of
from softid.diagnosis.verdict.unlisted_laws import (
    BEYOND_ONE,
    NEAR_TWO,
    UNLISTED_LAWS,
    Law,
    suiting,
)
from softid.effects import belongs_to, extended_name
from softid.effects.base import Effect
from softid.parallel import in_parallel

TAKEN_SOON, TAKEN_ROUGHLY, LEAST_TAKEN = 0.5, 0.8, 0.9
"""Share of the misfit above the noise that a law in no catalogue takes away: soon, at its optimum
over averages, and in the end."""

TAKEN_IN_PART, MOST_BEGUN = 0.2, 2
"""Share of the misfit above the noise that a law in no catalogue takes away by itself at least,
where a cause beside it is looked for, and how many laws that is done for."""

CARRIES = 0.8
"""Share of the misfit above the noise on what is held out that a law in no catalogue takes away."""

WHOLE_SHARE, OUTDONE_RATIO = 0.96, 0.9
"""A law in no catalogue is all that is missing when it takes so much on fitted and held-out
samples, and outdoes a cause when it leaves less than this share of what the cause does."""

AS_NOISE = 1.3
"""A law in no catalogue leaves nothing to look for where its mean square is at most so many times
that of the noise: of a misfit that is large beside the noise a twenty-fifth may still be a cause of
its own."""


@dataclass(frozen=True)
class BeyondCatalogue:
    """Laws in no catalogue that account for a misfit.

    Attributes
    ----------
    laws
        The best first; the others explain as much.
    share, held_out_share
        What the best takes away of the misfit above the noise, on the fitted samples and on those
        held out.
    squares, noise
        Weighted sum of squares that the best leaves, and that of the noise.
    sizes
        Values and units of the parameters of the best, without where it begins.
    beside
        The causes beside which the best does that.
    """

    laws: tuple[Effect, ...]
    share: float
    held_out_share: float
    squares: float
    noise: float
    sizes: tuple[tuple[float, str], ...] = ()
    beside: tuple[Effect, ...] = ()

    @property
    def is_whole(self) -> bool:
        """Whether next to nothing is left for anything else."""
        return min(self.share, self.held_out_share) > WHOLE_SHARE

    def outdoes(self, cause: Candidate) -> bool:
        """Whether the best explains so much that no second cause need be looked for.

        One that two causes may do as well leaves that open.

        Parameters
        ----------
        cause
            The base with the best cause of the catalogue.
        """
        if isinstance(self.laws[0], NEAR_TWO):
            return False
        leaves_nothing = self.is_whole and self.squares < AS_NOISE * self.noise
        return leaves_nothing and self.squares < OUTDONE_RATIO * cause.squares


def squares_of_noise(base: BaseFit, noise: float) -> float:
    """Weighted sum of squares of the noise over the fitted logs.

    Parameters
    ----------
    base
        The base fit.
    noise
        Variance of the noise of the first output.
    """
    return noise / max(base.rms**2, np.finfo(float).tiny) * base.candidate.squares


def beyond_catalogue(
    base: BaseFit,
    noise: float,
    laws: Sequence[type[Law]] = BEYOND_ONE,
    *,
    beside: Candidate | None = None,
    at_starts: bool = False,
) -> BeyondCatalogue | None:
    """The laws in no catalogue that account for what a model leaves, if there are any.

    There is none where the logs hold a single step, whose answer many a law follows.

    Parameters
    ----------
    base
        The base fit.
    noise
        Variance of the noise of the first output.
    laws
        Those that are tried.
    beside
        The base with causes, which then also stay; None for the base alone.
    at_starts
        As in `standing_of`.
    """
    known = beside or base.candidate
    left = squares_of_noise(base, noise)
    if not known.squares > left or is_one_step(known.problem):
        return None
    near, hopeful = (
        left + (1.0 - share) * (known.squares - left) for share in (TAKEN_SOON, TAKEN_ROUGHLY)
    )
    standing, kept = standing_of(known, base, at_starts=at_starts), known.acting
    found = in_parallel(
        lambda law: refitted_with(standing, kept, (law(),), near=near, enough=hopeful),
        suiting(laws, is_linear=base.candidate.problem.model.is_linear),
    )
    enough = [one for one in found if one is not None and _share(known, one, left) > LEAST_TAKEN]
    ranked = rank([known, *enough], base.sigma) if enough else []
    alike = [row.plain for row in ranked if row.bic < ranked[0].bic + INDISTINCT]
    others = [one for one in alike if one is not known]
    carried = [one for one in others if _held(base, known, one, noise) > CARRIES]
    if not carried:
        return None
    return _told(base, known, carried, tuple(one.effects[-1] for one in carried), noise)


def beyond_and_cause(
    base: BaseFit, noise: float, effects: Sequence[Effect]
) -> BeyondCatalogue | None:
    """A law in no catalogue that accounts for a misfit together with one cause of the catalogue.

    The laws that take away most by themselves are extended by the cause that then does.

    Parameters
    ----------
    base, noise
        As in `beyond_catalogue`.
    effects
        The catalogue.
    """
    known, sigma = base.candidate, base.sigma
    left = squares_of_noise(base, noise)
    if not known.squares > left or is_one_step(known.problem):
        return None
    near = known.squares - TAKEN_IN_PART * (known.squares - left)
    standing = standing_of(known, base)
    found = in_parallel(
        lambda law: refitted_with(standing, (), (law(),), near=known.squares, enough=near),
        suiting(UNLISTED_LAWS, is_linear=known.problem.model.is_linear),
    )
    begun = sorted((one for one in found if one is not None), key=lambda one: one.squares)
    for one in begun[:MOST_BEGUN]:
        chain = select_forward(
            one,
            effects,
            base.scale,
            sigma,
            is_no_worse=lambda before, after: base.held_out.rms(after) < base.held_out.rms(before),
            is_noise=lambda model: False,
            max_links=1,
        )
        both = chain.final
        taken = min(_share(known, both, left), _held(base, known, both, noise))
        if chain.links and taken > WHOLE_SHARE:
            return _told(base, known, [both], one.effects, noise)
    return None


def _told(
    base: BaseFit,
    known: Candidate,
    models: Sequence[Candidate],
    laws: tuple[Effect, ...],
    noise: float,
) -> BeyondCatalogue:
    """What models with one law each take away of what another one leaves, the best first."""
    best, left = models[0], squares_of_noise(base, noise)
    declared, values, first = best.problem.parameters, best.parameters, laws[0].plain_at
    beginning = extended_name(laws[0], first[0]) if first else ""
    own = [name for name in declared.names if belongs_to(laws[0], name) and name != beginning]
    sizes = tuple((values[name], declared[name].unit) for name in own)
    share, held = min(_share(known, best, left), 1.0), _held(base, known, best, noise)
    beside = tuple(effect for effect in best.effects if effect is not laws[0])
    return BeyondCatalogue(laws, share, held, best.squares, left, sizes, beside)


def _share(known: Candidate, other: Candidate, noise: float) -> float:
    """Share of the misfit above the noise that goes."""
    return (known.squares - other.squares) / (known.squares - noise)


def _held(base: BaseFit, known: Candidate, other: Candidate, noise: float) -> float:
    """The same on what is held out."""
    held = base.held_out
    return held_out_share(held.rms(known), held.rms(other), noise)
