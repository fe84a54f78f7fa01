"""Named causes that others are refitted in the place of, before they are believed.

Some causes of the catalogue follow what a law in no catalogue does, or two causes together do. Each
of these is refitted in their place, with all other causes kept.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.refit.candidates import (
    Candidate,
    advance,
    begun,
    extend,
    named_values,
    start_unknowns,
)
from softid.diagnosis.refit.parallel import in_parallel
from softid.diagnosis.search.bic_ranking import rank
from softid.diagnosis.search.effect_starts import squares_at
from softid.diagnosis.search.forward_selection import INDISTINCT, Link
from softid.diagnosis.verdict.equivalence import (
    BENT_READING,
    CHANGING,
    DRIFTS,
    LIMITED_RATE,
    LOWER_END,
    EquivalenceClass,
)
from softid.diagnosis.verdict.unlisted_laws import (
    BentReading,
    LoadDrift,
    PressureDrift,
    PressureGainDrift,
    RateLimit,
)
from softid.effects import effect_of
from softid.effects.base import Effect

REFITTING = 40
"""Evaluations from where a cause stood to the optimum of what is put in its place."""


@dataclass(frozen=True)
class Replacement:
    """Laws that are refitted in the place of causes.

    Attributes
    ----------
    causes
        Names or keys of the causes.
    laws
        Sets of effects, each put in the place of all of these causes.
    tie
        What is told where one of them explains as much.
    is_told_in_linear
        Whether the class of a linear model tells it already.
    """

    causes: tuple[str, ...]
    laws: tuple[tuple[Effect, ...], ...]
    tie: EquivalenceClass
    is_told_in_linear: bool = False

    def takes(self, effect: Effect) -> bool:
        """Whether an effect is one of the causes."""
        return effect.name in self.causes or effect.key in self.causes


REPLACEMENTS: tuple[Replacement, ...] = (
    Replacement(
        DRIFTS,
        ((LoadDrift(),), (PressureGainDrift(),), (PressureDrift(),)),
        CHANGING,
        is_told_in_linear=True,
    ),
    Replacement(("stiffening", "static_curve", "contact"), ((BentReading(),),), BENT_READING),
    Replacement(("pneumatic_lag", "valve_flow"), ((RateLimit(),),), LIMITED_RATE),
    Replacement(
        ("sensor_clipping.both",),
        ((effect_of("sensor_clipping"), effect_of("dead_zone")),),
        LOWER_END,
    ),
)
"""Causes, what is put in their place, and what is told then."""


def with_replacements(
    links: Sequence[Link], is_named: Sequence[bool], final: Candidate, base: BaseFit
) -> list[Link]:
    """The links; those of named causes with what explains the logs as well in their place.

    Parameters
    ----------
    links
        The chain.
    is_named
        Which of them may be named.
    final
        The model with all causes.
    base
        What the chain begins with.
    """
    named = [link.added for link, may in zip(links, is_named, strict=True) if may]
    asked = [
        (row, laws)
        for row in REPLACEMENTS
        if any(row.takes(effect) for effect in named)
        and not (row.is_told_in_linear and final.problem.model.is_linear)
        for laws in row.laws
    ]
    if not asked:
        return list(links)
    others = in_parallel(lambda pair: _in_place_of(*pair, named, final, base), asked)
    ranked = rank([final, *others], base.sigma)
    least = next(row.bic for row in ranked if row.plain is final) + INDISTINCT
    alike = {id(row.plain) for row in ranked if row.bic < least}
    found = list(links)
    for (row, laws), other in zip(asked, others, strict=True):
        if id(other) in alike:
            found = [_with_rivals(link, row, laws) for link in found]
    return found


def _with_rivals(link: Link, row: Replacement, laws: Sequence[Effect]) -> Link:
    """The link with laws that explain as much, if it is of one of the causes of a row."""
    if not row.takes(link.added):
        return link
    return replace(link, rivals=tuple(dict.fromkeys((*link.rivals, *(law.name for law in laws)))))


def _in_place_of(
    row: Replacement,
    laws: Sequence[Effect],
    named: Sequence[Effect],
    final: Candidate,
    base: BaseFit,
) -> Candidate:
    """The model with laws in the place of the named causes of a row, refitted."""
    scale, known = base.scale, final.problem
    out = {effect.key for effect in named if row.takes(effect)}
    effects = (*(effect for effect in final.effects if effect.key not in out), *laws)
    problem = extend(base.candidate.problem, effects, scale)
    starts = [
        start_unknowns(problem, known, final.minimum.point, values)
        for values in _start_values(laws, base)
    ]
    z = min(starts, key=lambda start: squares_at(problem, start, base.sigma))
    return advance(begun(final, effects, problem, z), base.sigma, REFITTING)


def _start_values(laws: Sequence[Effect], base: BaseFit) -> list[dict[str, float]]:
    """Every start of one law with every start of the others."""
    of_each = ([named_values(law, start) for start in law.starts(base.scale)] for law in laws)
    return [dict(ChainMap(*starts)) for starts in product(*of_each)]
