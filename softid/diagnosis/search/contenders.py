"""Which contender of a round is chosen, and which others explain the logs as well."""

from __future__ import annotations

from collections.abc import Sequence

from softid.diagnosis.search.bic_ranking import Ranked
from softid.effects import extended_name, own_values
from softid.effects.base import Effect

INDISTINCT = 12.0
"""Candidates within this BIC of the best explain the logs as well. Eight would do if the noise were
what it is taken for; the noise of a measured input, and what it does between the samples, set
neighbours such as a delay and a lag a little further apart either way."""

NESTED = 6.0
"""A richer form of the same law must gain this much on the plain one."""

WITHIN_SAMPLE = 0.05
"""Where a richer law differs from a simpler one only within a sampling interval, its BIC must fall
by so large a share more: what the input does between its samples makes as much of a difference."""


def added_to(before: Ranked, row: Ranked) -> Effect:
    """The effect that a contender adds to what its round extends.

    Parameters
    ----------
    before
        What is extended.
    row
        The contender.
    """
    known = before.candidate.keys
    return next(e for e in row.candidate.effects if e.key not in known)


def choose_contender(
    ranked: Sequence[Ranked], before: Ranked, period_s: float
) -> tuple[Ranked, tuple[str, ...]]:
    """The best candidate, the plain form before a richer one, and what explains as well.

    What is hardly more than a simpler one is covered by that, unless another explains as much that
    is like none: where the base is linear, two poles of a sensor are those of a line.

    One that stands for something else, with an essential parameter at its bound, could not be
    named: of those that explain as well it is the last. That its law has fewer parameters is then
    no merit, so the likelihood decides which do: a curve may have to pay for its knots.

    Parameters
    ----------
    ranked
        The contenders, best first.
    before
        What all of them extend.
    period_s
        Sampling interval of the logs.

    Returns
    -------
    best : Ranked
        The chosen one.
    names : tuple of str
        Names of the effects that explain as well, that of the chosen one first.
    """

    def added(row: Ranked) -> Effect:
        return added_to(before, row)

    within = (row for row in ranked if _is_as_likely(row, ranked[0]))
    best = next((row for row in within if not _is_held(row, added(row))), ranked[0])
    plain = next(
        (r for r in ranked if added(r).name == added(best).name and not added(r).variant), None
    )

    def margin(row: Ranked) -> float:
        """What a law must gain on a simpler one."""
        if _differs_within(row, added(row)) >= period_s:
            return NESTED
        return max(NESTED, WITHIN_SAMPLE * (before.bic - row.bic))

    if added(best).variant and plain is not None:
        is_richer = plain.bic - best.bic >= margin(best) and not _ends_plain(best, added(best))
        best = best if is_richer else plain
    simple = next((r for r in ranked if added(r).key == _simpler(best, added(best))), None)
    if simple is not None:
        best = simple if simple.bic - best.bic < margin(best) else best
    near = [row for row in ranked if row.bic - best.bic < INDISTINCT]
    covered = {row: simpler for row in near if (simpler := _simpler(row, added(row)))}
    distinct = [r.bic for r in near if r not in covered and added(r).name not in covered.values()]
    names = [added(best).name]
    for row in near:
        name = added(row).name
        like_another = any(abs(row.bic - bic) < INDISTINCT for bic in distinct)
        if name not in names and (covered.get(row) not in names or like_another):
            names.append(name)
    return best, tuple(names)


def _is_as_likely(row: Ranked, best: Ranked) -> bool:
    """Whether a contender explains as well as the best one, whatever its parameters cost."""
    return row.bic - best.bic < INDISTINCT or row.misfit - best.misfit < INDISTINCT


def _is_held(row: Ranked, effect: Effect) -> bool:
    """Whether an added effect stands at a bound where its law is another one, white or not."""

    def lie_on(bounds: frozenset[str], names: Sequence[str]) -> bool:
        return any(extended_name(effect, name) in bounds for name in names)

    return any(
        lie_on(c.at_bound, effect.essential)
        or lie_on(c.at_upper_bound, effect.ceilings)
        or lie_on(c.at_bound - c.at_upper_bound, effect.floors)
        for c in (row.candidate, row.plain)
    )


def _ends_plain(row: Ranked, effect: Effect) -> bool:
    """Whether a richer form ends at the lower bound beyond which its law is the plain one."""
    if effect.plain_at is None:
        return False
    name, value = extended_name(effect, effect.plain_at[0]), effect.plain_at[1]
    at_lower_bound = row.candidate.at_bound - row.candidate.at_upper_bound
    return name in at_lower_bound and value <= row.candidate.parameters[name]


def _differs_within(row: Ranked, effect: Effect) -> float:
    """The time within which an added effect differs from the simpler one that it is like."""
    return effect.differs_within(own_values(effect, row.candidate.parameters))


def _simpler(row: Ranked, effect: Effect) -> str | None:
    """The simpler effect that an added one is like, at the values that it has."""
    simpler = effect.simpler(own_values(effect, row.candidate.parameters))
    return simpler[0] if simpler is not None else None
