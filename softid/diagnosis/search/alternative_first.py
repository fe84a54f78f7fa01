"""Other first causes, for a search that came to nothing from the best one.

Of two causes the best single one may be a third that stands for both. From there no second one
helps, while from the second best single cause the search goes straight to the truth.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from operator import itemgetter

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.forward_selection import (
    FIRST,
    Chain,
    Link,
    converged,
    is_accepted,
    next_link,
)
from softid.diagnosis.search.screening import screen
from softid.diagnosis_results import Remainder
from softid.effects.base import Effect
from softid.effects.scale import Scale

TRIED = 3
"""Most promising other effects that are tried as the first cause."""

MUCH = 0.3
"""A first cause that takes away this share of the sum of squares is tried even where its BIC does
not fall: what a second cause leaves beside it, slow as a drift, passes for noise that could be
anything."""

LEAST_PROMISE = 0.3
"""Where two causes explain all, the second promises most of what the first leaves; below this share
none is raced."""


def alternative_first_links(
    known: Effect | None,
    base: Candidate,
    effects: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
    *,
    refused: Effect | None = None,
) -> Iterator[Chain]:
    """Chains of one link each: other effects, the most promising first, and other forms of one.

    A second cause makes a richer form of the first the better one, as long as it is missing.

    Parameters
    ----------
    known
        The first cause of the search that came to nothing, None if it found none.
    base
        What it began with.
    effects
        The catalogue.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    refused
        What did best where no first cause was found; if it is not among the `TRIED` that promise
        most, it is tried besides, before them.
    """
    promising = screen(base, effects, scale, sigma)
    names = dict.fromkeys(s.effect.name for s in promising)
    others = [name for name in names if known is None or name != known.name]
    tried = others[:TRIED]
    if refused is not None and refused.name in others[TRIED:]:
        tried = [refused.name, *tried]
    for name in [*tried, *([] if known is None else [known.name])]:
        forms = [effect for effect in effects if effect.name == name and effect != known]
        link = next_link(base, forms, scale, sigma, FIRST, screened=promising)
        if link is not None and (is_accepted(link, FIRST) or _takes_much(link)):
            found = converged(link.chosen.plain, sigma)
            yield Chain((replace(link, found=found),), None, found)


def that_promise_the_rest(
    chains: Iterable[Chain],
    remainder_of: Callable[[Candidate], Remainder],
    effects: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
) -> list[Chain]:
    """Chains whose second cause may take away what the first leaves above the noise.

    The one that would leave least comes first: to race a second cause takes as long as all of this,
    and behind a first cause that stands for both it comes to nothing.

    Parameters
    ----------
    chains
        The base with a first cause each.
    remainder_of
        What a model leaves.
    effects
        The catalogue.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    left = []
    for chain in chains:
        others = [effect for effect in effects if effect.name != chain.final.effects[-1].name]
        most = max((s.drop for s in screen(chain.final, others, scale, sigma)), default=0.0)
        excess = max(remainder_of(chain.final).excess, 0.0)
        misfit = chain.final.squares * excess / (1.0 + excess)
        if most >= LEAST_PROMISE * misfit:
            left.append((chain.final.squares - most, chain))
    return [chain for _, chain in sorted(left, key=itemgetter(0))]


def _takes_much(link: Link) -> bool:
    """Whether a link lowers the plain sum of squares by much."""
    return link.chosen.plain.squares < (1.0 - MUCH) * link.squares_before
