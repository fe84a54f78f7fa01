"""Two causes that take time in place of one of second order that does not ring.

A lag behind a delay is nearly a lag of second order: both are late, and neither starts at once. The
single cause explains more than each of the two, and leaves too little for a second one to be found.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.forward_selection import (
    FIRST,
    Chain,
    converged,
    is_accepted,
    next_link,
)
from softid.effects import own_values
from softid.effects.base import Effect
from softid.effects.scale import Scale


def chain_of_first_order(
    chain: Chain,
    base: Candidate,
    effects: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
) -> Chain | None:
    """The lag in place of a first cause of second order that does not ring; None without one.

    Parameters
    ----------
    chain
        What was found.
    base
        What it began with.
    effects
        The catalogue.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    first = chain.links[0].added if chain.links else None
    if first is None:
        return None
    key = first.first_order(own_values(first, chain.final.parameters))
    if key is None:
        return None
    lags = [effect for effect in effects if effect.key == key]
    link = next_link(base, lags, scale, sigma, FIRST)
    if link is None or not is_accepted(link, FIRST):
        return None
    found = converged(link.chosen.plain, sigma)
    return Chain((replace(link, found=found),), None, found)
