"""Names that a chain as a whole does not carry, whatever its single links look like."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis_results import Cause, Doubt, Remainder
from softid.effects import confusable_with, extended_name
from softid.effects.base import Effect

SLIGHT = 0.03
"""A later link of the same kind that takes less than this share of what the earlier one took mends
the form of its law: no material follows a law to the last digit. A delay has one
form only, and a line that is a delay and a lag has both."""

MAIN = 0.5
"""Causes are named when they take at least this share of what the whole chain takes: a cause beside
a larger description stands on it."""

MORE_THAN_NOISE = 0.05
"""Share of the noise's variance above which, with a standard deviation of that, more is left than
the true causes would leave. Nearly all of these leave less; pieces of one law of another form leave
a tenth to a fifth."""


def consistent_names(
    links: Sequence[Link], causes: Sequence[Cause], named: Sequence[bool], squares_left: float
) -> tuple[bool, ...]:
    """Which names stay when the links are looked at together.

    Parameters
    ----------
    links
        The chain.
    causes
        Their parameters.
    named
        Which of them may be named by themselves.
    squares_left
        Sum of squares that the last model leaves.
    """
    taken = taken_by(links, squares_left)
    effects = [link.added for link in links]
    kept, counted = list(named), list(named)
    for late in range(1, len(effects)):
        if _is_held_by_bounds(causes[late], effects[late]):
            kept[late] = False
    for late, early in _pairs_alike(effects):
        may_mend = not (effects[early].has_one_form or effects[late].has_one_form)
        is_slight = may_mend and _is_slight(links, causes, taken, late, early)
        draws = _draws(effects[early], effects[late]) or _draws(effects[late], effects[early])
        both = kept[early] and kept[late]
        if draws and (both or not is_slight):  # a description beside it says as much
            kept[early] = kept[late] = counted[early] = counted[late] = False
        elif both and (is_slight or _is_bounded(causes[late])):
            kept[late] = False
    if sum(t for t, counts in zip(taken, counted, strict=True) if counts) < MAIN * sum(taken):
        return (False,) * len(links)
    return tuple(kept)


def named_together(
    links: Sequence[Link], causes: Sequence[Cause], named: Sequence[bool], squares_left: float
) -> tuple[tuple[bool, ...], tuple[Cause, ...]]:
    """As `consistent_names`, and the causes; one that may mend another's law has that doubt.

    Parameters
    ----------
    links, causes, named, squares_left
        As in `consistent_names`.
    """
    kept = consistent_names(links, causes, named, squares_left)
    taken = taken_by(links, squares_left)
    slight = {
        late
        for late, early in _pairs_alike([link.added for link in links])
        if kept[early] and _is_slight(links, causes, taken, late, early)
    }
    told = tuple(
        replace(cause, doubt=cause.doubt or Doubt.DWARFED)
        if k in slight and named[k] and not kept[k]
        else cause
        for k, cause in enumerate(causes)
    )
    return kept, told


def may_hold_more(remainder: Remainder) -> bool:
    """Whether what is left is larger than the true causes would leave it, or may be slow noise.

    It need not be so large that it must be more than noise.

    Parameters
    ----------
    remainder
        What is left.
    """
    is_loud = remainder.excess > MORE_THAN_NOISE + remainder.noise_sd
    return is_loud or remainder.colour_s is not None


def mending(links: Sequence[Link], squares_left: float, remainder: Remainder) -> frozenset[str]:
    """Keys of causes that may be pieces of one law, which is not quite that of any of them.

    Of two that can be confused and that together leave more than noise, or what may be slow noise
    that no rest shows, the later one is; the earlier one, too, where it takes away less than the
    later one; and what is slight beside the larger one, for that law leaves something anyway.

    Parameters
    ----------
    links
        The chain.
    squares_left
        Sum of squares that the last model leaves.
    remainder
        The same beside the noise.
    """
    if not may_hold_more(remainder):
        return frozenset()
    taken = taken_by(links, squares_left)
    effects = [link.added for link in links]
    found = set()
    for late, early in _pairs_alike(effects):
        if effects[early].has_one_form or effects[late].has_one_form:
            continue
        found.add(effects[late].key)
        if taken[late] > taken[early]:
            found.add(effects[early].key)
        most = SLIGHT * max(taken[late], taken[early])
        others = zip(effects, taken, strict=True)
        found |= {effect.key for effect, t in others if t < most and not effect.has_one_form}
    return frozenset(found)


def taken_by(links: Sequence[Link], squares_left: float) -> list[float]:
    """What each link takes away of the sum of squares.

    Parameters
    ----------
    links
        The chain.
    squares_left
        Sum of squares that the last model leaves.
    """
    squares = [*(link.left_before for link in links), squares_left]
    return [max(before - after, 0.0) for before, after in pairwise(squares)]


def _is_slight(
    links: Sequence[Link], causes: Sequence[Cause], taken: Sequence[float], late: int, early: int
) -> bool:
    """Whether a later link takes so little beside an earlier one that it may mend its law.

    It does not where the earlier one ends at a bound by itself, and clear of it beside the later
    one: no law of another form has a number that a small one beside it brings back.
    """
    if taken[late] >= SLIGHT * taken[early]:
        return False
    alone = links[early].found
    own = {p.name for p in causes[early].parameters}
    held = own & alone.at_bound if alone is not None else frozenset()
    return not held or _is_bounded(causes[early])


def _is_held_by_bounds(cause: Cause, effect: Effect) -> bool:
    """Whether several of many sizes end at their bounds: what it draws is larger than it may be."""
    names = {extended_name(effect, name) for name in effect.amplitudes}
    return sum(p.at_bound for p in cause.parameters if p.name in names) > 1


def _is_bounded(cause: Cause) -> bool:
    return any(p.at_bound for p in cause.parameters)


def _pairs_alike(effects: Sequence[Effect]) -> list[tuple[int, int]]:
    """Places of effects that can be confused, the later one first."""
    places = range(len(effects))
    return [(b, a) for b in places for a in range(b) if _alike(effects[a], effects[b])]


def _alike(one: Effect, other: Effect) -> bool:
    return other.name in confusable_with(one)


def _draws(one: Effect, other: Effect) -> bool:
    return other.name in one.draws
