"""From an optimum to what is reported: estimates with verdicts, nuisances, scores."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from softid.fitters.output_error import Optimum
from softid.fitters.problem import Problem
from softid.identification.parameter_constraints import ParameterConstraints
from softid.identification.parameter_covariance import Errors
from softid.identification.tied_errors import tied_deviation
from softid.log import Log
from softid.parameters import ParameterScale
from softid.results import (
    FitStatistics,
    LogNuisance,
    ParameterEstimate,
    ParameterVerdict,
    SegmentStart,
    Simulation,
)
from softid.scores import are_too_few, fit_statistics
from softid.uncertainty import CI_METHOD, Covariance, confidence_interval, standard_error
from softid.uncertainty.identifiability import companions, judge, strongest_partner

MOST_RATIO = 1e6
"""An interval over more than this factor says nothing but that the parameter is not known."""


def parameter_estimates(
    problem: Problem,
    optimum: Optimum,
    errors: Errors,
    unseen: Mapping[str, str],
    constraints: ParameterConstraints,
) -> tuple[ParameterEstimate, ...]:
    """One row per parameter of the model.

    Parameters
    ----------
    problem, optimum, errors
        The fit.
    unseen
        Parameters that were dropped because the logs cannot see them, with the reason.
    constraints
        What the user asked for: only bounds of theirs say how wide a search was plausible.
    """
    theta, rows = problem.values(optimum.unknowns), []
    for name, p in problem.parameters.items():
        index = problem.free.index(name) if name in problem.free else None
        value, row = theta[name], None
        if index is not None:  # the power of a bound's logarithm may round to beyond it
            value = min(max(value, p.lower), p.upper)
        if index is not None and index in errors.determined and errors.covariance is not None:
            row = errors.determined.index(index)
        covariance = errors.covariance
        sd = freedom = None
        if row is not None and covariance is not None:
            sd, freedom = covariance.sd[row], covariance.degrees_of_freedom[row]
        elif p.tie is not None:
            sd, freedom = tied_deviation(problem, optimum, errors, name)
        at_bound = index is not None and bool(optimum.at_bound[index])
        known = at_bound or constraints.bounds(name)
        verdict, reason = _verdict(
            problem, covariance, name, sd, at_bound, unseen, value, use_bounds=known
        )
        interval = _interval(value, p.scale, sd, freedom)
        is_free = index is not None
        if is_free and interval is not None and interval[0] < p.lower and interval[1] > p.upper:
            verdict, reason = "not identified", "its interval is wider than its bounds"
        rows.append(
            ParameterEstimate(
                name=name,
                unit=p.unit,
                value=value,
                stderr=standard_error(value, p.scale, sd),
                ci95=interval,
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


def _interval(
    value: float, scale: ParameterScale, sd: float | None, freedom: float | None
) -> tuple[float, float] | None:
    """95 % interval, or None where it would span so many orders that it says nothing."""
    interval = confidence_interval(value, scale, sd, freedom)
    if interval is None or scale == "linear" or interval[1] < MOST_RATIO * interval[0]:
        return interval
    return None


def _verdict(
    problem: Problem,
    covariance: Covariance | None,
    name: str,
    sd: float | None,
    at_bound: bool,
    unseen: Mapping[str, str],
    value: float,
    *,
    use_bounds: bool,
) -> tuple[ParameterVerdict, str]:
    p = problem.parameters[name]
    if name in unseen:
        return "not identified", unseen[name]
    if p.tie is not None:
        return "tied", f"computed as {p.tie}"
    if p.fixed:
        return "fixed", ""
    partner: tuple[str, float] | None = None
    others: tuple[str, ...] = ()
    if covariance is not None:
        partner = strongest_partner(covariance, name) if sd is not None else None
        others = companions(covariance, name)
    return judge(
        value,
        p.scale,
        sd,
        at_bound=at_bound,
        partner=partner,
        lower=p.lower if use_bounds else None,
        upper=p.upper if use_bounds else None,
        companions=others,
    )


def _remedy(problem: Problem, name: str) -> str:
    """The log that would show a parameter."""
    shown_by = problem.model.identified_by.get(name)
    return f"record {shown_by}" if shown_by else ""


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
    logs: Sequence[Log],
    simulations: Sequence[Simulation],
    *,
    in_sample: bool,
    unknowns: Mapping[str, int] = MappingProxyType({}),
) -> tuple[FitStatistics, ...]:
    """One row per log and output channel.

    Parameters
    ----------
    logs, simulations
        What was measured and simulated.
    in_sample
        Whether the parameters were fitted to the logs.
    unknowns
        Name of a log → how many zeros and initial states were estimated on it alone: as few samples
        as `are_too_few` says have no relative score.
    """
    rows = []
    for log, simulation in zip(logs, simulations, strict=True):
        for name in log.outputs:
            channel = log.channels[name]
            row = fit_statistics(
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
            if are_too_few(row.n, unknowns.get(log.name, 0)):
                row = replace(row, nrmse=np.nan, fit_percent=np.nan, r2=np.nan, vaf=np.nan)
            rows.append(row)
    return tuple(rows)
