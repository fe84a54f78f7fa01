"""What has to be settled before a fit: usable logs, units, direction, and the user's wishes."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from softid.errors import InputError, UsageError
from softid.log import Log, LogSet
from softid.models import MODELS
from softid.models.base import Model
from softid.parameters import Parameter, ParameterSet

if TYPE_CHECKING:
    import lmfit

def as_log_set(logs: Log | Sequence[Log]) -> LogSet:
    """One log or several as a `LogSet`."""
    return LogSet((logs,) if isinstance(logs, Log) else tuple(logs))


def require_excitation(logs: LogSet) -> None:
    """Refuse logs from which nothing can be learnt.

    Raises
    ------
    InputError
        The input is constant in every log, or an output holds no two different samples.
    """
    moving = [log for log in logs if np.ptp(log.channels[log.input].values) > 0]
    if not moving:
        log = logs.logs[0]
        raise InputError(
            f"the input {log.input} is constant, so nothing can be identified",
            where=log.name,
            value=float(log.channels[log.input].displayed[0]),
            remedy="record a log in which it changes, or choose another --input",
        )
    for log in logs:
        assert log.masked is not None
        for name in log.outputs:
            values = log.channels[name].values[~log.masked]
            finite = values[np.isfinite(values)]
            if finite.size < 2:
                raise InputError(
                    f"the output {name} has {finite.size} usable samples",
                    where=log.name,
                    remedy="choose another --output, or record it again",
                )
            if np.ptp(finite) == 0 and log in moving:
                raise InputError(
                    f"the output {name} never changes although the input does",
                    where=log.name,
                    value=float(finite[0] * log.channels[name].display_factor),
                    remedy="check the sensor, or choose another --output",
                )


def units_of(logs: LogSet) -> dict[str, str]:
    """Canonical unit of the input under ``"input"`` and of every output under its name."""
    first = logs.logs[0]
    return {"input": logs.input_unit} | {n: first.channels[n].unit for n in logs.outputs}


def named_model(model: Model | str) -> Model:
    """A model given as such, or by its name with its standard options.

    Raises
    ------
    UsageError
        There is no model of that name.
    """
    if not isinstance(model, str):
        return model
    if model not in MODELS:
        raise UsageError(
            "there is no such model", value=model, remedy=f"choose from {', '.join(MODELS)}"
        )
    built: Model = MODELS[model]()
    return built


def require_channels(model: Model, logs: LogSet) -> None:
    """Refuse channels that a model does not link.

    A model that takes any output knows of no link between two of them.

    Raises
    ------
    UsageError
        The input or an output is not the model's, or there are several outputs and no link.
    """
    if model.inputs and logs.input not in model.inputs:
        raise UsageError(
            f"the {model.name} model is driven by {' or '.join(model.inputs)}",
            value=logs.input,
            remedy="choose another --input or --model oscillator",
        )
    wrong = [name for name in logs.outputs if model.outputs and name not in model.outputs]
    if wrong:
        raise UsageError(
            f"the {model.name} model does not explain a {wrong[0]}",
            remedy=f"choose an --output from {', '.join(model.outputs)}, or another --model",
        )
    if len(logs.outputs) > 1 and not model.outputs:
        raise UsageError(
            f"the {model.name} model explains one output",
            value=", ".join(logs.outputs),
            remedy="fit each on its own with --output, or link them by --model muscle with "
            "--fixed-length and --diameter",
        )


def adapted_model(model: Model | str, logs: LogSet, *, inverted: bool) -> Model:
    """Build a model and adapt it to the logs.

    Parameters
    ----------
    model
        A model or its name.
    logs
        What is to be fitted.
    inverted
        Whether the first output falls as the input rises.

    Raises
    ------
    UsageError
        The model is unknown or cannot link these channels.
    """
    named = named_model(model)
    require_channels(named, logs)
    return named.adapted(units_of(logs), inverted=inverted)


def with_wishes(
    declared: ParameterSet,
    base: ParameterSet,
    wishes: ParameterSet | lmfit.Parameters | None,
) -> ParameterSet:
    """The model's parameters with the user's values, bounds, fixed values and ties laid over.

    What the user left as the model has it is no wish. A parameter that the model itself holds stays
    held: a limit of the model has dropped it.

    Parameters
    ----------
    declared
        Parameters of the model as adapted to the logs, or of one of its limits.
    base
        Parameters of the model as the user knows it.
    wishes
        As `softid.fit` takes them.

    Raises
    ------
    UsageError
        A parameter is unknown, or is one that the model holds with these options.
    """
    if wishes is None:
        return declared
    overlaid = declared
    for name, wish in _wished(base, wishes).items():
        p, was = declared[name], base[name]
        if wish == was:
            continue
        if was.fixed and not wish.fixed:
            raise UsageError(
                f"the model holds {name} at {was.value:g} with these options",
                where=f"parameter {name}",
                remedy="leave it fixed, or choose other options of the model",
            )
        if p.fixed and not was.fixed:
            continue
        overlaid = overlaid.replacing(
            replace(
                p,
                value=wish.value,
                lower=wish.lower,
                upper=wish.upper,
                fixed=wish.fixed,
                tie=wish.tie,
            )
        )
    return overlaid


def _wished(base: ParameterSet, wishes: ParameterSet | lmfit.Parameters) -> ParameterSet:
    """The wishes as parameters of the model; where lmfit has no bound the model's own stays."""
    if isinstance(wishes, ParameterSet):
        unknown = [name for name in wishes if name not in base]
        if unknown:
            raise UsageError(
                f"the model has no parameter {unknown[0]}",
                remedy=f"choose from {', '.join(base.names)}",
            )
        return wishes
    taken = []
    for name, p in base.updated_from_lmfit(wishes).items():
        was = base[name]
        lower = was.lower if name in wishes and np.isneginf(wishes[name].min) else p.lower
        upper = was.upper if name in wishes and np.isposinf(wishes[name].max) else p.upper
        held = p.fixed or p.tie is not None
        inside = p.value if held else float(np.clip(p.value, lower, upper))
        if held:
            lower, upper = min(lower, p.value), max(upper, p.value)
        taken.append(replace(p, value=inside, lower=lower, upper=upper))
    return ParameterSet(tuple(taken))


def insists_on(
    base: ParameterSet, wishes: ParameterSet | lmfit.Parameters | None, names: set[str]
) -> bool:
    """Whether the user's bounds or ties keep some of these parameters in the model."""
    if wishes is None:
        return False
    wished = _wished(base, wishes)
    ties = [p.tie for p in wished.values() if p.tie is not None]
    used = {n.id for tie in ties for n in ast.walk(ast.parse(tie)) if isinstance(n, ast.Name)}
    bounded = {n for n, p in wished.items() if n in names and p.lower > base[n].lower}
    return bool(used & names or bounded)


def start_values(
    declared: ParameterSet, wished: ParameterSet, starts: Sequence[Mapping[str, float]]
) -> list[dict[str, float]]:
    """Starts for the optimiser: the user's own values first, then those found from the data.

    Parameters
    ----------
    declared
        The model's parameters as the model declares them.
    wished
        The same after the user's wishes.
    starts
        Parameter name → value found from the data.
    """

    def within(p: Parameter, value: float) -> float:
        return p.value if p.fixed else float(np.clip(value, p.lower, p.upper))

    found = [{n: within(p, start[n]) for n, p in wished.items()} for start in starts]
    own = any(wished[n].value != declared[n].value and not wished[n].fixed for n in wished.names)
    if own or not found:
        found.insert(0, wished.values_dict())
    return found
