"""Errors of tied parameters, and of what is computed from them, from those of the free ones."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from softid.fitters.output_error import Optimum
from softid.fitters.problem import Problem
from softid.identification.parameter_covariance import Errors
from softid.uncertainty.propagation import RESTS_ON


def tied_deviation(
    problem: Problem, optimum: Optimum, errors: Errors, name: str
) -> tuple[float | None, float | None]:
    """Standard deviation of a tied parameter in its internal coordinate, and its freedom.

    √(gᵀ C g) with g its slopes by the free unknowns. The degrees of freedom are the fewest of those
    that it is computed from: the widest interval of any of them.

    Parameters
    ----------
    problem, optimum, errors
        The fit.
    name
        A tied parameter.

    Returns
    -------
    tuple
        None twice where it is not known, since it rests on a parameter without an error.
    """
    covariance = errors.covariance
    if covariance is None:
        return None, None
    z, own = optimum.unknowns, problem.parameters[name]
    slopes = problem.chain(z)[problem.parameters.names.index(name)]
    value = problem.values(z)[name]
    if own.scale == "log":
        slopes = slopes / value
    size = 1.0 if own.scale == "log" else abs(value)
    known = {k: r for r, k in enumerate(errors.determined) if covariance.sd[r] is not None}
    moves = [k for k in range(len(problem.free)) if slopes[k] != 0.0]
    for k in set(moves) - known.keys():
        step = 1.0 if problem.parameters[problem.free[k]].scale == "log" else abs(z[k])
        if not abs(slopes[k]) * step <= RESTS_ON * size:
            return None, None
    moves = [k for k in moves if k in known]
    rows = [known[k] for k in moves]
    variance = float(slopes[moves] @ covariance.matrix[np.ix_(rows, rows)] @ slopes[moves])
    freedom = [found for r in rows if (found := covariance.degrees_of_freedom[r]) is not None]
    if not (rows and np.isfinite(variance) and variance > 0.0):
        return None, None
    return variance**0.5, min(freedom, default=None)


def with_ties_followed(problem: Problem, values: Mapping[str, float]) -> Mapping[str, float]:
    """Parameter → value with every tie computed from the others, without regard to bounds.

    Parameters
    ----------
    problem
        What was fitted.
    values
        Parameter → value; the tied ones do not matter.
    """
    if problem.ties is None:
        return values
    names = problem.parameters.names
    followed = problem.ties.computed(np.array([values[name] for name in names]))
    return dict(zip(names, followed.tolist(), strict=True))
