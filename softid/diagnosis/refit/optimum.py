"""A candidate as a finished optimisation, whose errors can be computed."""

from __future__ import annotations

from collections.abc import Mapping

from softid.diagnosis.refit.candidates import Candidate
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
