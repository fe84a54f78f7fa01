"""A candidate as a finished optimisation, whose errors can be computed."""

from __future__ import annotations

from collections.abc import Mapping

from softid.diagnosis.refit.candidates import BASE_SD, Candidate
from softid.fitters.output_error import Optimum
from softid.results import FitStatus


def optimum_of(candidate: Candidate, sigma: Mapping[str, float]) -> Optimum:
    """The point at which a candidate stands, as the end of a fit.

    Parameters
    ----------
    candidate
        A refit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    point = candidate.minimum.point
    return Optimum(
        unknowns=point,
        cost=0.5 * candidate.squares,
        sigma=dict(sigma),
        status=FitStatus.CONVERGED,
        offset=candidate.minimum.offset,
        evaluations=candidate.minimum.evaluations,
        at_bound=candidate.problem.at_bound(point),
        start=candidate.prior.centre,
    )


def prior_sd(model: Candidate, place: int) -> float:
    """Standard deviation of a prior that knows a free parameter to a factor of 4.5.

    Parameters
    ----------
    model
        A refit.
    place
        Of the parameter among the free ones.

    Returns
    -------
    float
        On the parameter's own scale.
    """
    problem = model.problem
    is_relative = problem.parameters[problem.free[place]].scale == "log"
    return BASE_SD * (1.0 if is_relative else max(abs(float(model.minimum.point[place])), 1.0))
