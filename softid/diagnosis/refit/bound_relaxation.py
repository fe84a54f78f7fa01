"""Effects at their bounds: because of a base that misses the actuator, or of a cause still missing.

A law that is known up to a common factor of its forces, or a base that another effect bends, may
have a small part of the force that the same model has with its cause. An effect that runs into its
bound then asks for bounds that go by the force of its own model. A limit of the sensor counts from
a zero that the base had elsewhere, for it took the flat end for a motion. And what runs into its
bound while another cause is missing may be held there, for a law at its limit hardly feels its
parameter.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from softid.diagnosis.refit.candidates import Candidate, advance, standing_at
from softid.diagnosis.refit.characteristic_scales import elastic_force, range_without_zeros
from softid.diagnosis.refit.extension import united_bounds
from softid.effects import ExtendedModel, belongs_to, extended_name
from softid.effects.base import Effect
from softid.effects.scale import Scale
from softid.fitters.problem import Problem

GROWN = 1.2
"""Least factor by which the elastic force has grown to make the bounds worth moving."""

MOVED = 0.02
"""Least share of the output's range by which zeros have moved to move the bounds of readings."""

RELEASED = 30
"""Evaluations from a start away from the bounds."""

AT_BOUND = 1e-3
"""Distance from a bound, as a share of the way between both, that is at it."""


def with_own_bounds(candidate: Candidate) -> Candidate:
    """The candidate with wider bounds where a parameter of an effect lies on one.

    They follow from the candidate's own sizes in place of the base's: bounds of forces from its
    elastic force, those of readings from its sensor zeros.

    Parameters
    ----------
    candidate
        A model with effects, near its optimum.

    Returns
    -------
    Candidate
        At the same point; the candidate itself where its bounds do not hold it, or its own sizes
        are hardly beyond those of the base.
    """
    problem, model = candidate.problem, candidate.problem.model
    if not isinstance(model, ExtendedModel):
        return candidate
    scale = _with_own_zeros(candidate, _with_own_force(candidate, model))
    if scale is model.scale:
        return candidate
    wider = replace(model, scale=scale)
    declared = wider.parameters()
    for known in problem.parameters.values():
        declared = declared.replacing(united_bounds(known, declared[known.name]))
    return replace(candidate, problem=Problem(wider, declared, problem.logs))


def _with_own_force(candidate: Candidate, model: ExtendedModel) -> Scale:
    """The scale with the candidate's own force, if that is larger and an amplitude is held."""
    if not _is_held(candidate):
        return model.scale
    problem = candidate.problem
    theta = problem.theta(candidate.minimum.point)
    u = np.concatenate([segment.input for segment in problem.segments])
    force = elastic_force(model, theta, u, (model.scale.x_low, model.scale.x_high))
    if not GROWN * model.scale.force < force < np.inf:
        return model.scale
    return replace(model.scale, force=force)


def _with_own_zeros(candidate: Candidate, scale: Scale) -> Scale:
    """A scale that holds the readings as the candidate's own zeros have them, if one is held."""
    readings = {
        extended_name(effect, name) for effect in candidate.effects for name in effect.readings
    }
    if not readings & set(candidate.at_bound):
        return scale
    low, high = range_without_zeros(candidate.problem, candidate.minimum.point)
    moved = max(scale.y_low - low, high - scale.y_high)
    if moved <= MOVED * scale.y_span:
        return scale
    return replace(scale, y_low=min(low, scale.y_low), y_high=max(high, scale.y_high))


def released(
    candidate: Candidate, earlier: Sequence[Effect], sigma: Mapping[str, float]
) -> Candidate:
    """The candidate refitted from a start off the bounds of its earlier effects, if that is better.

    Parameters
    ----------
    candidate
        A model with one effect more than before, at its optimum.
    earlier
        The effects that it had before.
    sigma
        Output channel → scale that its residual is divided by.

    Returns
    -------
    Candidate
        The candidate itself where none of their parameters is at a bound, or nothing is won.
    """
    problem = candidate.problem
    held = [
        name
        for name in candidate.at_bound
        if name in problem.free and any(belongs_to(effect, name) for effect in earlier)
    ]
    if not held:
        return candidate
    usual = problem.free_unknowns(
        {**candidate.parameters, **{name: problem.parameters[name].value for name in held}}
    )
    z = candidate.minimum.point.copy()
    z[: len(problem.free)] = usual[: len(problem.free)]
    placed = standing_at(z, candidate.minimum, candidate.prior, candidate.squares)
    found = advance(replace(candidate, minimum=placed), sigma, RELEASED)
    return found if found.squares < candidate.squares else candidate


def _is_held(candidate: Candidate) -> bool:
    """Whether a size that goes by the force is at its upper bound, or at its most negative."""
    problem, z = candidate.problem, candidate.minimum.point
    lower, upper = problem.bounds()
    own = set(candidate.problem.parameters.names)
    for effect in candidate.effects:
        for name in effect.amplitudes:
            full = extended_name(effect, name)
            if full not in own or full not in problem.free:
                continue
            k = problem.free.index(full)
            near = AT_BOUND * (upper[k] - lower[k])
            negative = problem.parameters[full].lower < 0.0
            if upper[k] - z[k] <= near or (negative and z[k] - lower[k] <= near):
                return True
    return False
