"""A model with effects added, over the logs of the model that it extends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.effects import ExtendedModel, extended_name
from softid.effects.base import Effect, Scale
from softid.fitters.problem import Problem
from softid.parameters import ParameterSet

Array = npt.NDArray[np.float64]

REST_SHARE = 0.1
"""Share of the input's range that counts as the size of the input at which an actuator rests."""


def extend(base: Problem, effects: Sequence[Effect], scale: Scale) -> Problem:
    """The problem of the base model with effects.

    Parameters
    ----------
    base
        The base model, its parameters and the logs.
    effects
        Effects to add.
    scale
        Sizes of the base fit; a model with effects keeps its own.
    """
    inner = base.model
    if isinstance(inner, ExtendedModel):
        effects, scale = (*inner.effects, *effects), inner.scale
        inner = inner.model
    model = ExtendedModel(inner, tuple(effects), scale)
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
    size = REST_SHARE * model.scale.u_span  # says how far it may move, not where it begins
    return declared.replacing(replace(held, fixed=False, value=size))


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


def named_values(effect: Effect, values: Mapping[str, float]) -> dict[str, float]:
    """An effect's values under their names in an extended model."""
    return {extended_name(effect, name): value for name, value in values.items()}
