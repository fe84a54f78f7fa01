"""The fit from logs to result."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from softid.errors import Issue, UsageError
from softid.fitters.output_error import Optimum, output_error, refit_nuisance
from softid.fitters.problem import Problem
from softid.identification.choice import ModelChoice, choose_model
from softid.identification.estimates import (
    errors_of,
    free_covariance,
    nuisances_of,
    parameter_estimates,
    scores,
)
from softid.identification.findings import fitted_range, issues_of
from softid.identification.preparation import (
    adapted_model,
    as_log_set,
    require_excitation,
    start_values,
    with_wishes,
)
from softid.log import Log, LogSet
from softid.models.base import Model
from softid.parameters import ParameterSet
from softid.results import FitResult, LogNuisance, Simulation
from softid.simulation import simulate

if TYPE_CHECKING:
    import lmfit

Array = npt.NDArray[np.float64]
Progress = Callable[[str, float], None]


def fit(
    logs: Log | Sequence[Log],
    *,
    model: Model | str | None = None,
    hold_out: Sequence[Log] = (),
    parameters: ParameterSet | lmfit.Parameters | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> FitResult:
    """Identify a model from one or several logs by simultaneous output error.

    Minimises Σ (y − ŷ)²/σ² over all logs and outputs at once, with the sensor zero of every log and
    the initial state of every segment that does not start at rest estimated alongside. Starts come
    from the data alone.

    Parameters
    ----------
    logs
        Logs to fit.
    model
        A model, its name, or None to let held-out blocks decide.
    hold_out
        Logs that are scored and not fitted; only their zero and initial state are estimated.
    parameters
        Bounds, fixed values, ties and start values, as a `ParameterSet` or lmfit ``Parameters``
        (which may name only some).
    seed
        Seed of the perturbed restarts.
    progress
        Called with a sentence and the fraction done.

    Returns
    -------
    FitResult
        Its ``success`` is False when the optimum was not reached.

    Raises
    ------
    InputError
        The logs cannot identify anything: constant input, dead output.
    UsageError
        The model is unknown or does not link the channels, or the logs' roles differ.

    Examples
    --------
    >>> t = np.arange(0.0, 8.0, 0.02)
    >>> u = np.where(t % 4 < 2, 0.0, 100.0)
    >>> y = np.zeros_like(t)
    >>> for k in range(1, t.size):
    ...     y[k] = y[k - 1] + 0.02 / 0.3 * (0.01 * u[k - 1] - y[k - 1])
    >>> log = Log.from_arrays(t, {"pressure": u, "angle": y})
    >>> fit(log, model="oscillator").success
    True
    """
    log_set = as_log_set(logs)
    held = tuple(hold_out)
    _check_hold_out(log_set, held)
    require_excitation(log_set)
    report = progress or (lambda message, fraction: None)
    rng = np.random.default_rng(seed)
    choice = None
    if model is None:
        report("choosing the model", 0.0)
        choice = choose_model(log_set, rng=rng)
        model = choice.model
    found = _identify(adapted_model(model, log_set), log_set, parameters, rng, report)
    report("computing errors", 0.95)
    return _assemble(found, log_set, held, choice, seed)


@dataclass(frozen=True, eq=False)
class _Identified:
    problem: Problem
    optimum: Optimum
    unseen: Mapping[str, str]


def _check_hold_out(logs: LogSet, held: Sequence[Log]) -> None:
    if held:
        LogSet((*logs.logs, *held))  # the same names and roles rules hold over both
    fitted = {log.source.sha256: log.name for log in logs if log.source is not None}
    for log in held:
        if log.source is not None and log.source.sha256 in fitted:
            raise UsageError(
                f"this log holds the same bytes as {fitted[log.source.sha256]}, which is fitted",
                where=log.name,
                remedy="hold out a log that is not fitted",
            )


def _identify(
    model: Model,
    logs: LogSet,
    parameters: ParameterSet | lmfit.Parameters | None,
    rng: np.random.Generator,
    report: Progress,
) -> _Identified:
    """Fit, and continue with the model's limit while a term cannot be seen."""
    wished = with_wishes(model.parameters(), parameters)
    segments = [s for log in logs for s in log.segments()]
    starts = start_values(model.parameters(), wished, model.guess(segments, logs.outputs[0]))
    problem = Problem(model, wished, logs.logs)
    optimum = output_error(problem, starts, rng=rng, progress=report)
    period_s = float(np.median([log.period_s for log in logs]))
    input_range = fitted_range(logs)[logs.input]
    unseen: dict[str, str] = {}
    while np.isfinite(optimum.cost):
        theta = problem.theta(optimum.unknowns)
        simpler = problem.model.limit(theta, period_s, input_range)
        if simpler is None:
            break
        limit, reason = simpler
        dropped = set(problem.free) - set(limit.parameters().free)
        if not dropped or _tied_to(wished, dropped):
            break
        unseen |= dict.fromkeys(dropped, reason)
        overlaid = with_wishes(limit.parameters(), parameters)
        values = dict(zip(problem.parameters.names, theta.tolist(), strict=True))
        values |= {n: p.value for n, p in overlaid.items() if p.fixed}
        problem = Problem(limit, overlaid, logs.logs)
        optimum = output_error(problem, [values], rng=rng, progress=report)
    return _Identified(problem, optimum, unseen)


