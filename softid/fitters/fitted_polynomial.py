"""A fitted polynomial and what may be asked of it: values, band and inverse within its range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.errors import InputError, Issue
from softid.models.monotone import invert_monotone
from softid.models.polynomial import Domain, evaluate, powers, turning_points

Array = npt.NDArray[np.float64]
Branch = Literal["up", "down"]

EDGE_SHARE = 1e-9
"""Rounding that is forgiven at the ends of the fitted range."""


@dataclass(frozen=True, eq=False)
class PolynomialFit:
    """A polynomial fitted to one branch of one chamber.

    Attributes
    ----------
    order, coefficients
        p1, …, p(n+1), highest power first, over pressure in kPa.
    stderr
        Standard errors of the coefficients; None where no sample is left to tell the noise. They
        are strongly correlated in raw kPa: quote `curve_stderr`, not these, as the curve's error.
    stderr_method
        ``"ar-sandwich"``: noise with the memory that the residual shows; None without errors.
    residual_white
        Whether the Ljung–Box test keeps whiteness at 1 %; None with too few samples.
    condition_raw, condition_scaled
        Condition number of the powers of the pressure in kPa, and scaled to [−1, 1].
    domain, scaled_coefficients, scaled_covariance
        The same polynomial in the scaled pressure, and the covariance of its coefficients, shape
        (n + 1, n + 1), or None.
    fitted_range_kpa
        Smallest and largest pressure fitted; the polynomial says nothing outside.
    monotone
        Whether it only rises or only falls over that range.
    backward_kpa
        Stretches of the range where it runs against its overall direction.
    rmse, held_out_rmse
        Root mean square error over the fitted samples, and over blocks of neighbouring levels
        left out in turn (never the first or the last, which would be extrapolation); None when
        there are too few levels.
    n
        Samples fitted.
    branch, chamber
        What was fitted: ``"up"``, ``"down"`` or None for both; the label given by the user.
    issues
        What the user should know.
    """

    order: int
    coefficients: tuple[float, ...]
    stderr: tuple[float, ...] | None
    stderr_method: str | None
    residual_white: bool | None
    condition_raw: float
    condition_scaled: float
    domain: Domain
    scaled_coefficients: tuple[float, ...]
    scaled_covariance: Array | None
    fitted_range_kpa: tuple[float, float]
    monotone: bool
    backward_kpa: tuple[tuple[float, float], ...]
    rmse: float
    held_out_rmse: float | None
    n: int
    branch: Branch | None = None
    chamber: str | None = None
    issues: tuple[Issue, ...] = ()


def predict(fit: PolynomialFit, pressure_kpa: npt.ArrayLike) -> Array:
    """The fitted curve at pressures within its fitted range.

    Raises
    ------
    InputError
        A pressure is outside the fitted range.
    """
    pressure = np.asarray(pressure_kpa, dtype=np.float64)
    low, high = fit.fitted_range_kpa
    edge = EDGE_SHARE * (high - low)
    outside = (pressure < low - edge) | (pressure > high + edge)
    if outside.any():
        raise InputError(
            f"the polynomial was fitted from {low:g} to {high:g} kPa and is not extrapolated",
            where="pressure",
            value=float(pressure[outside].flat[0]),
            remedy="stay within the fitted range, or fit logs that reach further",
        )
    return evaluate(fit.scaled_coefficients, fit.domain.scaled(pressure))


def curve_stderr(fit: PolynomialFit, pressure_kpa: npt.ArrayLike) -> Array | None:
    """Standard error of the fitted curve at pressures of shape (m,), or None when unknown."""
    if fit.scaled_covariance is None:
        return None
    basis = powers(fit.domain.scaled(pressure_kpa), fit.order)
    variance = np.einsum("ij,jk,ik->i", basis, fit.scaled_covariance, basis)
    band: Array = np.sqrt(np.maximum(variance, 0.0))
    return band


def inverse(
    fit: PolynomialFit, output: npt.ArrayLike, *, between_kpa: tuple[float, float] | None = None
) -> Array:
    """Pressure that gives an output, on a stretch where the curve is monotone.

    Parameters
    ----------
    fit
        The fitted curve.
    output
        Wanted outputs of any shape.
    between_kpa
        Monotone stretch within the fitted range; by default the whole range.

    Raises
    ------
    InputError
        The curve turns within the stretch, the stretch leaves the fitted range, or the curve does
        not reach an output.
    """
    low, high = between_kpa or fit.fitted_range_kpa
    predict(fit, [low, high])
    turns = turning_points(fit.coefficients, low, high)
    if turns.size:
        raise InputError(
            f"the polynomial turns within {low:g} to {high:g} kPa, so it has no single inverse",
            where="pressure",
            value=[round(float(t), 3) for t in turns],
            remedy="name a stretch between two turns",
        )
    wanted = np.asarray(output, dtype=np.float64)
    slope = np.polyder(np.array(fit.scaled_coefficients))
    u_low, u_high = fit.domain.scaled([low, high]).tolist()
    ends = np.sort(evaluate(fit.scaled_coefficients, [u_low, u_high]))
    slack = EDGE_SHARE * (ends[1] - ends[0])
    missed = ~((wanted >= ends[0] - slack) & (wanted <= ends[1] + slack))
    if missed.any():
        raise InputError(
            f"the curve reaches {ends[0]:g} to {ends[1]:g} between {low:g} and {high:g} kPa",
            where="output",
            value=float(wanted[missed].flat[0]),
            remedy="ask for an output within that",
        )
    u = invert_monotone(
        lambda v: evaluate(fit.scaled_coefficients, v),
        lambda v: evaluate(slope, v),
        np.clip(wanted, ends[0], ends[1]),
        u_low,
        u_high,
    )
    return fit.domain.centre + fit.domain.half * u
