"""A model with effects added, over the logs of the model that it extends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.effects import ExtendedModel, extended_name
from softid.effects.base import Effect, OutputEffect
from softid.effects.scale import Scale
from softid.fitters.problem import Problem
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

REST_SHARE = 0.1
"""Share of the input's range that counts as the size of the input at which an actuator rests."""

FARTHEST_REST = 3.0
"""Ranges beyond the recorded ones, and beyond the zero of the readings, in which the place of no
position lies: much further away what grows with the position would be a constant that drifts."""

LEAST_SPAN = float(np.finfo(np.float64).tiny)
"""Range of an output that stands still, by which nothing is divided."""


def extend(base: Problem, effects: Sequence[Effect], scale: Scale) -> Problem:
    """The problem of the base model with effects more, each where it acts as a rule.

    Parameters
    ----------
    base
        The base model, its parameters and the logs.
    effects
        Effects to add.
    scale
        Sizes of the base fit; a model with effects keeps its own.
    """
    known = base.model.effects if isinstance(base.model, ExtendedModel) else ()
    return extend_in_order(base, acting_order(known, effects), scale)


def acting_order(known: Sequence[Effect], added: Sequence[Effect]) -> tuple[Effect, ...]:
    """Effects in the order in which they act within their stage, when some are added.

    What a reading loses at the end of the sensor's range is lost, and as a rule nothing acts behind
    that end: what is added goes before it. What the actuator does goes before what its sensor does.

    Parameters
    ----------
    known
        Effects in the order in which they act.
    added
        Those that are added.
    """
    order = list(known)
    for effect in added:
        at = len(order) - (bool(order) and order[-1].mutes and not effect.mutes)
        if _is_before_sensor(effect):
            of_sensor = (e.stage == "output" and not _is_before_sensor(e) for e in order)
            at = next((k for k, later in enumerate(of_sensor) if later), at)
        order.insert(at, effect)
    return tuple(order)


def _is_before_sensor(effect: Effect) -> bool:
    return isinstance(effect, OutputEffect) and effect.before_sensor


def extend_in_order(base: Problem, effects: Sequence[Effect], scale: Scale) -> Problem:
    """The problem of the base model with these effects, and none that it had, in their order.

    Parameters
    ----------
    base, scale
        As in `extend`.
    effects
        All effects.
    """
    known = base.model
    if isinstance(known, ExtendedModel):
        model = replace(known, effects=tuple(effects))
    else:
        model = ExtendedModel(known, tuple(effects), scale)
    declared = model.parameters()
    for parameter in base.parameters.values():
        declared = declared.replacing(parameter)
    return Problem(model, _with_free_rest(declared, model), base.logs)


def _with_free_rest(declared: ParameterSet, model: ExtendedModel) -> ParameterSet:
    """The parameters; where an effect counts the position, what says where that is zero is free.

    A linear model holds it, for the sensor zero stands for it. What grows with the position shows
    the difference, and would otherwise ask for a drift or a warm-up of the zero beside it.
    """
    name = model.rest_parameter
    if name is None or not any(effect.counts_position for effect in model.effects):
        return declared
    held = declared[name]
    if not held.fixed or held.value != model.model.parameters()[name].value:
        return declared  # it is free already, or held where the user wants it
    scale = model.scale
    size = REST_SHARE * scale.u_span  # says how far it may move, not where it begins
    reading = max(abs(scale.y_low), abs(scale.y_high)) / max(scale.y_span, LEAST_SPAN)
    beyond = (FARTHEST_REST + reading) * scale.u_span
    lower, upper = scale.u_low - beyond, scale.u_high + beyond
    return declared.replacing(replace(held, fixed=False, value=size, lower=lower, upper=upper))


def start_unknowns(
    problem: Problem, base: Problem, unknowns: Array, values: Mapping[str, float]
) -> Array:
    """Unknowns of an extended problem from those of the base and values of the added parameters.

    A parameter of the base that only the extended problem frees begins where the base holds it.
    """
    z = np.zeros(problem.size)
    known = base.free_by_name(unknowns)
    for k, name in enumerate(problem.free):
        if name in known:
            z[k] = known[name]
            continue
        p = problem.parameters[name]
        begin = values[name] if name in values else base.parameters[name].value
        value = float(np.clip(begin, p.lower, p.upper))
        z[k] = np.log(value) if p.scale == "log" else value
    return problem.with_nuisance_of(z, base, unknowns)


def with_fewer_effects(
    whole: Problem, unknowns: Array, base: Problem, effects: Sequence[Effect], scale: Scale
) -> tuple[Problem, Array]:
    """The problem of the base model with some of a model's effects, and the unknowns it has there.

    Parameters
    ----------
    whole, unknowns
        The problem with all effects, and its unknowns.
    base, scale
        As in `extend`.
    effects
        Those that stay, in the order in which they act; there may be none.
    """
    problem = within_bounds_of(extend_in_order(base, effects, scale), whole) if effects else base
    known = whole.free_by_name(unknowns)
    z = np.zeros(problem.size)
    z[: len(problem.free)] = [known[name] for name in problem.free]
    return problem, problem.with_nuisance_of(z, whole, unknowns)


def within_bounds_of(problem: Problem, whole: Problem) -> Problem:
    """The problem with what it shares with another one within the bounds of both.

    An effect may have been let beyond its own, and what is clipped to them begins elsewhere.

    Parameters
    ----------
    problem
        A model with effects.
    whole
        One that has some of them, and perhaps others.
    """
    model, known = problem.model, whole.model
    shared = [p for p in problem.parameters.values() if p.name in whole.parameters.names]
    united = {p.name: united_bounds(p, whole.parameters[p.name]) for p in shared}
    if not (isinstance(model, ExtendedModel) and isinstance(known, ExtendedModel)):
        return problem
    if known.scale == model.scale and all(united[p.name] == p for p in shared):
        return problem
    declared = problem.parameters
    for parameter in united.values():
        declared = declared.replacing(parameter)
    return Problem(replace(model, scale=known.scale), declared, problem.logs)


def united_bounds(known: Parameter, declared: Parameter) -> Parameter:
    """A parameter as it is, within the bounds of both."""
    lower, upper = min(known.lower, declared.lower), max(known.upper, declared.upper)
    return replace(known, lower=lower, upper=upper)


def named_values(effect: Effect, values: Mapping[str, float]) -> dict[str, float]:
    """An effect's values under their names in an extended model."""
    return {extended_name(effect, name): value for name, value in values.items()}
