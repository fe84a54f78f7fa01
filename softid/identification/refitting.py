"""A finished fit as the problem that it solved, to be solved again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from softid.errors import UsageError
from softid.fitters.output_error import Optimum, draft_fit
from softid.fitters.problem import Problem
from softid.identification.input_treatment import InputTreatment, prepared
from softid.identification.preparation import as_log_set
from softid.log import Log
from softid.parameters import ParameterSet
from softid.results import FitResult


def refitted(result: FitResult, logs: Log | Sequence[Log]) -> tuple[Problem, Optimum]:
    """The problem of a finished fit, and its optimum.

    Parameters
    ----------
    result
        A successful fit.
    logs
        The logs that were fitted, in any order; they are prepared and taken as they were then.

    Raises
    ------
    InputError
        A log lacks a channel of the model.
    UsageError
        A log was not fitted.
    """
    from softid.effects import model_of  # twenty modules, which few fits need

    for log in as_log_set(logs):
        _require_fitted(result, log)
    treatment = InputTreatment.of(result)
    taken = [prepared(log, treatment) for log in as_log_set(logs)]
    taken = [log.with_intersample(treatment.intersample) for log in taken]
    model = model_of(result.model)
    problem = Problem(model, _as_fitted(model.parameters(), result), taken)
    return problem, draft_fit(problem, [result.values], far=False)


def _require_fitted(result: FitResult, log: Log) -> None:
    """Refuse a log that has no name of a fitted one, or its name but not its file."""
    fitted = [row.log for row in result.statistics if row.in_sample]
    if log.name not in fitted:
        raise UsageError(
            "this log was not fitted",
            where=log.place,
            value=log.name,
            remedy=f"give the logs of the fit: {', '.join(dict.fromkeys(fitted))}",
        )
    then, now = result.fingerprints.get(log.name), log.source.sha256 if log.source else ""
    if then and now and then != now:
        raise UsageError(
            "this file is not the one that was fitted under its name",
            where=log.place,
            remedy="give the file of the fit, or fit this one first",
        )


def _as_fitted(declared: ParameterSet, result: FitResult) -> ParameterSet:
    """The model's parameters with the values, bounds and ties of a finished fit."""
    fitted = declared
    for estimate in result.parameters:
        p = declared[estimate.name]
        lower = -np.inf if estimate.lower is None else estimate.lower
        upper = np.inf if estimate.upper is None else estimate.upper
        fitted = fitted.replacing(
            replace(
                p,
                value=estimate.value,
                lower=lower,
                upper=upper,
                fixed=estimate.fixed,
                tie=estimate.tie,
            )
        )
    return fitted
