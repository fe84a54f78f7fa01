"""Zhao's protocol by name: a quartic of output against pressure, per branch and per chamber.

Source: Zhao et al. 2021, doi 10.1155/2021/6623059, Eq 23, Tables 4 and 5.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, InputError, Issue, UsageError
from softid.fitters.branches import branches
from softid.fitters.fitted_polynomial import (
    Branch,
    PolynomialFit,
    curve_stderr,
    inverse,
    predict,
)
from softid.fitters.order_choice import (
    OrderChoice,
    choose_order,
    held_out_errors,
    pressure_pairs,
)
from softid.models.polynomial import Domain, Polynomial, backward_stretches, powers
from softid.residuals import whiteness
from softid.uncertainty import CI_METHOD, ResidualBlock, sandwich_covariance

__all__ = [
    "OrderChoice",
    "PolynomialFit",
    "branches",
    "choose_order",
    "curve_stderr",
    "inverse",
    "predict",
    "quartic",
    "quartics",
]

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

_LEAST_LAGS = 2
"""With fewer lags, of less than ten samples, the whiteness test says nothing."""

_ROUNDING = 1e-11
"""Residuals below this share of the largest output are rounding, whose memory says nothing."""


def quartic(
    pressure_kpa: npt.ArrayLike,
    output: npt.ArrayLike,
    *,
    order: int = 4,
    branch: Branch | None = None,
    chamber: str | None = None,
    reversal_kpa: float | None = None,
) -> PolynomialFit:
    """Fit y = p1·x⁴ + p2·x³ + p3·x² + p4·x + p5 by least squares on a scaled range.

    The polynomial is an empirical curve of settled levels. Its weaknesses: it knows no rate, so a
    moving record mixes lag into the curve; up and down branches of a soft actuator differ, and
    one curve through both has an error of half the loop; it need not be monotone (the paper's angle
    of the side chambers falls from 62.8 to 68.8 kPa and that of the middle one from 79.1 kPa); f(0)
    is not zero; and outside the fitted range the quartic term takes over at once.

    Parameters
    ----------
    pressure_kpa, output
        Samples in the order recorded, each of shape (n,); pairs with a NaN are left out.
    order
        n; 4 as in the paper, `choose_order` finds another.
    branch
        ``"up"`` or ``"down"`` fits only the samples of rising or falling pressure.
    chamber
        Label kept in the result.
    reversal_kpa
        How far the pressure must come back to count as a turn; 5 % of its range by default.

    Raises
    ------
    IdentificationError
        There are fewer different pressures than coefficients.
    InputError, UsageError
        The arrays differ in shape; the order is no order.

    Source: Zhao et al. 2021, Eq 23.

    Examples
    --------
    >>> p = np.arange(10.0, 81.0, 10.0)
    >>> quartic(p, 0.02 * p + 0.1).rmse < 1e-12
    True
    """
    pressure, y = pressure_pairs(pressure_kpa, output)
    used = np.isfinite(pressure) & np.isfinite(y)
    if branch is not None:
        wanted = {"up": 1, "down": -1}.get(branch)
        if wanted is None:
            raise UsageError(
                "there is no such branch", value=branch, remedy='choose "up" or "down"'
            )
        used &= branches(pressure, reversal_kpa=reversal_kpa) == wanted
    return _fit(pressure, y, used, order, branch, chamber)


def quartics(
    pressure_kpa: npt.ArrayLike,
    output: npt.ArrayLike,
    *,
    chambers: Sequence[str] | None = None,
    by_branch: bool = True,
    order: int = 4,
    reversal_kpa: float | None = None,
) -> tuple[PolynomialFit, ...]:
    """Fit every chamber, and its rising and falling branch, on its own.

    Parameters
    ----------
    pressure_kpa, output, order, reversal_kpa
        As in `quartic`.
    chambers
        One label per sample: the chamber that was driven; None for a single chamber.
    by_branch
        Whether rising and falling pressure are fitted apart.

    Returns
    -------
    tuple of PolynomialFit
        Chambers in the order of their first sample, up before down. A branch without a sample
        is not there.

    Raises
    ------
    IdentificationError
        A chamber or branch has fewer different pressures than coefficients.
    InputError, UsageError
        The arrays differ in shape, or there is not one label per sample; the order is no order.
    """
    pressure, y = pressure_pairs(pressure_kpa, output)
    labels: list[str | None] = [None] * pressure.size if chambers is None else list(chambers)
    if len(labels) != pressure.size:
        raise InputError(
            f"there are {len(labels)} chamber labels for {pressure.size} samples",
            where="chambers",
            remedy="give one label per sample",
        )
    fits = []
    for chamber in dict.fromkeys(labels):
        mine = np.array([label == chamber for label in labels])
        p, q = np.where(mine, pressure, np.nan), np.where(mine, y, np.nan)
        direction = branches(p, reversal_kpa=reversal_kpa)
        used = np.isfinite(p) & np.isfinite(q)
        sides: tuple[tuple[Branch | None, BoolArray], ...] = ((None, used),)
        if by_branch:
            sides = (("up", used & (direction == 1)), ("down", used & (direction == -1)))
        fits += [_fit(p, q, part, order, side, chamber) for side, part in sides if part.any()]
    return tuple(fits)


def _fit(
    pressure: Array,
    y: Array,
    used: BoolArray,
    order: int,
    branch: Branch | None,
    chamber: str | None,
) -> PolynomialFit:
    x = pressure[used]
    Polynomial(order)
    levels = np.unique(x).size
    if levels <= order:
        raise IdentificationError(
            f"there are {levels} different pressures, a polynomial of order {order} needs at least "
            f"{order + 1}",
            where=", ".join(part for part in (chamber, branch) if part) or None,
            remedy="lower the order or add levels",
        )
    domain = Domain.over(x)
    basis = powers(domain.scaled(x), order)
    scaled = np.linalg.lstsq(basis, y[used], rcond=None)[0]
    residual = np.full(pressure.size, np.nan)
    residual[used] = y[used] - basis @ scaled
    covariance, white = _errors(basis, residual, used, float(np.abs(y[used]).max()))
    raw = domain.to_raw(order)
    coefficients = raw @ scaled
    low, high = float(x.min()), float(x.max())
    backward = backward_stretches(coefficients, low, high)
    held_out = held_out_errors(x, y[used], order)
    stderr = None
    if covariance is not None:
        variance = np.maximum(np.diag(raw @ covariance @ raw.T), 0.0)
        stderr = tuple(np.sqrt(variance).tolist())
    usable = held_out.size > 0 and bool(np.isfinite(held_out).all())
    return PolynomialFit(
        order=order,
        coefficients=tuple(coefficients.tolist()),
        stderr=stderr,
        stderr_method=CI_METHOD if stderr else None,
        residual_white=white,
        condition_raw=float(np.linalg.cond(powers(x, order))),
        condition_scaled=float(np.linalg.cond(basis)),
        domain=domain,
        scaled_coefficients=tuple(scaled.tolist()),
        scaled_covariance=covariance,
        fitted_range_kpa=(low, high),
        monotone=not backward,
        backward_kpa=backward,
        rmse=float(np.sqrt(np.nanmean(residual**2))),
        held_out_rmse=float(np.sqrt(held_out.mean())) if usable else None,
        n=int(used.sum()),
        branch=branch,
        chamber=chamber,
        issues=_issues(backward, white, levels - order - 1),
    )


def _errors(
    basis: Array, residual: Array, used: BoolArray, scale: float
) -> tuple[Array | None, bool | None]:
    """Covariance of the scaled coefficients under the residual's own memory, and its whiteness."""
    n, k = basis.shape
    if n <= k + 2:
        return None, None
    jacobian = np.zeros((residual.size, k))
    jacobian[used] = basis
    block = ResidualBlock("output", (jacobian,), (residual,))
    names = [f"u{power}" for power in range(k - 1, -1, -1)]
    covariance = sandwich_covariance([block], names).matrix
    if float(np.nanmax(np.abs(residual))) <= _ROUNDING * scale:
        return covariance, None
    test = whiteness([residual])
    return covariance, test.is_white if test.degrees_of_freedom >= _LEAST_LAGS else None


def _issues(
    backward: tuple[tuple[float, float], ...], white: bool | None, spare_levels: int
) -> tuple[Issue, ...]:
    found = []
    if backward:
        where = ", ".join(f"{a:.1f} to {b:.1f} kPa" for a, b in backward)
        found.append(
            Issue(
                "not-monotone",
                "warning",
                f"the curve runs backward from {where}",
                "invert it only on a monotone stretch; check whether the data turn there too",
            )
        )
    if white is False:
        found.append(
            Issue(
                "coloured-residual",
                "info",
                "the residual has a memory, so the curve misses something: lag, a loop or a bend",
                "fit rising and falling pressure apart, or choose another order",
            )
        )
    if spare_levels <= 0:
        found.append(
            Issue(
                "no-spare-level",
                "warning",
                "the curve passes through every level, so nothing checks it between them",
                "add levels or lower the order",
            )
        )
    return tuple(found)
