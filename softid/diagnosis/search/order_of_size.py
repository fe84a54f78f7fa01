"""The causes of a chain in the order of what each takes away."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.backward_revision import refit_with_fewer
from softid.diagnosis.search.forward_selection import Chain, Link
from softid.effects.scale import Scale
from softid.parallel import in_parallel

CLEARLY = 0.99
"""A cause goes before another that was found earlier if it leaves less than this share of what that
one does: two that do as much stay as they were found."""


def largest_first(chain: Chain, base: Candidate, scale: Scale, sigma: Mapping[str, float]) -> Chain:
    """The chain with the cause first that takes away most by itself, then what does beside it.

    The search adds the best effect first, but what is revised later may turn out to be something
    small, and a stepping stone to the large one.

    Parameters
    ----------
    chain
        The chain as it was found.
    base
        What it began with.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.

    Returns
    -------
    Chain
        Its links know what was left before them (`Link.left_before`), and the model as it is with
        them (`Link.found`).
    """
    known = _models_of(chain)
    refitted = partial(_with_causes, chain, known, base, scale, sigma)
    remaining, ordered, before = list(chain.links), list[Link](), base
    while remaining:
        taken = [link.added.key for link in ordered]
        models = in_parallel(refitted, [[*taken, link.added.key] for link in remaining])
        first = 0
        for place, model in enumerate(models):
            if model.squares < CLEARLY * models[first].squares:
                first = place
        link = remaining.pop(first)
        ordered.append(replace(link, found=models[first], squares_before_it=before.squares))
        before = models[first]
    return replace(chain, links=tuple(ordered))


def prefix_models(chain: Chain, base: Candidate) -> tuple[Candidate, ...]:
    """The models with no cause, with the first, with the first two, and so on to all of them.

    Parameters
    ----------
    chain
        The chain as `largest_first` orders it.
    base
        What it began with.
    """
    return (base, *(link.found for link in chain.links if link.found is not None))


def _models_of(chain: Chain) -> list[Candidate]:
    """The models at an optimum that the rounds of the search left, and the chain's own."""
    raced = [model for link in chain.links for model in (link.found, *link.contenders)]
    return [chain.final, *(model for model in raced if model is not None)]


def _with_causes(
    chain: Chain,
    known: Sequence[Candidate],
    base: Candidate,
    scale: Scale,
    sigma: Mapping[str, float],
    keys: Sequence[str],
) -> Candidate:
    """The model with some of the causes, as it is known or else refitted."""
    if len(keys) == len(chain.links):
        return chain.final
    found = [model for model in known if set(model.keys) == set(keys)]
    if not found:
        effects = [link.added for link in chain.links if link.added.key in keys]
        found = [refit_with_fewer(chain.final, base, effects, scale, sigma)]
    return min(found, key=lambda model: model.squares)
