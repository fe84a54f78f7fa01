"""From an optimum to a `FitResult`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, Issue
from softid.fitters.output_error import Optimum, refit_nuisance
from softid.fitters.problem import Problem
from softid.identification.dropped_terms import DroppedTerm, deviations_beside
from softid.identification.errors_in_variables import with_input_errors
from softid.identification.estimates import nuisances_of, parameter_estimates, scores
from softid.identification.input_errors import NO_INPUT_ERRORS, InputErrors
from softid.identification.issues import (
    fitted_range,
    issues_of,
    most_serious_first,
    noisy_input_issues,
    too_few_to_score,
)
from softid.identification.model_selection import ModelChoice
from softid.identification.parameter_constraints import ParameterConstraints
from softid.identification.parameter_covariance import errors_of, free_covariance
from softid.identification.tied_errors import with_ties_followed
from softid.log import Log, LogSet
from softid.models.base import Model
from softid.results import FitResult, LogNuisance, ParameterEstimate, Simulation
from softid.simulation import simulate, simulation_left
from softid.uncertainty import propagated_errors, widened

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class OptimisedProblem:
    """A finished optimisation.

    Attributes
    ----------
    problem, optimum
        What was fitted, and where it ended.
    unseen
        Parameters dropped on the way because the logs cannot see them → the reason.
    constraints
        What the user asked for.
    dropped
        The fits with what was dropped, from which it follows how well the others are known.
    """

    problem: Problem
    optimum: Optimum
    unseen: Mapping[str, str]
    constraints: ParameterConstraints
    dropped: tuple[DroppedTerm, ...] = ()


def assemble(
    found: OptimisedProblem,
    logs: LogSet,
    held: Sequence[Log],
    *,
    choice: ModelChoice | None,
    seed: int,
    input_errors: InputErrors = NO_INPUT_ERRORS,
    least_sd: Mapping[str, float] = MappingProxyType({}),
) -> FitResult:
    """Errors, verdicts, scores and issues around an optimum.

    Parameters
    ----------
    found
        The finished optimisation.
    logs, held
        Fitted and held-out logs.
    choice
        How the model was chosen, if softid chose it.
    seed
        For the record.
    input_errors
        Those of the fitted logs.
    least_sd
        Parameter → least standard deviation in internal coordinates, from what the residuals do not
        show of its error.

    Raises
    ------
    IdentificationError
        No start gave a finite response.
    """
    problem, optimum = found.problem, found.optimum
    model = problem.model
    _require_finite(optimum, logs)
    errors = errors_of(problem, optimum)
    noisy: list[Issue] = []
    if errors.covariance is not None:
        wider = with_input_errors(errors.covariance, problem, optimum, input_errors)
        noisy = noisy_input_issues(logs, errors.covariance, wider, model.parameters().names)
        least_sd = deviations_beside(found.dropped, least_sd, input_errors)
        errors = replace(errors, covariance=widened(wider, least_sd))
    estimates = parameter_estimates(problem, optimum, errors, found.unseen, found.constraints)
    values = {e.name: e.value for e in estimates}
    nuisances = nuisances_of(problem, optimum, errors)
    simulations = _fitted_simulations(found, values, logs.logs, nuisances)
    judged = held_out(model, values, held)
    statistics = (
        *scores(logs.logs, simulations, in_sample=True),
        *scores(held, judged.simulations, in_sample=False, unknowns=judged.unknowns),
    )
    names, covariance, correlation = free_covariance(problem, optimum, errors)
    ranges = fitted_range(logs)
    issues = [issue for log in (*logs, *held) for issue in log.issues]
    issues += issues_of(estimates, errors, found.unseen, ranges, held, statistics)
    issues += [*noisy, *too_few_to_score(statistics, judged.unknowns)]
    issues += model.cautions(values, names, covariance)
    if not optimum.status.success:
        issues.insert(0, Issue("not-converged", "error", optimum.status.value))
    return FitResult(
        model=model.spec(),
        input=logs.input,
        outputs=logs.outputs,
        status=optimum.status,
        message=optimum.status.value,
        parameters=estimates,
        derived=model.derived(values, ranges[logs.input]),
        nuisances=(*nuisances, *judged.nuisances),
        statistics=statistics,
        noise=errors.noise,
        correlation=correlation,
        covariance=covariance,
        free=names,
        condition_number=errors.covariance.condition_number if errors.covariance else None,
        aic=errors.aic,
        bic=errors.bic,
        fitted_range=ranges,
        simulations=(*simulations, *judged.simulations),
        evaluations=optimum.evaluations,
        issues=most_serious_first(issues),
        choice=choice.reason if choice else None,
        fingerprints={log.name: log.source.sha256 if log.source else "" for log in (*logs, *held)},
        seed=seed,
        intersample=logs.logs[0].intersample,
        derived_stderr=_derived_errors(
            problem, values, ranges[logs.input], estimates, names, covariance
        ),
    )


def _require_finite(optimum: Optimum, logs: LogSet) -> None:
    if not np.isfinite(optimum.cost):
        raise IdentificationError(
            optimum.status.value,
            where=", ".join(log.name for log in logs),
            remedy="check the units, fix or bound a parameter, or choose another --model (model= "
            "in Python)",
        )


def _derived_errors(
    problem: Problem,
    values: Mapping[str, float],
    reach: tuple[float, float],
    estimates: Sequence[ParameterEstimate],
    names: Sequence[str],
    covariance: Array | None,
) -> dict[str, float | None]:
    """Standard errors of what `Model.derived` computes, in which tied parameters follow."""
    undetermined = [e.name for e in estimates if not (e.fixed or e.tie or e.name in names)]
    return propagated_errors(
        lambda trial: problem.model.derived(with_ties_followed(problem, trial), reach),
        values,
        names,
        covariance,
        undetermined=undetermined,
    )


@dataclass(frozen=True, eq=False)
class HeldOutResponses:
    """Logs that were not fitted, with the parameters held.

    Attributes
    ----------
    nuisances
        Zeros and initial states, estimated on each log itself.
    simulations
        The responses with those.
    unknowns
        Name of a log → how many of them any of its outputs may follow.
    """

    nuisances: tuple[LogNuisance, ...] = ()
    simulations: tuple[Simulation, ...] = ()
    unknowns: Mapping[str, int] = field(default_factory=dict)


def held_out(model: Model, values: Mapping[str, float], logs: Sequence[Log]) -> HeldOutResponses:
    """Zeros, initial states and simulations of logs that were not fitted."""
    if not logs:
        return HeldOutResponses()
    problem = Problem(model, model.parameters().with_fixed(values), logs)
    nuisances = nuisances_of(problem, refit_nuisance(problem), None)
    unknowns = {log.name: int(problem.zeros) for log in logs}
    for k, owner in enumerate(problem.owner):
        unknowns[logs[owner].name] += len(problem.state_positions(k))
    return HeldOutResponses(nuisances, _simulations(model, values, logs, nuisances), unknowns)


def _fitted_simulations(
    found: OptimisedProblem,
    values: Mapping[str, float],
    logs: Sequence[Log],
    nuisances: Sequence[LogNuisance],
) -> tuple[Simulation, ...]:
    """Those of the fitted logs, from what the last evaluation left over where that is known.

    With effects the derivatives ask for steps of their own, and a simulation for others.
    """
    problem, known = found.problem, found.optimum.linearised
    is_plain = problem.model.without_effects is problem.model
    is_whole = all(s.samples_of(s.used[name]).all() for s in problem.segments for name in s.used)
    if known is None or not (is_plain and known.has_residuals and is_whole):
        return _simulations(problem.model, values, logs, nuisances)
    left: list[dict[str, list[Array]]] = [{name: [] for name in problem.outputs} for _ in logs]
    for piece in known.pieces:
        segment = problem.segments[piece.segment]
        rows = left[problem.owner[piece.segment]][piece.channel]
        rows.append(segment.samples_of(piece.residuals))
    return tuple(simulation_left(log, rows) for log, rows in zip(logs, left, strict=True))


def _simulations(
    model: Model, values: Mapping[str, float], logs: Sequence[Log], nuisances: Sequence[LogNuisance]
) -> tuple[Simulation, ...]:
    return tuple(
        simulate(model, values, log, nuisance=nuisance)
        for log, nuisance in zip(logs, nuisances, strict=True)
    )
