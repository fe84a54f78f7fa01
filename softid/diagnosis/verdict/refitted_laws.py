"""A model that stands, refitted with laws in the place of some of its effects."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.refit.candidates import COARSE_STEPS, Candidate, advance, begun
from softid.diagnosis.refit.extension import (
    acting_order,
    extend_in_order,
    named_values,
    start_unknowns,
    within_bounds_of,
)
from softid.diagnosis.refit.rough_copy import over_samples_of, rough_copy
from softid.diagnosis.search.effect_starts import squares_at
from softid.diagnosis.search.multistart import driven, usual_places
from softid.effects import belongs_to
from softid.effects.base import Effect, InputEffect, OutputEffect
from softid.fitters.problem import Problem

Array = npt.NDArray[np.float64]

FIRST_EVALUATIONS, REFIT_EVALUATIONS = 8, 40
"""Evaluations from where a cause stood: of all that is put in its place, over averages, and to the
optimum of what has come near by then, over averages and from there over all samples."""

MORE_ROUNDS, STILL_FALLS = 3, 0.8
"""Further rounds of as many evaluations that are granted, as long as each leaves less than this
share of the one before: the edge of a limit moves over the samples one by one."""

PROMISING_RATIO = 2.0
"""Most times the sum of squares that the causes leave which what is put in their place may leave
after its first evaluations."""

LEAD_ASTRAY = (
    "input_limit",
    "relief_leak",
    "dead_zone",
    "rate_limit",
    "input_play",
    "swinging_load",
)
"""Laws without which a base ends far from where it belongs: they bend the static curve, keep back a
part of every move, or ring in the place of the base."""


@dataclass(frozen=True, eq=False)
class Standing:
    """A model that stands, also over averages, where it takes a fraction to see who comes near.

    Attributes
    ----------
    model
        The model.
    base
        The base fit.
    rough, rough_base
        Model and base over averages, or over all samples where averages do not do.
    rough_sigma
        Output channel → scale that a residual of averages is divided by.
    usual
        The base over averages at its start values, where refits are to begin there.
    """

    model: Candidate
    base: BaseFit
    rough: Candidate
    rough_base: Candidate
    rough_sigma: Mapping[str, float]
    usual: Sequence[Candidate]


def standing_of(model: Candidate, base: BaseFit, *, at_starts: bool = False) -> Standing:
    """A model with what is seen of it over averages.

    Parameters
    ----------
    model
        The base with effects, or without.
    base
        The base fit.
    at_starts
        Whether refits begin at start values of the base, which know nothing of the way that it has
        gone to make room for what is missing.
    """
    rough_base, sigma = rough_copy(base.candidate, base.scale, base.sigma)
    rough = over_samples_of(model, rough_base, base.scale)
    rough = advance(rough, sigma, 1, substeps=COARSE_STEPS)
    usual = usual_places(rough_base) if at_starts else ()
    return Standing(model, base, rough, rough_base, sigma, usual)


def refitted_with(
    standing: Standing,
    kept: Sequence[Effect],
    laws: Sequence[Effect],
    *,
    near: float,
    enough: float = np.inf,
) -> Candidate | None:
    """The base with effects of a model that stands, and others from the best of their starts.

    Where none of its effects stays, or more of them go than laws come, they also begin beside the
    base without any, for what stood in their place may have moved it to another optimum, or away
    from one. All that come near go on: of two optima the one that is reached first is not always
    the lower.
    One of `LEAD_ASTRAY` also begins at start values of the base for what arrives behind it: what
    stood for it has led the base away.

    Parameters
    ----------
    standing
        That model.
    kept
        Those of its effects that stay.
    laws
        What is added.
    near
        What would leave a larger sum of squares after the first evaluations is given up.
    enough
        So is what would leave a larger one at its optimum over averages.

    Returns
    -------
    Candidate or None
        Over all samples; None for what was given up. A misfit counts as much in a sum of squares
        over averages as in one over all samples, and noise counts less.
    """
    base, known, rough_base = standing.base, standing.rough, standing.rough_base
    sigma, effects = standing.rough_sigma, (*kept, *laws)
    extended = extend_in_order(rough_base.problem, acting_order(kept, laws), base.scale)
    problem = within_bounds_of(extended, known.problem)
    limit = known.squares + near - standing.model.squares
    starts = [
        _begun_near(begun(known, effects, problem, z), sigma, limit)
        for z in _starts(standing, kept, laws, problem)
    ]
    ended = [
        advance(start, sigma, REFIT_EVALUATIONS, substeps=COARSE_STEPS)
        for start in starts
        if start.squares <= limit
    ]
    found = min(ended, key=lambda candidate: candidate.squares, default=None)
    if found is None:
        return None
    if found.squares - known.squares > enough - standing.model.squares:
        return None
    whole = over_samples_of(found, base.candidate, base.scale)
    return advance(whole, base.sigma, REFIT_EVALUATIONS)


def _starts(
    standing: Standing, kept: Sequence[Effect], laws: Sequence[Effect], problem: Problem
) -> list[Array]:
    """The best start beside the model that stands, and of the base where that was led away.

    So it may have been where nothing of the model stays, or where one law stands for several
    effects: what they did together the base may have done with its own parameters.
    """
    base, known, rough_base = standing.base, standing.rough, standing.rough_base
    sigma, own_values = standing.rough_sigma, _start_values(laws, base)
    beside = {
        name: value
        for name, value in known.parameters.items()
        if any(belongs_to(effect, name) for effect in kept)
    }

    def best(starts: Iterable[Array]) -> Array:
        return min(starts, key=lambda start: squares_at(problem, start, sigma))

    is_led_away = not kept or len(known.effects) - len(kept) > len(laws)
    nearby = [(rough_base,)] if is_led_away else []
    found = [
        best(
            start_unknowns(problem, place.problem, place.minimum.point, {**beside, **values})
            for place in places
            for values in own_values
        )
        for places in ([standing.usual] if standing.usual else [(known,), *nearby])
    ]
    if not (isinstance(laws[0], InputEffect | OutputEffect) and laws[0].name in LEAD_ASTRAY):
        return found
    bent = [
        start_unknowns(
            problem,
            place.problem,
            place.minimum.point,
            {**beside, **others, **named_values(laws[0], own)},
        )
        for own in laws[0].starts(base.scale)
        for others in _start_values(laws[1:], base)
        for place in driven(rough_base, laws[0], own, base.scale)
    ]
    return [best((*found, *bent))]


def _begun_near(found: Candidate, sigma: Mapping[str, float], limit: float) -> Candidate:
    """A start after its first evaluations, and more of them as long as they come nearer."""
    found = advance(found, sigma, FIRST_EVALUATIONS, substeps=COARSE_STEPS)
    for _ in range(MORE_ROUNDS):
        if found.squares <= limit:
            break
        before, found = found, advance(found, sigma, FIRST_EVALUATIONS, substeps=COARSE_STEPS)
        if not found.squares < STILL_FALLS * before.squares:
            break
    return found


def _start_values(laws: Sequence[Effect], base: BaseFit) -> list[dict[str, float]]:
    """Every start of one law with every start of the others."""
    of_each = ([named_values(law, start) for start in law.starts(base.scale)] for law in laws)
    return [dict(ChainMap(*starts)) for starts in product(*of_each)]
