"""Scores of a fitted model on logs that it did not see."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from softid.arguments import refused, require_percent
from softid.effects import model_of
from softid.errors import Issue, UsageError
from softid.fingerprint import data_fingerprint
from softid.identification.assembly import held_out
from softid.identification.estimates import scores
from softid.identification.input_treatment import InputTreatment, prepared, taken_as_fitted
from softid.identification.issues import extrapolation
from softid.identification.preparation import as_log_set
from softid.identification.stalls import as_remembered
from softid.identification.unit_slips import unit_slips
from softid.log import Log, LogSet
from softid.models.base import Model
from softid.parallel import matrices_on_one_thread
from softid.records import SavedModel, load_params
from softid.results import FitResult, FitStatistics, Simulation, Validation


@dataclass(frozen=True, eq=False)
class _Scored:
    """What validation needs of a model, wherever it comes from."""

    model: Model
    values: Mapping[str, float]
    input: str
    outputs: tuple[str, ...]
    ranges: Mapping[str, tuple[float, float]]
    fingerprints: Mapping[str, str | None]
    data_fingerprints: Mapping[str, str | None]
    fitted_logs: tuple[str, ...]
    issues: tuple[Issue, ...]
    treatment: InputTreatment

    def was_fitted(self, log: Log, simulation: Simulation) -> bool:
        """Whether a log was fitted, by the fingerprint of its file or of its samples."""
        of_file = {self.fingerprints.get(name) for name in self.fitted_logs} - {None, ""}
        of_data = {self.data_fingerprints.get(name) for name in self.fitted_logs} - {None}
        return bool(log.source and log.source.sha256 in of_file) or (
            data_fingerprint(simulation.time_s, simulation.measured) in of_data
        )


@matrices_on_one_thread()
def validate(
    fitted: FitResult | SavedModel | Path | str,
    logs: Log | Sequence[Log],
    *,
    threshold_percent: float | None = None,
) -> Validation:
    """Score a model on logs by free-run simulation, its parameters held.

    Only the sensor zero of every log and the initial state of every segment that does not start at
    rest are estimated on the log itself, as MATLAB's ``compare`` does with initial conditions; both
    are stated in the result. Effects remember: where the model has some, a log that stalls is one
    segment, and what depends on the course of its input in the stalls is left out.

    Parameters
    ----------
    fitted
        A result of `softid.fit`, a model read from params.json, or where that file is.
    logs
        Logs to score on.
    threshold_percent
        The bar: ``passed`` is False when any channel of any log fits less. One that was measured as
        constant has no fit and is left out; with no other the bar is not passed.

    Returns
    -------
    Validation

    Raises
    ------
    UsageError
        A log's roles differ from the model's, an argument is none of these, or the bar is none
        that a fit can reach.
    InputError
        The file cannot be read.
    IdentificationError
        The response is not finite on a log.

    Examples
    --------
    >>> import softid
    >>> from softid.synthesis import bundled_datasets
    >>> log = softid.load(bundled_datasets() / "data" / "oscillator_steps.csv")
    >>> found = softid.fit(log, model="oscillator")
    >>> scores = validate(found, log, threshold_percent=90.0)
    >>> scores.passed, round(scores.statistics[0].fit_percent)
    (True, 99)
    >>> [issue.code for issue in scores.issues]
    ['in-sample']
    """
    if threshold_percent is not None:
        require_percent(threshold_percent, where="threshold_percent")
    scored = _scored(fitted)
    given = LogSet(tuple(prepared(log, scored.treatment) for log in as_log_set(logs)))
    for log in given:
        if (log.input, log.outputs) != (scored.input, scored.outputs):
            raise UsageError(
                f"the model links {scored.input} → {', '.join(scored.outputs)}, the log "
                f"{log.input} → {', '.join(log.outputs)}",
                where=log.place,
                remedy="choose the roles with --input and --output (input= and outputs= in Python)",
            )
    taken = taken_as_fitted(given.logs, scored.treatment.intersample, scored.model, scored.values)
    log_set = LogSet(tuple(as_remembered(log, scored.model, scored.values) for log in taken))
    nuisances, simulations = held_out(scored.model, scored.values, log_set.logs)
    in_sample = [
        scored.was_fitted(log, simulation)
        for log, simulation in zip(log_set, simulations, strict=True)
    ]
    statistics = tuple(
        row
        for log, simulation, known in zip(log_set, simulations, in_sample, strict=True)
        for row in scores((log,), (simulation,), in_sample=known)
    )
    judged, unjudged = _judged(statistics, threshold_percent)
    return Validation(
        model=scored.model.spec(),
        input=scored.input,
        outputs=scored.outputs,
        threshold_percent=threshold_percent,
        passed=judged,
        statistics=statistics,
        nuisances=nuisances,
        simulations=simulations,
        issues=(
            *scored.issues,
            *unit_slips(scored.model, scored.values, log_set.logs),
            *_issues(log_set.logs, scored, in_sample),
            *unjudged,
        ),
        fingerprints={log.name: log.source.sha256 if log.source else "" for log in log_set},
        fitted_range=scored.ranges,
    )


def _scored(fitted: object) -> _Scored:
    if isinstance(fitted, FitResult):
        return _from_fit(fitted)
    if isinstance(fitted, (str, Path)):
        return _from_file(load_params(fitted))
    if isinstance(fitted, SavedModel):
        return _from_file(fitted)
    remedy = "give a result of softid.fit, or the params.json that save_fit wrote"
    raise refused("a fitted model", fitted, remedy)


def _from_fit(result: FitResult) -> _Scored:
    fitted = tuple(dict.fromkeys(row.log for row in result.statistics if row.in_sample))
    return _Scored(
        model=model_of(result.model),
        values=result.values,
        input=result.input,
        outputs=result.outputs,
        ranges=result.fitted_range,
        fingerprints=dict(result.fingerprints),
        data_fingerprints={
            s.log: data_fingerprint(s.time_s, s.measured) for s in result.simulations
        },
        fitted_logs=fitted,
        issues=(),
        treatment=InputTreatment.of(result),
    )


def _from_file(saved: SavedModel) -> _Scored:
    return _Scored(
        model=saved.build_model(),
        values=saved.values,
        input=saved.input,
        outputs=saved.outputs,
        ranges=saved.fitted_range,
        fingerprints=saved.fingerprints,
        data_fingerprints=saved.data_fingerprints,
        fitted_logs=saved.fitted_logs,
        issues=saved.issues,
        treatment=InputTreatment.of(saved),
    )


def _judged(
    statistics: Sequence[FitStatistics], bar: float | None
) -> tuple[bool, tuple[Issue, ...]]:
    """Whether all that has a fit reaches the bar, and something does; and what has none."""
    if bar is None:
        return True, ()
    known = [row.fit_percent for row in statistics if math.isfinite(row.fit_percent)]
    issues = tuple(
        Issue(
            "fit-undefined",
            "info" if known else "warning",
            f"{row.log}: {row.channel} was measured as constant, so its fit in per cent is not "
            f"defined and is not held against the bar; its error is "
            f"{row.rmse * row.display_factor:.3g} {row.display_unit}",
            "hold its error against the noise, or score a log in which the output moves",
        )
        for row in statistics
        if not math.isfinite(row.fit_percent)
    )
    return bool(known) and min(known) >= bar, issues


def _issues(logs: Sequence[Log], scored: _Scored, in_sample: Sequence[bool]) -> list[Issue]:
    found: list[Issue] = []
    for log, known in zip(logs, in_sample, strict=True):
        found += log.issues
        if known:
            found.append(
                Issue(
                    "in-sample",
                    "warning",
                    f"{log.name} was fitted, so its score says nothing about new data",
                    "score a log that was not fitted",
                )
            )
        beyond = extrapolation(log, log.input, scored.ranges)
        if beyond is not None:
            found.append(beyond)
    return found
