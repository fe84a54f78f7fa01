"""Which of the effects on a reading, or on an input, comes first.

What a reading loses at the end of the range is lost: a drift of the amplifier lies before the end
of the converter's range, where a search puts it; one of what the recorder adds lies behind it. And
a dead zone may be that of a valve, before the lag of the line, or that of the folds behind it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from softid.diagnosis.refit.candidates import Candidate, advance, begun
from softid.diagnosis.refit.extension import named_values
from softid.diagnosis.search.effect_starts import squares_at
from softid.effects import ExtendedModel, belongs_to, own_values
from softid.effects.base import Effect, InputEffect
from softid.effects.scale import Scale
from softid.fitters.problem import Problem
from softid.parameters import ParameterSet

COMMUTE = 2e-3
"""Two effects on an input may change places where what arrives differs by a smaller share of it."""

REORDERED = 30
"""Evaluations that bring an order to its optimum."""

SAME_PLACE = 1e-4
"""A sum of squares that falls by a smaller share was at its optimum before."""


def in_better_order(candidate: Candidate, sigma: Mapping[str, float]) -> Candidate:
    """The candidate, or its effects in the other order or with other limits if that leaves less.

    A limit that just touches a reading with its drift cuts nothing of one without, and a limit that
    stood for a drift cuts what it does not when the drift is there: both orders begin from limits
    of their own and from ones that cut nothing, too.

    Parameters
    ----------
    candidate
        A model with effects, near its optimum.
    sigma
        Output channel → scale that its residual is divided by.

    Returns
    -------
    Candidate
        The candidate itself where nothing clips the reading, or nothing beside it acts on that, and
        its effects on the input may as well change places.
    """
    model, clipped = candidate.problem.model, other_order(candidate.acting)
    if not isinstance(model, ExtendedModel):
        return candidate
    found = [candidate]
    if clipped != candidate.acting:
        clipping = next(effect for effect in clipped if effect.mutes)
        for effects in (clipped, candidate.acting):
            limits = _limits(candidate.problem, clipping, model.scale)
            found.append(_reordered(candidate, model, effects, limits, sigma))
    swapped = inputs_exchanged(candidate)
    if swapped != candidate.acting:
        found.append(_reordered(candidate, model, swapped, [{}], sigma))
    best = min(found, key=lambda one: one.squares)
    return best if best.squares < (1.0 - SAME_PLACE) * candidate.squares else candidate


def _reordered(
    candidate: Candidate,
    model: ExtendedModel,
    effects: Sequence[Effect],
    starts: Sequence[Mapping[str, float]],
    sigma: Mapping[str, float],
) -> Candidate:
    """The candidate with its effects in another order, refitted from the best of some starts."""
    known = candidate.problem
    swapped = replace(model, effects=tuple(effects))
    own = ParameterSet(tuple(known.parameters[name] for name in swapped.parameters().names))
    problem = Problem(swapped, own, known.logs)
    points = []
    for values in starts:
        z = problem.free_unknowns({**candidate.parameters, **values})
        points.append(problem.with_nuisance_of(z, known, candidate.minimum.point))
    start = points[0]
    if len(points) > 1:
        start = min(points, key=lambda z: squares_at(problem, z, sigma))
    return advance(begun(candidate, candidate.effects, problem, start), sigma, REORDERED)


def _limits(problem: Problem, clipping: Effect, scale: Scale) -> list[dict[str, float]]:
    """Values of the limits: as they are, each start, and each of them at either of its bounds."""
    found: list[dict[str, float]] = [{}]
    found += [named_values(clipping, start) for start in clipping.starts(scale)]
    for name in problem.free:
        if belongs_to(clipping, name):
            p = problem.parameters[name]
            found += [{name: p.lower}, {name: p.upper}]
    return found


def other_order(effects: Sequence[Effect]) -> tuple[Effect, ...]:
    """Effects with what clips the reading at the end, or in front where it is there already.

    Parameters
    ----------
    effects
        Effects in the order in which they act within their stage.
    """
    clipping = [effect for effect in effects if effect.mutes]
    others = [effect for effect in effects if not effect.mutes]
    if not clipping or not any(effect.stage == "output" for effect in others):
        return tuple(effects)
    behind = effects[effects.index(clipping[0]) :]
    if any(effect.stage == "output" and not effect.mutes for effect in behind):
        return (*others, *clipping)
    return (*clipping, *others)


def inputs_exchanged(candidate: Candidate) -> tuple[Effect, ...]:
    """Effects with the last two on the input in each other's place, if they do not commute.

    Parameters
    ----------
    candidate
        A model with effects; what its logs were driven with and its values tell.
    """
    effects, model = candidate.acting, candidate.problem.model
    on_input = [effect for effect in effects if isinstance(effect, InputEffect)]
    if len(on_input) < 2 or not isinstance(model, ExtendedModel):
        return effects
    first, second = on_input[-2:]
    segment = max(candidate.problem.segments, key=lambda segment: segment.time_s.size)
    arriving = []
    for pair in ((first, second), (second, first)):
        u = segment.input
        for effect in pair:
            eta = np.array(list(own_values(effect, candidate.parameters).values()))
            u = effect.apply(eta, segment.since_s, u, model.scale)
        arriving.append(u)
    apart = float(np.std(arriving[0] - arriving[1]))
    if not apart > COMMUTE * float(np.ptp(segment.input)):
        return effects
    exchanged: dict[Effect, Effect] = {first: second, second: first}
    return tuple(exchanged.get(effect, effect) for effect in effects)