def _tied_to(parameters: ParameterSet, names: set[str]) -> bool:
    """Whether the user computes some parameter from one of these, so that none can be dropped."""
    ties = [p.tie for p in parameters.values() if p.tie is not None]
    return any(name in tie for tie in ties for name in names)


def _assemble(
    found: _Identified,
    logs: LogSet,
    held: tuple[Log, ...],
    choice: ModelChoice | None,
    seed: int,
) -> FitResult:
    problem, optimum = found.problem, found.optimum
    model = problem.model
    if not np.isfinite(optimum.cost):
        return _failed(found, logs, choice, seed)
    errors = errors_of(problem, optimum)
    estimates = parameter_estimates(problem, optimum, errors, found.unseen)
    values = {e.name: e.value for e in estimates}
    nuisances = nuisances_of(problem, optimum, errors)
    simulations = _simulations(model, values, logs.logs, nuisances)
    held_nuisances, held_simulations = held_out(model, values, held)
    names, covariance, correlation = free_covariance(problem, optimum, errors)
    statistics = scores(logs.logs, simulations, in_sample=True)
    held_statistics = scores(held, held_simulations, in_sample=False)
    ranges = fitted_range(logs)
    issues = [issue for log in (*logs.logs, *held) for issue in log.issues]
    issues += issues_of(
        estimates, errors, found.unseen, ranges, held, (*statistics, *held_statistics)
    )
    if not optimum.status.success:
        issues.append(Issue("not-converged", "error", optimum.status.value))
    return FitResult(
        model=model.spec(),
        input=logs.input,
        outputs=logs.outputs,
        status=optimum.status,
        message=optimum.status.value,
        parameters=estimates,
        derived=model.derived(values, ranges[logs.input]),
        nuisances=(*nuisances, *held_nuisances),
        statistics=(*statistics, *held_statistics),
        noise=errors.noise,
        correlation=correlation,
        covariance=covariance,
        free=names,
        condition_number=errors.covariance.condition_number if errors.covariance else None,
        aic=errors.aic,
        bic=errors.bic,
        fitted_range=ranges,
        simulations=(*simulations, *held_simulations),
        evaluations=optimum.evaluations,
        issues=tuple(issues),
        choice=choice.reason if choice else None,
        fingerprints={
            log.name: log.source.sha256 if log.source else "" for log in (*logs.logs, *held)
        },
        options={"seed": float(seed)},
    )


def _simulations(
    model: Model, values: Mapping[str, float], logs: Sequence[Log], nuisances: Sequence[LogNuisance]
) -> tuple[Simulation, ...]:
    return tuple(
        simulate(model, values, log, nuisance=nuisance)
        for log, nuisance in zip(logs, nuisances, strict=True)
    )


def held_out(
    model: Model, values: Mapping[str, float], logs: Sequence[Log]
) -> tuple[tuple[LogNuisance, ...], tuple[Simulation, ...]]:
    """Zeros, initial states and simulations of logs that were not fitted, parameters held."""
    if not logs:
        return (), ()
    problem = Problem(model, model.parameters().with_fixed(values), logs)
    nuisances = nuisances_of(problem, refit_nuisance(problem), None)
    return nuisances, _simulations(model, values, logs, nuisances)


def _failed(found: _Identified, logs: LogSet, choice: ModelChoice | None, seed: int) -> FitResult:
    status = found.optimum.status
    return FitResult(
        model=found.problem.model.spec(),
        input=logs.input,
        outputs=logs.outputs,
        status=status,
        message=status.value,
        parameters=(),
        derived={},
        nuisances=(),
        statistics=(),
        noise=(),
        correlation=None,
        covariance=None,
        free=(),
        condition_number=None,
        aic=None,
        bic=None,
        fitted_range=fitted_range(logs),
        simulations=(),
        evaluations=found.optimum.evaluations,
        issues=(Issue("no-response", "error", status.value),),
        choice=choice.reason if choice else None,
        fingerprints={log.name: log.source.sha256 if log.source else "" for log in logs},
        options={"seed": float(seed)},
    )
