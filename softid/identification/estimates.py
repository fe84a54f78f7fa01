"""From an optimum to what is reported: errors, verdicts, noise, scores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.fitters.output_error import Optimum
from softid.fitters.problem import Block, Problem
from softid.log import Log
from softid.residuals import fit_statistics
from softid.results import (
    FitStatistics,
    LogNuisance,
    NoiseModel,
    ParameterEstimate,
    SegmentStart,
    Simulation,
    Verdict,
)
from softid.uncertainty import (
    CI_METHOD,
    Covariance,
    ResidualBlock,
    confidence_interval,
    fit_ar,
    log_likelihood,
    noise_model,
    sandwich_covariance,
    standard_error,
    to_linear,
)
from softid.uncertainty.identifiability import judge

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Errors:
    """Uncertainty of an optimum.

    Attributes
    ----------
    covariance
        Over `determined`, in internal coordinates; None when nothing was free.
    determined
        Unknowns away from bounds, as indices into the problem's vector.
    noise
        Noise model of every output channel.
    aic, bic
        From the likelihood of the residuals under their autoregressions.
    """

    covariance: Covariance | None
    determined: tuple[int, ...]
    noise: tuple[NoiseModel, ...]
    aic: float | None
    bic: float | None


def unknown_names(problem: Problem) -> list[str]:
    """A name for every unknown, shape (U,)."""
    names = [f"unknown {k}" for k in range(problem.size)]
    names[: len(problem.free)] = problem.free
    if problem.zeros:
        for k, log in enumerate(problem.logs):
            for channel in problem.outputs:
                names[problem.zero_position(k, channel)] = f"zero of {log.name} {channel}"
    return names


def errors_of(problem: Problem, optimum: Optimum) -> Errors:
    """Covariance, noise models and information criteria at an optimum."""
    blocks = list(problem.blocks(optimum.unknowns, derivatives=True))
    stuck = optimum.at_bound.copy()
    stuck[len(problem.free) :] = False
    columns = np.flatnonzero(~stuck)
    grouped = [_residual_block(problem, blocks, name, columns, optimum) for name in problem.outputs]
    names = unknown_names(problem)
    noise, likelihood = [], 0.0
    for block in grouped:
        ar = fit_ar(block.residuals)
        noise.append(
            noise_model(block.channel, block.residuals, fitted_parameters=problem.size, ar=ar)
        )
        likelihood += log_likelihood(ar, block.residuals)
    n = problem.n_samples
    covariance = None
    if columns.size and n > columns.size:
        covariance = sandwich_covariance(grouped, [names[k] for k in columns])
    return Errors(
        covariance,
        tuple(int(k) for k in columns),
        tuple(noise),
        2.0 * problem.size - 2.0 * likelihood,
        float(np.log(n)) * problem.size - 2.0 * likelihood,
    )


def _residual_block(
    problem: Problem, blocks: Sequence[Block], channel: str, columns: Array, optimum: Optimum
) -> ResidualBlock:
    """Spread used residuals over all samples of their segment, so that gaps stay gaps."""
    jacobians, residuals = [], []
    for block in blocks:
        if block.channel != channel or block.jacobian is None:
            continue
        used = problem.segments[block.segment].used[channel]
        jacobian = np.zeros((used.size, len(columns)))
        residual = np.full(used.size, np.nan)
        jacobian[used] = block.jacobian[:, columns]
        residual[used] = block.residual
        jacobians.append(jacobian)
        residuals.append(residual)
    return ResidualBlock(channel, tuple(jacobians), tuple(residuals), 1.0 / optimum.sigma[channel])


def parameter_estimates(
    problem: Problem, optimum: Optimum, errors: Errors, unseen: Mapping[str, str]
) -> tuple[ParameterEstimate, ...]:
    """One row per parameter of the model.

    Parameters
    ----------
    problem, optimum, errors
        The fit.
    unseen
        Parameters that were dropped because the logs cannot see them, with the reason.
    """
    theta = dict(zip(problem.parameters.names, problem.theta(optimum.unknowns), strict=True))
    rows = []
    for name, p in problem.parameters.items():
        index = problem.free.index(name) if name in problem.free else None
        row = None
        if index is not None and index in errors.determined and errors.covariance is not None:
            row = errors.determined.index(index)
        covariance = errors.covariance
        sd = freedom = None
        if row is not None and covariance is not None:
            sd, freedom = covariance.sd[row], covariance.degrees_of_freedom[row]
        at_bound = index is not None and bool(optimum.at_bound[index])
        verdict, reason = _verdict(problem, errors, name, sd, row, at_bound, unseen, theta[name])
        rows.append(
            ParameterEstimate(
                name=name,
                unit=p.unit,
                value=float(theta[name]),
                stderr=standard_error(float(theta[name]), p.scale, sd),
                ci95=confidence_interval(float(theta[name]), p.scale, sd, freedom),
                ci_method=CI_METHOD if sd is not None else None,
                lower=p.lower if np.isfinite(p.lower) else None,
                upper=p.upper if np.isfinite(p.upper) else None,
                fixed=p.fixed,
                tie=p.tie,
                at_bound=at_bound,
                verdict=verdict,
                reason=reason,
                remedy=_remedy(problem, name) if "identified" in verdict and reason else "",
                scale=p.scale,
                meaning=p.meaning,
            )
        )
    return tuple(rows)


def _verdict(
    problem: Problem,
    errors: Errors,
    name: str,
    sd: float | None,
    row: int | None,
    at_bound: bool,
    unseen: Mapping[str, str],
    value: float,
) -> tuple[Verdict, str]:
    p = problem.parameters[name]
    if name in unseen:
        return "not identified", unseen[name]
    if p.tie is not None:
        return "tied", f"computed as {p.tie}"
    if p.fixed:
        return "fixed", ""
    partner = _partner(errors, row)
    return judge(
        value,
        p.scale,
        sd,
        at_bound=at_bound,
        partner=partner,
        # The search is far wider than anything plausible, so it is no measure of what is known.
        lower=p.lower if at_bound else None,
        upper=p.upper if at_bound else None,
        companions=_companions(errors, name),
    )


def _remedy(problem: Problem, name: str) -> str:
    """The log that would show a parameter."""
    shown_by = problem.model.identified_by.get(name)
    return f"record {shown_by}" if shown_by else ""


def _partner(errors: Errors, row: int | None) -> tuple[str, float] | None:
    """The unknown most correlated with one of them, with the correlation."""
    if row is None or errors.covariance is None:
        return None
    matrix = errors.covariance.matrix
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = matrix[row] / np.sqrt(matrix[row, row] * np.diag(matrix))
    correlation[row] = 0.0
    if not np.isfinite(correlation).any():
        return None
    k = int(np.nanargmax(np.abs(correlation)))
    return errors.covariance.names[k], float(correlation[k])


def _companions(errors: Errors, name: str) -> tuple[str, ...]:
    """Other unknowns in a direction that the residuals cannot see, together with this one."""
    groups = errors.covariance.undetermined if errors.covariance else ()
    return tuple(n for group in groups if name in group for n in group if n != name)


def free_covariance(
    problem: Problem, optimum: Optimum, errors: Errors
) -> tuple[tuple[str, ...], Array | None, Array | None]:
    """Names, covariance and correlation of the free parameters that have standard errors."""
    if errors.covariance is None:
        return (), None, None
    keep = [
        r
        for r, k in enumerate(errors.determined)
        if k < len(problem.free) and errors.covariance.sd[r] is not None
    ]
    names = tuple(errors.covariance.names[r] for r in keep)
    if not keep:
        return (), None, None
    theta = dict(zip(problem.parameters.names, problem.theta(optimum.unknowns), strict=True))
    every = errors.covariance.names
    values = [theta.get(n, 1.0) for n in every]
    scales = [problem.parameters[n].scale if n in theta else "linear" for n in every]
    linear = to_linear(errors.covariance, values, scales)[np.ix_(keep, keep)]
    sd = np.sqrt(np.diag(linear))
    return names, linear, linear / np.outer(sd, sd)


def nuisances_of(
    problem: Problem, optimum: Optimum, errors: Errors | None
) -> tuple[LogNuisance, ...]:
    """Sensor zeros and initial states, one entry per log."""
    z = optimum.unknowns
    found = []
    for k, log in enumerate(problem.logs):
        zero = dict.fromkeys(problem.outputs, 0.0)
        stderr: dict[str, float | None] = dict.fromkeys(problem.outputs)
        for name in problem.outputs if problem.zeros else ():
            at = problem.zero_position(k, name)
            zero[name] = float(z[at])
            if errors is not None and errors.covariance is not None and at in errors.determined:
                stderr[name] = errors.covariance.sd[errors.determined.index(at)]
        starts = tuple(
            SegmentStart(float(s.time_s[0]), problem.at_rest[i], problem.start_state(z, i))
            for i, s in enumerate(problem.segments)
            if problem.owner[i] == k
        )
        found.append(LogNuisance(log.name, zero, stderr, starts))
    return tuple(found)


def scores(
    logs: Sequence[Log], simulations: Sequence[Simulation], *, in_sample: bool
) -> tuple[FitStatistics, ...]:
    """One row per log and output channel."""
    rows = []
    for log, simulation in zip(logs, simulations, strict=True):
        for name in log.outputs:
            channel = log.channels[name]
            rows.append(
                fit_statistics(
                    simulation.measured[name],
                    simulation.outputs[name],
                    used=simulation.used[name],
                    log=log.name,
                    channel=name,
                    unit=channel.unit,
                    in_sample=in_sample,
                    display_unit=channel.display_unit,
                    display_factor=channel.display_factor,
                )
            )
    return tuple(rows)
