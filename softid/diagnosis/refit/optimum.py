"""A candidate as a finished optimisation, whose errors can be computed and compared."""

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


def squares_under(
    candidate: Candidate, own: Mapping[str, float], sigma: Mapping[str, float]
) -> float:
    """What a candidate leaves, in the scales of another fit.

    With several outputs each fit divides the residuals by its own errors, so that its sum of
    squares is the number of samples, however good it is.

    Parameters
    ----------
    candidate
        A model of the same outputs.
    own, sigma
        Output channel → scale that its residual is divided by, and that of the other fit.
    """
    if own == sigma:
        return candidate.squares
    blocks = candidate.problem.blocks(candidate.minimum.point, derivatives=False)
    return sum(float(b.residual @ b.residual) / sigma[b.channel] ** 2 for b in blocks)
