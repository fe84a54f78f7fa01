"""The response to a log's input, of a fitted model with what its fit went by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import overload

import numpy as np

from softid.arguments import refused, require_log
from softid.channels import make_channel
from softid.errors import UsageError
from softid.identification.input_treatment import InputTreatment, input_as_fitted
from softid.identification.issues import extrapolation
from softid.identification.stalls import as_remembered
from softid.log import Log
from softid.models.base import Model
from softid.records import SavedModel
from softid.results import FitResult, LogNuisance, Simulation
from softid.simulation import simulate as simulate_model


@overload
def simulate(
    model: Model,
    values: Mapping[str, float],
    log: Log,
    *,
    nuisance: LogNuisance | None = None,
) -> Simulation: ...


@overload
def simulate(
    model: FitResult | SavedModel, values: Log, *, nuisance: LogNuisance | None = None
) -> Simulation: ...


@overload
def simulate(
    model: FitResult | SavedModel, *, log: Log, nuisance: LogNuisance | None = None
) -> Simulation: ...


def simulate(
    model: Model | FitResult | SavedModel,
    values: Mapping[str, float] | Log | None = None,
    log: Log | None = None,
    *,
    nuisance: LogNuisance | None = None,
) -> Simulation:
    """Simulate a model with its values, or a fit, on one log: y = output(x(t)) + zero.

    A fit, ``simulate(fit, log)``, takes the log as its own were taken, and so does ``softid
    simulate``: the input does between its samples what it did there, goes on between the readings
    of a gauge that repeats its values, and is without its noise where that was averaged. Effects
    remember through stalls. A log that was fitted or held out gets its own sensor zero and initial
    state back; any other starts at rest with the mean zero of the fitted logs. The log needs the
    input only: an output that it lacks counts as not measured.

    A model with values takes the log as it is.

    Parameters
    ----------
    model
        A model with its options; or a result of `softid.fit` or what `softid.load_params` read.
    values
        Parameter name → value, in the unit that the model states. Left out with a fit.
    log
        Supplies times, input and, for comparison, measured outputs.
    nuisance
        Sensor zeros and initial states instead of those above. Without it, a model with values
        starts every segment at rest, and its zeros are 0.

    Returns
    -------
    Simulation
        Free-run response of every output channel, shape (n,), sensor zero included, in the
        canonical unit; NaN at a lone sample between two stalls. With a fit, ``issues`` say what was
        noticed in its record and in the log, and whether the log leaves the fitted range.

    Raises
    ------
    UsageError
        A parameter is missing or unknown, another channel drives the log than drove the fit, or
        what was given is no model or no log.
    IdentificationError
        The response is not finite.

    Examples
    --------
    >>> from softid.models import MODELS
    >>> time_s = 0.02 * np.arange(200)
    >>> pressure = np.where(time_s % 2.0 < 1.0, 20.0, 60.0)
    >>> log = Log.from_arrays(time_s, {"pressure": pressure, "angle": 0.0 * time_s})
    >>> truth = {"M": 0.0, "N": 20.0, "Q": 100.0, "G": 1.0, "offset": 0.0}
    >>> angle = simulate(MODELS["oscillator"](order="first"), truth, log).outputs["angle"]
    >>> float(round(angle[0], 3)), float(round(angle[99], 3))
    (0.2, 0.597)
    >>> from softid.identification import fit
    >>> measured = Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})
    >>> found = fit(measured, model="oscillator")
    >>> plan = Log.from_arrays([0.0, 1.0, 2.0], {"pressure": [20.0] * 3, "angle": [np.nan] * 3})
    >>> float(round(simulate(found, plan).outputs["angle"][-1], 3))
    0.2
    """
    if isinstance(model, (FitResult, SavedModel)):
        saved = SavedModel.of(model) if isinstance(model, FitResult) else model
        return _predicted(saved, require_log(log if values is None else values), nuisance)
    if not isinstance(model, Model):
        raise refused(
            "a model", model, "give one of softid.MODELS, as in MODELS['muscle'](), or a fit"
        )
    if not isinstance(values, Mapping):
        remedy = "give parameter name → value, or a fit in place of the model"
        raise refused("a table of parameter values", values, remedy)
    return simulate_model(model, values, require_log(log), nuisance=nuisance)


def _predicted(saved: SavedModel, log: Log, nuisance: LogNuisance | None) -> Simulation:
    driving = _as_driven(saved, log)
    model = saved.build_model()
    course = as_remembered(driving, model, saved.values)
    own = saved.nuisance_for(driving) if nuisance is None else nuisance
    beyond = extrapolation(driving, driving.input, saved.fitted_range)
    return replace(
        simulate_model(model, saved.values, course, nuisance=own),
        issues=(*saved.issues, *driving.issues, *([beyond] if beyond else [])),
    )


def _as_driven(saved: SavedModel, log: Log) -> Log:
    """The log with the outputs of a fit, and with its input as the fit takes it."""
    if log.input != saved.input:
        raise UsageError(
            f"{saved.input} drives the model, {log.input} the log",
            where=log.place,
            remedy=f"load the log with input={saved.input!r}",
        )
    missing = {
        name: make_channel(name, np.full(len(log), np.nan), saved.display[name][0])
        for name in saved.outputs
        if name not in log.channels
    }
    whole = replace(log, channels={**log.channels, **missing}, outputs=saved.outputs)
    return input_as_fitted(whole, InputTreatment.of(saved)).with_intersample(saved.intersample)
