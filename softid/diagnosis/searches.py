"""Searches for a chain of causes: the usual one, and others where it came to nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from softid.diagnoses import Remainder
from softid.diagnosis.assessment import EXPLAINED, LEAST_GAIN, assess, held_out_share, nameable
from softid.diagnosis.beginning import Asked, Beginning, Given, Progress
from softid.diagnosis.candidates import Candidate, catalogue
from softid.diagnosis.chain import MAX_LINKS, Chain, Link, find_chain
from softid.diagnosis.held_out import BETTER, NO_WORSE
from softid.diagnosis.indistinct import with_rivals_in_misfit
from softid.diagnosis.other_first import other_beginnings
from softid.diagnosis.other_places import candidates_elsewhere, has_vanished
from softid.diagnosis.revision import revised
from softid.effects.base import Effect

BETTER_BASE = 0.98
"""Another optimum of the base counts when it leaves so much less than the first."""

ALIKE = 1e-3
"""Models of the same structure whose sums of squares differ by less are at the same optimum."""

BETTER_PLACE, NEAR_CURVE = 0.99, 1.02
"""Candidates from elsewhere join the race when one leaves less than this share of what the first
cause does, or of what a curve with more unknowns does."""


class Found(NamedTuple):
    """What a search found.

    Attributes
    ----------
    chain
        The causes.
    remainder
        What they leave.
    is_named
        Which of them may be named.
    begun
        The model with the cause that was found first, as it was then; None without a cause.
    """

    chain: Chain
    remainder: Remainder
    is_named: tuple[bool, ...]
    begun: Candidate | None = None

    @property
    def came_to_nothing(self) -> bool:
        """Whether structure is left and no cause explains it."""
        return self.remainder.structured and not any(self.is_named)

    @property
    def is_sure(self) -> bool:
        """Whether causes may be named that leave noise and next to nothing of the misfit.

        So many more tries find something that explains most of any misfit.
        """
        whole = self.remainder.explained_share > EXPLAINED
        return any(self.is_named) and whole and not self.remainder.structured


def searched_thoroughly(
    given: Given,
    asked: Asked,
    start: Beginning,
    effects: Sequence[str],
    report: Progress,
    first: Chain | None,
) -> tuple[Found, Beginning]:
    """What a search finds, and where it came to nothing what one from elsewhere does.

    Parameters
    ----------
    given
        The logs.
    asked
        What the user asked for.
    start
        The base, and what it is judged by.
    effects
        Keys of the effects to consider; empty for the whole catalogue.
    report
        Called with a sentence and the fraction done.
    first
        The chain with its first link, if it was looked for already.

    Returns
    -------
    found, start
        And the base that the search began with, which may be another optimum.
    """
    seed = asked.seed
    found = _searched(start, effects, report, seed, first)
    if not found.came_to_nothing:
        return found, start
    again = asked.begin(given.logs, given.hold_out, thorough=True)
    if again.base.squares < BETTER_BASE * start.base.squares:  # the base was a false optimum
        start = again
        found = _searched(start, effects, report, seed, None)
        if not found.came_to_nothing:
            return found, start
    other = from_other_places(start, found, effects, report, seed)
    other = other or _from_other_causes(start, found.chain, effects, report, seed)
    return other or found, start


def _searched(
    start: Beginning,
    effects: Sequence[str],
    report: Progress,
    seed: int,
    begun: Chain | None = None,
) -> Found:
    """The chain of causes, each judged by what is held out; what it leaves; what may be named."""
    considered = catalogue(effects)
    if begun is not None and not begun.links:
        chain = begun
    else:
        chain = extended(start, considered, report, seed, begun=begun, max_links=2)
    if _stands_for_another(start, chain, seed):
        found = _tried_elsewhere(start, considered, chain, report, seed, BETTER_PLACE)
        if found is not chain:
            chain = extended(start, considered, report, seed, begun=found, max_links=2)
    first = chain.links[0].found if chain.links else None
    if len(chain.links) > 1:  # a wrong first cause would ask for a third that mends it
        chain = _asked_again(start, considered, chain, report)
        longer = extended(start, considered, report, seed, begun=chain)
        if len(longer.links) > len(chain.links):
            chain = _asked_again(start, considered, longer, report)
        else:
            chain = replace(chain, last=longer.last)
    before, after = start.held.rms(start.base), start.held.rms(chain.final)
    if chain.links and after > (1.0 - LEAST_GAIN) * before:
        chain = Chain((), chain.links[0], start.base)  # a chain that gains nothing is chance
        after = before
    report("looking at what is left", 0.85)
    remainder = _left(start, chain.final, seed)
    if remainder.structured:
        chain = replace(chain, links=tuple(with_rivals_in_misfit(link) for link in chain.links))
    remainder = replace(remainder, held_out_share=held_out_share(before, after, remainder))
    is_named = nameable(chain.links, chain.final, remainder, gain=1.0 - after / before)
    largest_first = sorted(
        zip(chain.links, is_named, strict=True), key=lambda pair: -pair[0].squares_before
    )
    links = tuple(link for link, _ in largest_first)
    is_named = tuple(sure for _, sure in largest_first)
    return Found(replace(chain, links=links), remainder, is_named, first)


def _stands_for_another(start: Beginning, chain: Chain, seed: int) -> bool:
    """Whether a single cause leaves structure that nothing takes away, and was never tried so."""
    if len(chain.links) != 1 or len(chain.links[0].added.amplitudes) > 1:
        return False
    return not has_vanished(start.base) and _left(start, chain.final, seed).structured


def from_other_places(
    start: Beginning, known: Found, effects: Sequence[str], report: Progress, seed: int
) -> Found | None:
    """What a search finds from other places of the base, if that is sure.

    Parameters
    ----------
    start, effects, report
        As in `searched_thoroughly`.
    known
        What was found without them: where they lead to the same first cause, the rest is known.
    seed
        As in `extended`.
    """
    if has_vanished(start.base):
        return None  # then they were tried at first
    considered = catalogue(effects)
    besides = _elsewhere(start, considered)
    begun = extended(start, considered, report, seed, besides=besides, max_links=1)
    if known.begun is not None and _is_same(begun.final, known.begun):
        return None
    found = _searched(start, effects, report, seed, begun)
    return found if found.is_sure else None


def _is_same(one: Candidate, other: Candidate) -> bool:
    """Whether two models have the same causes and explain as much."""
    return one.keys == other.keys and abs(one.squares / other.squares - 1.0) < ALIKE


def _from_other_causes(
    start: Beginning, chain: Chain, effects: Sequence[str], report: Progress, seed: int
) -> Found | None:
    """What a search finds from another first cause, if that is sure."""
    sigma, considered = dict(start.work.found.optimum.sigma), catalogue(effects)
    known = chain.links[0].added.name if chain.links else None
    for begun in other_beginnings(known, start.base, considered, start.scale, sigma):
        longer = extended(start, considered, report, seed, begun=begun, max_links=2)
        left = _left(start, longer.final, seed)
        if not left.structured and left.explained_share > EXPLAINED:
            found = _searched(start, effects, report, seed, longer)
            if found.is_sure:
                return found
    return None


def _asked_again(
    start: Beginning, considered: Sequence[Effect], chain: Chain, report: Progress
) -> Chain:
    """The chain with its earlier causes revised, unless that is worse on what is held out."""
    report("checking the first causes again", 0.75)
    sigma = dict(start.work.found.optimum.sigma)
    again = revised(chain, start.base, considered, start.scale, sigma)
    if start.held.rms(again.final) <= NO_WORSE * start.held.rms(chain.final):
        return again
    return chain


def extended(
    start: Beginning,
    considered: Sequence[Effect],
    report: Progress,
    seed: int,
    *,
    begun: Chain | None = None,
    besides: Sequence[Candidate] = (),
    max_links: int = MAX_LINKS,
) -> Chain:
    """The base extended by causes that what is held out does not speak against.

    Parameters
    ----------
    start
        The base, and what it is judged by.
    considered
        The effects.
    report
        Called with a sentence and the fraction done.
    seed
        Of the shifts that say what chance would make of noise.
    begun
        Causes that are known already.
    besides, max_links
        As in `find_chain`.
    """
    if begun is None:
        begun = _first_link(start, considered, report, seed, besides)
        if max_links == 1 or not begun.links:
            return begun
    return _led_on(start, considered, report, seed, begun, max_links=max_links)


def _first_link(
    start: Beginning,
    considered: Sequence[Effect],
    report: Progress,
    seed: int,
    besides: Sequence[Candidate],
) -> Chain:
    """The first cause, with candidates from elsewhere where the base is no place to begin.

    It is none when a term of it has vanished. A curve with free values bends to much that it is
    not: before it is believed the others are tried from elsewhere, too.
    """
    nothing = Chain((), None, start.base)
    if not besides and has_vanished(start.base):
        besides = _elsewhere(start, considered)
    chain = _led_on(start, considered, report, seed, nothing, besides=besides, max_links=1)
    if not besides and chain.links and len(chain.links[0].added.amplitudes) > 1:
        return _tried_elsewhere(start, considered, chain, report, seed, NEAR_CURVE)
    return chain


def _tried_elsewhere(
    start: Beginning,
    considered: Sequence[Effect],
    chain: Chain,
    report: Progress,
    seed: int,
    share: float,
) -> Chain:
    """A chain of one link, or another where a candidate from elsewhere leaves less than a share.

    The link is that of a race of the same effects from the base.
    """
    besides = _elsewhere(start, considered)
    if min((c.squares for c in besides), default=np.inf) > share * chain.final.squares:
        return chain
    nothing, raced = Chain((), None, start.base), chain.links[0]
    return _led_on(
        start, considered, report, seed, nothing, besides=besides, raced=raced, max_links=1
    )


def _elsewhere(start: Beginning, considered: Sequence[Effect]) -> list[Candidate]:
    """Candidates from other places of the base, sought once."""
    keys = tuple(effect.key for effect in considered)
    if keys not in start.elsewhere:
        sigma = dict(start.work.found.optimum.sigma)
        start.elsewhere[keys] = candidates_elsewhere(start.base, considered, start.scale, sigma)
    return start.elsewhere[keys]


def _led_on(
    start: Beginning,
    considered: Sequence[Effect],
    report: Progress,
    seed: int,
    begun: Chain,
    *,
    besides: Sequence[Candidate] = (),
    raced: Link | None = None,
    max_links: int,
) -> Chain:
    """A chain led on by causes that what is held out does not speak against."""

    def holds(before: Candidate, after: Candidate) -> bool:
        limit = BETTER if before.effects else NO_WORSE
        return start.held.rms(after) <= limit * start.held.rms(before)

    def is_noise(now: Candidate) -> bool:
        return not _left(start, now, seed).structured

    return find_chain(
        begun.final,
        considered,
        start.scale,
        dict(start.work.found.optimum.sigma),
        holds=holds,
        is_noise=is_noise,
        report=lambda message, fraction: report(message, 0.3 + 0.4 * fraction),
        begun=begun.links,
        besides=besides,
        raced=raced,
        max_links=max_links,
    )


def _left(start: Beginning, now: Candidate, seed: int) -> Remainder:
    return assess(start.base, now, start.scale, rng=np.random.default_rng(seed))
