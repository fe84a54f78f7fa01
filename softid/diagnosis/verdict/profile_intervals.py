"""Intervals of what a cause is made of, where the response is not linear within them.

The size of an effect is told well as a rule, and so is its interval from the covariance. The speed,
the time or the softness that rounds its law is often known to an order of magnitude, or to one side
only, and there the sum of squares is no parabola.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate, advance, begun
from softid.diagnosis.refit.optimum import optimum_of
from softid.diagnosis.refit.whitening import Whitener
from softid.diagnosis.search.effect_starts import squares_at
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis_results import Cause
from softid.effects import belongs_to
from softid.effects.base import Effect
from softid.errors import Issue
from softid.fitters.problem import Problem
from softid.identification.issues import estimate_issue
from softid.identification.parameter_covariance import errors_of
from softid.identification.profile_likelihood import ProfileRefits, Starts
from softid.parallel import in_parallel
from softid.parameters import Parameter
from softid.results import FitResult, ParameterEstimate
from softid.uncertainty import Covariance, widened
from softid.uncertainty.profile import CI_METHOD, ProfileResult, profile

Array = npt.NDArray[np.float64]

TRUSTED_ERROR = 0.1
"""Relative standard error below which an interval from the covariance stands, where it ends within
the bounds of the search."""

REFIT_EVALUATIONS = 25
"""Evaluations of one refit with a parameter held."""

ACCURACY = 0.01
"""A refit rests where no more than this share of one variance is to be gained: a limit lies where
four of them are lost."""

LEAST_REST, MOST_REST = 1e-2, 0.3
"""Bounds of how many standard errors from its optimum a refit rests."""

FIRST_STEP = 0.5
"""First step along a parameter of which the covariance says nothing: in logarithms on such a scale,
else in times its own value, or a tenth of the way between its bounds where that is longer."""


def with_intervals(
    after: FitResult | None,
    causes: Sequence[Cause],
    is_named: Sequence[bool],
    chain: Chain,
    sigma: Mapping[str, float],
    least_sd: Mapping[str, float] = MappingProxyType({}),
    noise: Whitener | None = None,
) -> tuple[FitResult | None, tuple[Cause, ...]]:
    """The fit and its causes with profile likelihood intervals of what is named.

    Parameters
    ----------
    after
        The model with all causes, as a fit; None without one.
    causes, is_named
        The causes, and which of them may be named.
    chain
        The links to them.
    sigma
        Output channel → scale that its residual is divided by.
    least_sd
        As in `softid.identification.assembly.assemble`.
    noise
        That under which the model is at its optimum; None for white noise.
    """
    named = [link.added for link, stays in zip(chain.links, is_named, strict=True) if stays]
    if after is None or not named:
        return after, tuple(causes)
    known = with_profile_intervals(after, chain.final, named, sigma, least_sd, noise)
    told = (tuple(known.parameter(p.name) for p in cause.parameters) for cause in causes)
    pairs = zip(causes, told, strict=True)
    return known, tuple(replace(cause, parameters=own) for cause, own in pairs)


def with_profile_intervals(
    fit: FitResult,
    final: Candidate,
    effects: Sequence[Effect],
    sigma: Mapping[str, float],
    least_sd: Mapping[str, float] = MappingProxyType({}),
    noise: Whitener | None = None,
) -> FitResult:
    """The fit with profile likelihood intervals of what effects know badly, or beside a bound.

    A side that the logs leave open ends at the bound of the search. Knots of a curve trade with the
    curve of the base, and stay as they are.

    Parameters
    ----------
    fit
        The model with its effects, as a fit.
    final
        The same where it stands.
    effects
        Those whose parameters are looked at.
    sigma
        Output channel → scale that its residual is divided by.
    least_sd, noise
        As in `with_intervals`.
    """
    rough = [
        p.name
        for effect in effects
        if len(effect.amplitudes) <= 1
        for p in _rough_ones([p for p in fit.parameters if belongs_to(effect, p.name)])
        if p.name in final.problem.free
    ]
    covariance = errors_of(final.problem, optimum_of(final, sigma)).covariance if rough else None
    if covariance is None:
        return fit
    covariance = widened(covariance, least_sd)
    if noise is not None:
        final = advance(replace(final, whitener=noise), sigma, 1)
    profiles = in_parallel(lambda name: _profile_of(final, name, covariance, sigma), rough)
    known = dict(zip(rough, profiles, strict=True))
    told = [_with_interval(p, known.get(p.name)) for p in fit.parameters]
    return replace(fit, parameters=tuple(told), issues=_issues_with(told, fit))


def _issues_with(told: Sequence[ParameterEstimate], fit: FitResult) -> tuple[Issue, ...]:
    """The remarks of a fit, with those on the parameters that are told otherwise now."""
    changed = [pair for pair in zip(fit.parameters, told, strict=True) if pair[0] is not pair[1]]
    earlier = {estimate_issue(before) for before, _ in changed}
    now = [issue for _, p in changed if (issue := estimate_issue(p)) is not None]
    at = next((k for k, issue in enumerate(fit.issues) if issue in earlier), len(fit.issues))
    behind = [issue for issue in fit.issues[at:] if issue not in earlier]
    return (*fit.issues[:at], *now, *behind)


def _rough_ones(own: Sequence[ParameterEstimate]) -> list[ParameterEstimate]:
    """Those of one effect whose interval may be another one than the covariance has.

    Where one of them has run into its bound, that of the others is as if it were known to be there.
    """
    is_held = any(p.at_bound for p in own)
    return [p for p in own if is_held or _is_rough(p)]


def _is_rough(p: ParameterEstimate) -> bool:
    """Whether its interval from the covariance may be another one than the logs tell."""
    if p.stderr is None or p.ci95 is None or p.stderr > TRUSTED_ERROR * abs(p.value):
        return True
    lower, upper = p.lower, p.upper
    return (lower is not None and p.ci95[0] < lower) or (upper is not None and p.ci95[1] > upper)


def _profile_of(
    final: Candidate, name: str, covariance: Covariance, sigma: Mapping[str, float]
) -> ProfileResult | None:
    """The profile along one parameter, by refits as coarse as those of the search.

    None where there is no scale to hold a step or a rise of the cost against.
    """
    p, value = final.problem.parameters[name], final.parameters[name]
    sd, unit, freedom = _steps_of(p, value, covariance)
    unit *= _of_whitened(final, sigma)
    if not (sd > 0.0 and unit > 0.0):
        return None

    size = final.problem.size
    variance = final.squares / max(final.problem.n_samples - size, 1)
    rest = np.sqrt(ACCURACY * unit / (size * max(variance, np.finfo(float).tiny)))
    tolerance = float(np.clip(rest, LEAST_REST, MOST_REST))

    def solve(rival: Problem, starts: Starts) -> tuple[float, Array]:
        nearer = (starts.predicted, starts.nearest)
        z = min(nearer, key=lambda start: squares_at(rival, start, sigma))
        begin = replace(begun(final, final.effects, rival, z), whitener=final.whitener)
        found = advance(begin, sigma, REFIT_EVALUATIONS, tolerance=tolerance)
        return found.squares, found.minimum.point

    at = final.minimum
    refits = ProfileRefits(
        final.problem, name, at.point, final.parameters, solve, matrix=at.normal.matrix
    )
    return profile(
        refits.refit,
        value,
        sd=sd,
        cost_per_variance=unit,
        optimum_cost=final.squares,
        scale=p.scale,
        lower=min(p.lower, value),
        upper=max(p.upper, value),
        degrees_of_freedom=freedom,
    )


def _of_whitened(final: Candidate, sigma: Mapping[str, float]) -> float:
    """How much larger a square of the first output is in the unit of the noise than in its own."""
    if final.whitener is None:
        return 1.0
    first = final.problem.outputs[0]
    return (sigma[first] / final.whitener.sigma[final.problem.owner[0], first]) ** 2


def _steps_of(p: Parameter, value: float, covariance: Covariance) -> tuple[float, float, float]:
    """First step, rise of the cost for one variance, and degrees of freedom.

    What the covariance leaves out, at a bound or in a direction that is not seen, is judged by the
    parameter whose noise is inflated most.
    """
    row = covariance.names.index(p.name) if p.name in covariance.names else None
    sd = covariance.sd[row] if row is not None else None
    if row is not None and sd:
        freedom = covariance.degrees_of_freedom[row] or np.inf
        return float(sd), float(covariance.cost_per_variance[row]), float(freedom)
    units = covariance.cost_per_variance
    step = FIRST_STEP if p.scale == "log" else FIRST_STEP * _usual_size(p, value)
    return step, float(np.max(units, where=units > 0.0, initial=0.0)), np.inf


def _usual_size(p: Parameter, value: float) -> float:
    """The size of a value on a linear scale, which may be zero at a bound."""
    between = p.upper - p.lower
    return max(abs(value), 0.1 * between if np.isfinite(between) else 0.0)


def _with_interval(p: ParameterEstimate, found: ProfileResult | None) -> ParameterEstimate:
    """The estimate with the interval of its profile; as it is where a bound is missing."""
    if found is None:
        return p
    low = p.lower if found.unbounded_below else found.ci95[0]
    high = p.upper if found.unbounded_above else found.ci95[1]
    if low is None or high is None:
        return p
    told = replace(p, ci95=(low, high), ci_method=CI_METHOD)
    open_sides = [
        side
        for side, is_open in (("lower", found.unbounded_below), ("upper", found.unbounded_above))
        if is_open
    ]
    if not open_sides:
        return told
    if len(open_sides) == 2:
        reason = "the logs set it no limit within its bounds"
        return replace(told, verdict="not identified", reason=reason)
    reason = f"the logs set it no {open_sides[0]} limit within its bounds"
    return replace(told, verdict="weakly identified", reason=reason)
