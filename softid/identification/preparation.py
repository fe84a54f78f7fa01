"""What has to be settled before a fit: usable logs, and a model that links their channels."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from softid.arguments import refused, require_explainable
from softid.errors import InputError, Issue, UsageError, entry_named
from softid.identification.interpolated_output import (
    INTERPOLATED,
    RECOVERED,
    interpolated_samples,
    recovered_readings,
)
from softid.identification.repeated_output import repeated_readings
from softid.log import Log, LogSet
from softid.models import MODELS
from softid.models.base import Model
from softid.quality import dropout_mask, misleading_channels
from softid.sentences import listed

SMALLEST_RELATIVE_SPAN = 1e-9
"""An input that moves less than this part of its size is constant but for rounding."""


def as_log_set(logs: Log | Sequence[Log]) -> LogSet:
    """One log or several as a `LogSet`."""
    return LogSet(as_logs(logs))


def as_logs(logs: Log | Sequence[Log]) -> tuple[Log, ...]:
    """One log or several, or none, as a tuple.

    Raises
    ------
    UsageError
        Something else than a log was given, such as the name of a file, or a log without output.
    """
    if isinstance(logs, Log | str) or not isinstance(logs, Iterable):
        return (require_explainable(logs),)
    return tuple(require_explainable(log) for log in logs)


def require_excitation(logs: LogSet) -> None:
    """Refuse logs from which nothing can be learnt.

    Raises
    ------
    InputError
        The input is constant in every log, or an output holds no two different samples.
    """
    if not any(_moves(log) for log in logs):
        log = logs.logs[0]
        channel = log.channels[log.input]
        raise InputError(
            f"the input {log.input} is constant, so nothing can be identified",
            where=log.place,
            value=f"{channel.displayed[0]:.6g} {channel.display_unit}",
            remedy="record a log in which it changes, or choose another --input (input= in Python)",
        )
    require_outputs(logs)


def require_outputs(logs: Iterable[Log]) -> None:
    """Refuse logs whose outputs say nothing.

    Raises
    ------
    InputError
        An output has fewer than two samples, or stays where it is although the input moves.
    """
    for log in logs:
        for name in log.outputs:
            values = log.channels[name].values
            known = np.isfinite(values) & ~log.masked
            finite = values if known.all() else values[known]
            if finite.size < 2:
                raise InputError(
                    f"the output {name} has {finite.size} usable samples",
                    where=log.place,
                    remedy="choose another --output (outputs= in Python), or record it again",
                )
            if np.ptp(finite) == 0 and _moves(log):
                raise InputError(
                    f"the output {name} never changes although the input does",
                    where=log.place,
                    value=float(finite[0] * log.channels[name].display_factor),
                    remedy="check the sensor, or choose another --output (outputs= in Python)",
                )


def _moves(log: Log) -> bool:
    """Whether the input changes by more than rounding."""
    values = log.channels[log.input].values
    return bool(np.ptp(values) > SMALLEST_RELATIVE_SPAN * np.max(np.abs(values)))


def without_dropouts(log: Log) -> Log:
    """Leave drop-outs, stale and repeated readings out of the residuals, and say so.

    Missing and masked samples are left out already; these are samples that hold a wrong number.
    """
    log = _without_wrong(log)
    repeated = repeated_readings(log)
    if not repeated.any():
        return _without_interpolated(log)
    issue = Issue(
        "repeated-output",
        "info",
        f"{log.name}: {listed(log.outputs)} repeats each reading for about "
        f"{len(log) / (len(log) - int(repeated.sum())):.2g} samples; the repeats are left out of "
        "the residuals",
        "record all channels at one rate",
    )
    return replace(log.with_masked(repeated), issues=(*log.issues, issue))


def _without_interpolated(log: Log) -> Log:
    between = interpolated_samples(log)
    if not between.any():
        return log
    readings = recovered_readings(log)
    count = len(log) - int(between.sum()) if readings is None else readings[0].size
    rate_hz = count / float(np.ptp(log.time_s))
    issue = Issue(
        INTERPOLATED if readings is None else RECOVERED,
        "info",
        f"{log.name}: {listed(log.outputs)} is straight between readings, as after an "
        f"interpolation to a faster clock; {rate_hz:.3g} "
        + ("samples" if readings is None else "readings")
        + " a second stay in the residuals",
        "leave cells empty where the sensor has no reading of its own",
    )
    return replace(log.with_masked(between), issues=(*log.issues, issue))


def _without_wrong(log: Log) -> Log:
    dropped = dropout_mask(log) & ~log.masked
    for name in log.outputs:
        dropped &= np.isfinite(log.channels[name].values)
    count = int(dropped.sum())
    if count == 0:
        return log
    first_s = float(log.time_s[np.flatnonzero(dropped)[0]])
    issue = Issue(
        "drop-out",
        "info",
        f"{log.name}: {count} samples are drop-outs or stale, the first at {first_s:.4g} s; they "
        "are left out of the residuals",
        "see them with `softid inspect`",
    )
    return replace(log.with_masked(dropped), issues=(*log.issues, issue))


def with_faults_told(log: Log) -> Log:
    """Say what a fit takes for motion that the input makes, and is not."""
    known = {issue.code for issue in log.issues}
    found = [issue for issue in misleading_channels(log) if issue.code not in known]
    return replace(log, issues=(*log.issues, *found)) if found else log


def require_same_units(logs: LogSet) -> None:
    """Refuse raw channels whose unit differs from log to log.

    Raises
    ------
    UsageError
        Two logs record a channel in different units, which only a raw channel can.
    """
    first = logs.logs[0]
    for log in logs:
        for name in (logs.input, *logs.outputs):
            unit, wanted = log.channels[name].unit, first.channels[name].unit
            if unit != wanted:
                raise UsageError(
                    f"{name} is in {unit}, but in {wanted} in {first.name}",
                    where=log.place,
                    remedy="name its unit with --channel (units= of softid.Log.from_arrays)",
                )


def same_stretch(a: Log, b: Log) -> bool:
    """Whether two logs overlap in time, and come from one file or hold the same samples there."""
    if not (a.time_s[0] <= b.time_s[-1] and b.time_s[0] <= a.time_s[-1]):
        return False
    if a.source is not None and b.source is not None and a.source.sha256 == b.source.sha256:
        return True
    return _are_one_recording(a, b)


def _are_one_recording(a: Log, b: Log) -> bool:
    """Whether all samples that two logs have within their common time are the same, and move."""
    start_s, stop_s = max(a.time_s[0], b.time_s[0]), min(a.time_s[-1], b.time_s[-1])
    spans = [
        slice(*np.searchsorted(log.time_s, (start_s, np.nextafter(stop_s, np.inf))).tolist())
        for log in (a, b)
    ]
    rows = [
        (log.time_s[span], *(log.channels[name].values[span] for name in (log.input, *log.outputs)))
        for log, span in zip((a, b), spans, strict=True)
    ]
    return (
        (a.input, a.outputs) == (b.input, b.outputs)
        and all(np.array_equal(x, y, equal_nan=True) for x, y in zip(*rows, strict=True))
        and any(np.isfinite(x).any() and np.nanmax(x) > np.nanmin(x) for x in rows[0][1:])
    )


def units_of(logs: LogSet) -> dict[str, str]:
    """Canonical unit of the input under ``"input"`` and of every output under its name."""
    first = logs.logs[0]
    return {"input": logs.input_unit} | {n: first.channels[n].unit for n in logs.outputs}


def require_model(given: object) -> Model:
    """What was given, if it is a model.

    Raises
    ------
    UsageError
        It is something else, such as the class of one.
    """
    if isinstance(given, Model):
        return given
    remedy = f"give an instance, such as softid.Muscle(), or a name: {', '.join(MODELS)}"
    raise refused("a model", given, remedy)


def named_model(model: Model | str) -> Model:
    """A model given as such, or by its name with its standard options.

    Raises
    ------
    UsageError
        There is no model of that name, or it is neither.
    """
    if not isinstance(model, str):
        return require_model(model)
    return entry_named(model, MODELS, unknown="there is no such model")()


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
            remedy="choose another --input or --model oscillator (input= and model= in Python)",
        )
    wrong = [name for name in logs.outputs if model.outputs and name not in model.outputs]
    if wrong:
        raise UsageError(
            f"the {model.name} model does not explain the channel {wrong[0]}",
            remedy=f"choose an --output from {', '.join(model.outputs)}, or another --model "
            "(outputs= and model= in Python)",
        )
    if len(logs.outputs) > 1 and not model.outputs:
        raise UsageError(
            f"the {model.name} model explains one output",
            value=", ".join(logs.outputs),
            remedy="fit each on its own with --output, or link them by --model muscle with "
            "--fixed-length and --diameter (outputs= and softid.Muscle in Python)",
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
