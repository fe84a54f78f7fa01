"""Whether an optimum explains its logs down to white noise, so that no other needs to be sought."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.fitters.levenberg_marquardt import Minimum
from softid.fitters.problem import Problem
from softid.fitters.residual_whiteness import (
    TESTED_LAGS,
    WHITE_SDS,
    largest_sum,
    residuals_by_channel,
    squared_autocorrelation,
)

Array = npt.NDArray[np.float64]

FEWEST_RESIDUALS = 10 * TESTED_LAGS
"""Residuals per channel from which their autocorrelation says anything."""

DETERMINED = 0.1
"""Largest standard error of a parameter, as a share of its plausible move."""


def at_noise_level(problem: Problem, found: Minimum) -> bool:
    """Whether the residual is white and every parameter is well determined.

    The statistic is that of Box and Pierce, from `squared_autocorrelation`. A simulation in a wrong
    basin leaves structure behind, and where the data hold every parameter the cost is a bowl
    without a second floor; where they do not, another optimum may lie along the flat direction
    although the residual is white.

    Parameters
    ----------
    problem
        What is fitted.
    found
        Where an optimiser ended.
    """
    normal = found.normal
    if not np.isfinite(normal.cost) or normal.n <= normal.point.size:
        return False
    return _determined(problem, found) and all(
        _white(residuals) for residuals in residuals_by_channel(problem, found.point, normal)
    )


def _determined(problem: Problem, found: Minimum) -> bool:
    normal, free = found.normal, len(problem.free)
    scale = np.sqrt(np.diag(normal.matrix))
    if not np.all(scale > 0.0):
        return False
    try:
        inverse = np.linalg.inv(normal.matrix / np.outer(scale, scale))
    except np.linalg.LinAlgError:
        return False
    variance = 2.0 * normal.cost / (normal.n - normal.point.size)
    squares = variance * np.diag(inverse)[:free] / scale[:free] ** 2
    limit = (DETERMINED * problem.reach()[:free]) ** 2
    return bool(np.all((squares >= 0.0) & (squares <= limit)))


def _white(residuals: list[Array]) -> bool:
    n = sum(r.size for r in residuals)
    if n < FEWEST_RESIDUALS or not any(np.ptp(r) > 0.0 for r in residuals):
        return False
    return n * squared_autocorrelation(residuals, TESTED_LAGS) <= largest_sum(WHITE_SDS)
