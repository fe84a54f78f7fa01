"""Scores of a fitted model on logs that it did not see."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from softid.arguments import refused, require_percent
from softid.errors import Issue, UsageError
from softid.fingerprint import data_fingerprint
from softid.identification.assembly import held_out
from softid.identification.estimates import scores
from softid.identification.input_treatment import InputTreatment, prepared, taken_as_fitted
from softid.identification.issues import extrapolation, too_few_to_score
from softid.identification.preparation import as_log_set
from softid.identification.stalls import as_remembered
from softid.identification.unit_slips import unit_slips
from softid.log import Log, LogSet
from softid.parallel import matrices_on_one_thread
from softid.records import SavedModel, load_params
from softid.results import FitResult, FitStatistics, Simulation, Validation
from softid.scores import are_too_few


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
        constant, or at no more samples than its own zero and initial state can follow, has no fit
        and is left out; with no other the bar is not passed.

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
    model, values = scored.build_model(), scored.values
    treatment = InputTreatment.of(scored)
    given = LogSet(tuple(prepared(log, treatment) for log in as_log_set(logs)))
    for log in given:
        if (log.input, log.outputs) != (scored.input, scored.outputs):
            raise UsageError(
                f"the model links {scored.input} → {', '.join(scored.outputs)}, the log "
                f"{log.input} → {', '.join(log.outputs)}",
                where=log.place,
                remedy="choose the roles with --input and --output (input= and outputs= in Python)",
            )
    taken = taken_as_fitted(given.logs, treatment.intersample, model, values)
    log_set = LogSet(tuple(as_remembered(log, model, values) for log in taken))
    held = held_out(model, values, log_set.logs)
    in_sample = [
        _was_fitted(scored, log, simulation)
        for log, simulation in zip(log_set, held.simulations, strict=True)
    ]
    statistics = tuple(
        row
        for log, simulation, known in zip(log_set, held.simulations, in_sample, strict=True)
        for row in scores((log,), (simulation,), in_sample=known, unknowns=held.unknowns)
    )
    few = too_few_to_score(statistics, held.unknowns)
    judged, unjudged = _judged(statistics, threshold_percent, held.unknowns)
    return Validation(
        model=model.spec(),
        input=scored.input,
        outputs=scored.outputs,
        threshold_percent=threshold_percent,
        passed=judged,
        statistics=statistics,
        nuisances=held.nuisances,
        simulations=held.simulations,
        issues=(
            *scored.issues,
            *unit_slips(model, values, log_set.logs),
            *_issues(log_set.logs, scored, in_sample),
            *few,
            *unjudged,
        ),
        fingerprints={log.name: log.source.sha256 if log.source else "" for log in log_set},
        fitted_range=scored.fitted_range,
    )


def _scored(fitted: object) -> SavedModel:
    if isinstance(fitted, FitResult):
        return SavedModel.of(fitted)
    if isinstance(fitted, (str, Path)):
        return load_params(fitted)
    if isinstance(fitted, SavedModel):
        return fitted
    remedy = "give a result of softid.fit, or the params.json that save_fit wrote"
    raise refused("a fitted model", fitted, remedy)


def _was_fitted(scored: SavedModel, log: Log, simulation: Simulation) -> bool:
    """Whether a log was fitted, by the fingerprint of its file or of its samples."""
    of_file = {scored.fingerprints.get(name) for name in scored.fitted_logs} - {None}
    of_data = {scored.data_fingerprints.get(name) for name in scored.fitted_logs} - {None}
    return bool(log.source and log.source.sha256 in of_file) or (
        data_fingerprint(simulation.time_s, simulation.measured) in of_data
    )


def _judged(
    statistics: Sequence[FitStatistics], bar: float | None, unknowns: Mapping[str, int]
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
            f"defined{' and is not held against the bar' if known else ''}; its error is "
            f"{row.rmse * row.display_factor:.3g} {row.display_unit}",
            "hold its error against the noise, or score a log in which the output moves",
        )
        for row in statistics
        if not math.isfinite(row.fit_percent)
        and (row.n == 1 or not are_too_few(row.n, unknowns[row.log]))
    )
    return bool(known) and min(known) >= bar, issues


def _issues(logs: Sequence[Log], scored: SavedModel, in_sample: Sequence[bool]) -> list[Issue]:
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
        beyond = extrapolation(log, log.input, scored.fitted_range)
        if beyond is not None:
            found.append(beyond)
    return found
