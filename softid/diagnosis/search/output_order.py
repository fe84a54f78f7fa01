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
from softid.effects import ExtendedModel
from softid.effects.base import Effect
from softid.fitters.problem import Problem
from softid.parameters import ParameterSet

REORDERED = 30
"""Evaluations that bring the other order to its optimum."""


def in_better_order(candidate: Candidate, sigma: Mapping[str, float]) -> Candidate:
    """The candidate, or the same effects in the other order where that leaves less.

    A limit that just touches a reading with its drift cuts nothing of one without: the other order
    begins from limits of its own, too.

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
    effects, model = other_order(candidate.acting), candidate.problem.model
    if effects == candidate.acting or not isinstance(model, ExtendedModel):
        return candidate
    swapped, declared = replace(model, effects=effects), candidate.problem.parameters
    own = ParameterSet(tuple(declared[name] for name in swapped.parameters().names))
    problem = Problem(swapped, own, candidate.problem.logs)
    clipping = next(effect for effect in effects if effect.mutes)
    starts = []
    for limits in ({}, *clipping.starts(model.scale)):
        z = problem.free_unknowns({**candidate.parameters, **named_values(clipping, limits)})
        starts.append(problem.with_nuisance_of(z, candidate.problem, candidate.minimum.point))
    best = min(starts, key=lambda z: squares_at(problem, z, sigma))
    found = advance(begun(candidate, candidate.effects, problem, best), sigma, REORDERED)
    return found if found.squares < candidate.squares else candidate


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
