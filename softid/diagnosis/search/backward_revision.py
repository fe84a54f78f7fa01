"""Earlier links of a chain, seen again in the light of the later ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from softid.diagnosis.refit.candidates import Candidate, advance, begun
from softid.diagnosis.refit.extension import with_fewer_effects
from softid.diagnosis.search.bic_ranking import rank
from softid.diagnosis.search.effect_starts import candidate_from, squares_at, with_effect
from softid.diagnosis.search.forward_selection import (
    FURTHER,
    Chain,
    Link,
    converged,
    is_accepted,
    next_link,
)
from softid.diagnosis.search.racing import CLEAR_LEAD
from softid.diagnosis.search.rounds import variance_of
from softid.diagnosis.search.screening import Signature, screen
from softid.effects.base import Effect
from softid.effects.scale import Scale
from softid.parallel import in_parallel

WITHOUT_ROUND = 25
"""Evaluations that bring a chain without one of its links to its optimum."""

HOPELESS_RATIO = 3.0
"""A link is not asked again when every rival was behind by more than so many times what the later
links took away."""

ELSEWHERE = 0.9
"""Causes stand at another optimum when they leave less than this share of what they left before."""

PROMISING = 6
"""Effects of so many best signatures are asked again, besides those that were ranked."""


def revised(
    chain: Chain,
    base: Candidate,
    effects: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
) -> Chain:
    """Ask for every earlier cause again which effect belongs there, given the others.

    The first of two causes was chosen while the second was still in the residual, which may have
    favoured a wrong one, or its plain form. A cause that no longer pays is dropped.

    Parameters
    ----------
    chain
        The chain as it was found.
    base
        What it began with.
    effects
        The catalogue.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    chain = _without_stepping_stone(chain, base, scale, sigma)
    links, now = list(chain.links), chain.final
    for position in range(len(links) - 2, -1, -1):
        mine = links[position].added
        forms = [effect for effect in effects if effect.name == mine.name]
        is_sure = _is_beyond_doubt(links[position], now)
        if is_sure and len(forms) == 1:
            continue
        others = [effect for effect in now.effects if effect.name != mine.name]
        without = refit_with_fewer(now, base, others, scale, sigma)
        if not without.squares <= base.squares:
            continue  # the others alone go nowhere from where the chain stands
        taken = {effect.name for effect in others}
        left = forms if is_sure else [e for e in effects if e.name not in taken]
        promising = screen(without, left, scale, sigma)
        contenders = forms if is_sure else _contenders(links[position], promising, effects)
        known = (with_effect(without, now, mine, scale),)
        rivals = [e for e in contenders if e.name != mine.name and e.name not in taken]
        extra = _in_its_place(now, base, others, rivals, scale, sigma)
        link = next_link(
            without,
            contenders,
            scale,
            sigma,
            FURTHER,
            screened=promising,
            known=known,
            extra=extra,
        )
        if link is None or not is_accepted(link, FURTHER):
            del links[position]
            now = without
            continue
        links[position] = _with_first_look(link, links[position])
        now = converged(link.chosen.plain, sigma)
    return Chain(tuple(links), chain.last, now)


def _without_stepping_stone(
    chain: Chain, base: Candidate, scale: Scale, sigma: Mapping[str, float]
) -> Chain:
    """The chain less its last cause, if that only led the others to a better place.

    There it has shrunk to nothing, and the others alone leave far less than where it was added.
    """
    *earlier, last = chain.links
    if not earlier:
        return chain
    now, others = chain.final, [link.added for link in earlier]
    before = last.before.plain.squares
    placed = _placed_without(now, base, others, scale)
    if not squares_at(placed.problem, placed.minimum.point, sigma) < ELSEWHERE * before:
        return chain
    without = converged(advance(placed, sigma, WITHOUT_ROUND), sigma)
    bic = {id(row.plain): row.bic for row in rank([now, without], sigma)}
    if bic[id(without)] - bic[id(now)] > FURTHER.bic:
        return chain
    return Chain(tuple(earlier), last, without)


def _with_first_look(link: Link, first: Link) -> Link:
    """The link with what it was found with, and what effects not asked again promised then."""
    asked = {signature.effect.key for signature in link.signatures}
    scale = link.squares_before / max(first.squares_before, 1e-300)
    earlier = [
        replace(s, drop=scale * s.drop) for s in first.signatures if s.effect.key not in asked
    ]
    return replace(link, signatures=(*link.signatures, *earlier), found=first.found)


def _is_beyond_doubt(link: Link, final: Candidate) -> bool:
    """Whether a link led by far more than what the later ones took away.

    What left the race early was at least `CLEAR_LEAD` of the misfit behind.
    """
    chosen = link.chosen.plain.squares
    misfit = link.before.plain.squares - chosen
    others = [
        row.plain.squares - chosen
        for row in link.extending
        if link.added_by(row).name != link.added.name
    ]
    had_rivals = any(s.effect.name != link.added.name for s in link.signatures)
    return had_rivals and HOPELESS_RATIO * (chosen - final.squares) < min(
        [CLEAR_LEAD * misfit, *others]
    )


def _contenders(
    link: Link, promising: Sequence[Signature], effects: Sequence[Effect]
) -> list[Effect]:
    """Effects that did well in a link's round, or whose signature promises most now."""
    names = {effect.name for row in link.ranked for effect in row.candidate.effects}
    names |= set(list(dict.fromkeys(s.effect.name for s in promising))[:PROMISING])
    return [effect for effect in effects if effect.name in names]


def _in_its_place(
    now: Candidate,
    base: Candidate,
    others: Sequence[Effect],
    rivals: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
) -> list[Candidate]:
    """Rivals of a cause with the others where they stand beside it, each from its best start.

    Without it the others go elsewhere, from where a rival that is as good may not find back: of two
    causes that cancel each other one is next to nothing alone.
    """
    if not rivals:
        return []
    placed = _placed_without(now, base, others, scale)
    best: dict[str, Signature] = {}
    for signature in screen(placed, rivals, scale, sigma):
        best.setdefault(signature.effect.name, signature)
    variance = variance_of(now)
    return in_parallel(
        lambda signature: candidate_from(placed, signature, scale, sigma, variance),
        list(best.values())[:PROMISING],
    )


def refit_with_fewer(
    now: Candidate,
    base: Candidate,
    others: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
) -> Candidate:
    """A model with some of its effects alone, refitted.

    Parameters
    ----------
    now
        The model with all of them.
    base
        The one without.
    others
        Those that stay.
    scale, sigma
        As in `revised`.
    """
    return advance(_placed_without(now, base, others, scale), sigma, WITHOUT_ROUND)


def refit_without(
    chain: Chain, position: int, base: Candidate, scale: Scale, sigma: Mapping[str, float]
) -> Candidate:
    """The model with all causes but one, refitted.

    Parameters
    ----------
    chain
        The chain.
    position
        Which link is left out.
    base, scale, sigma
        As in `revised`.
    """
    others = [link.added for k, link in enumerate(chain.links) if k != position]
    return refit_with_fewer(chain.final, base, others, scale, sigma)


def _placed_without(
    now: Candidate, base: Candidate, others: Sequence[Effect], scale: Scale
) -> Candidate:
    """The model with the other effects alone, as the whole one has it."""
    order = [effect for effect in now.acting if effect in others]
    point = now.minimum.point
    problem, z = with_fewer_effects(now.problem, point, base.problem, order, scale)
    return begun(now, others, problem, z)
