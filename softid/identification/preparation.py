"""What has to be settled before a fit: usable logs, units, direction, and the user's wishes."""

from __future__ import annotations

from collections.abc import Sequence
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

INVERTED_CORRELATION = -0.5


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


def is_inverted(logs: LogSet) -> bool:
    """Whether the first output clearly falls as the input rises."""
    cross = inputs = outputs = 0.0
    for log in logs:
        for segment in log.segments():
            used = segment.used[log.outputs[0]]
            if used.sum() < 2:
                continue
            u = segment.input[used] - segment.input[used].mean()
            y = segment.outputs[log.outputs[0]][used]
            y = y - y.mean()
            cross, inputs, outputs = cross + u @ y, inputs + u @ u, outputs + y @ y
    if inputs == 0 or outputs == 0:
        return False
    return bool(cross / np.sqrt(inputs * outputs) < INVERTED_CORRELATION)


def units_of(logs: LogSet) -> dict[str, str]:
    """Canonical unit of the input under ``"input"`` and of every output under its name."""
    first = logs.logs[0]
    return {"input": logs.input_unit} | {n: first.channels[n].unit for n in logs.outputs}


def adapted_model(model: Model | str, logs: LogSet) -> Model:
    """Build and adapt a model to the logs.

    Raises
    ------
    UsageError
        The model is unknown or cannot link these channels.
    """
    if isinstance(model, str):
        if model not in MODELS:
            raise UsageError(
                "there is no such model", value=model, remedy=f"choose from {', '.join(MODELS)}"
            )
        model = MODELS[model]()
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
    return model.adapted(units_of(logs), inverted=is_inverted(logs))


def with_wishes(
    declared: ParameterSet, wishes: ParameterSet | lmfit.Parameters | None
) -> ParameterSet:
    """The model's parameters with the user's values, bounds, fixed values and ties laid over."""
    if wishes is None:
        return declared
    if not isinstance(wishes, ParameterSet):
        return declared.updated_from_lmfit(wishes)
    overlaid = declared
    for name, wish in wishes.items():
        if name not in declared:
            raise UsageError(
                f"the model has no parameter {name}",
                remedy=f"choose from {', '.join(declared.names)}",
            )
        if declared[name].fixed and not wish.fixed:
            continue
        overlaid = overlaid.replacing(
            replace(
                declared[name],
                value=wish.value,
                lower=wish.lower,
                upper=wish.upper,
                fixed=wish.fixed,
                tie=wish.tie,
            )
        )
    return overlaid


def start_values(
    declared: ParameterSet, wished: ParameterSet, guesses: Sequence[ParameterSet]
) -> list[dict[str, float]]:
    """Starts for the optimiser: the user's own values first, then those found from the data.

    Parameters
    ----------
    declared
        The model's parameters as the model declares them.
    wished
        The same after the user's wishes.
    guesses
        Start values from the data.
    """

    def within(p: Parameter, value: float) -> float:
        return p.value if p.fixed else float(np.clip(value, p.lower, p.upper))

    starts = [{n: within(p, guess[n].value) for n, p in wished.items()} for guess in guesses]
    own = any(wished[n].value != declared[n].value and not wished[n].fixed for n in wished.names)
    if own or not starts:
        starts.insert(0, wished.values_dict())
    return starts
