"""Which of a sensor's effects comes first: what a reading loses at the end of the range is lost.

A drift of the amplifier lies before the end of the converter's range, where a search puts it; one
of what the recorder adds lies behind it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from softid.diagnosis.refit.candidates import Candidate, advance, begun
from softid.diagnosis.refit.extension import named_values
from softid.diagnosis.search.effect_starts import squares_at
from softid.effects import ExtendedModel, belongs_to
from softid.effects.base import Effect, Scale
from softid.fitters.problem import Problem
from softid.parameters import ParameterSet

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
        The candidate itself where nothing clips the reading, or nothing beside it acts on that.
    """
    model, others = candidate.problem.model, other_order(candidate.acting)
    if others == candidate.acting or not isinstance(model, ExtendedModel):
        return candidate
    found = [candidate]
    for effects in (others, candidate.acting):
        swapped, declared = replace(model, effects=effects), candidate.problem.parameters
        own = ParameterSet(tuple(declared[name] for name in swapped.parameters().names))
        problem = Problem(swapped, own, candidate.problem.logs)
        starts = []
        for limits in _limits(problem, effects, model.scale):
            z = problem.free_unknowns({**candidate.parameters, **limits})
            starts.append(problem.with_nuisance_of(z, candidate.problem, candidate.minimum.point))
        start = min(starts, key=lambda z: squares_at(problem, z, sigma))
        placed = begun(candidate, candidate.effects, problem, start)
        found.append(advance(placed, sigma, REORDERED))
    best = min(found, key=lambda one: one.squares)
    return best if best.squares < (1.0 - SAME_PLACE) * candidate.squares else candidate


def _limits(problem: Problem, effects: Sequence[Effect], scale: Scale) -> list[dict[str, float]]:
    """Values of the limits: as they are, each start, and each of them at either of its bounds."""
    clipping = next(effect for effect in effects if effect.mutes)
    found = [{}, *(named_values(clipping, start) for start in clipping.starts(scale))]
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
