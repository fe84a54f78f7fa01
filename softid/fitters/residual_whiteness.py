"""Whiteness of residuals: what is left when a model explains all but noise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.fitters.levenberg_marquardt import NormalEquations
from softid.fitters.normal_equations import Linearised
from softid.fitters.problem import Problem
from softid.kernels.lagged_products import add_lagged_products

Array = npt.NDArray[np.float64]

TESTED_LAGS = 20
"""Autocorrelations that are tested together, and a residual of no more samples is not looked at.
More lags see a slower memory, but every one adds 2 to the variance of χ², in which a memory of a
few samples drowns; a judgement."""

WHITE_SDS = 4.0
"""Standard deviations of the χ² statistic up to which a residual counts as white."""

STRUCTURE_SDS = 6.0
"""Standard deviations of the χ² statistic beyond which a residual has structure. Between this and
`WHITE_SDS` a fit is not settled by its residual, and no ringing rival is looked for."""


def largest_sum(sds: float) -> float:
    """The sum of squared autocorrelations times n that white noise exceeds by chance only.

    Of χ² with `TESTED_LAGS` degrees of freedom ν: the mean ν and some standard deviations √(2ν).

    Parameters
    ----------
    sds
        How many: `WHITE_SDS` or `STRUCTURE_SDS`.
    """
    return TESTED_LAGS + sds * float(np.sqrt(2.0 * TESTED_LAGS))


def squared_autocorrelation(residuals: Sequence[Array], lags: int) -> float:
    """Σ ρ² over the first lags of residuals less their means; 0 where they are nothing.

    Box and Pierce (J. Am. Stat. Assoc. 65, 1970): n times the sum is χ² with as many degrees of
    freedom as lags when the residual is white.

    Parameters
    ----------
    residuals
        Of every segment, shape (n,) each.
    lags
        How many.
    """
    products = np.zeros(lags + 1)
    for r in residuals:
        add_lagged_products(r, r, float(r.mean()), products)
    power = float(products[0])
    return float(np.sum((products[1:] / power) ** 2)) if power > 0.0 else 0.0


def residuals_by_channel(
    problem: Problem, z: Array, known: NormalEquations | None = None
) -> list[list[Array]]:
    """Residuals of every segment up to their means, channel by channel.

    Parameters
    ----------
    problem
        What was fitted.
    z
        Unknowns, shape (U,).
    known
        Normal equations there, which may hold the residuals already.
    """
    if isinstance(known, Linearised) and known.has_residuals:
        parts = [(piece.channel, known.at_used(piece, piece.unmoved)) for piece in known.pieces]
    else:
        parts = [(b.channel, b.residual) for b in problem.blocks(z, derivatives=False)]
    return [[r for channel, r in parts if channel == name and r.size] for name in problem.outputs]
