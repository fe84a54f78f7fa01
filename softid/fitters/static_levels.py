"""First stage of Ru's protocol: the sigmoid of settled levels, and the force balance it gives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt

from softid.channels import read_only
from softid.errors import IdentificationError, InputError, Issue
from softid.excitation import distinct_levels
from softid.kernels.muscle import KPA_PER_BAR

Array = npt.NDArray[np.float64]

POORLY_KNOWN = 0.5
"""Relative standard error of a parameter above which the user is told: its interval of two of them
then reaches down to zero."""

UNKNOWN = 10.0
"""Relative standard error of a parameter above which the user is told in words: a number of over
1000 % says no more."""

SAME_LEVEL = 0.01
"""Pressures closer than this share of their range are one level."""

TRIED_STEEPNESS = np.geomspace(0.5, 40.0, 25)
"""b1 times the range of the pressure, tried at the start."""

TRIED_MIDPOINTS = np.linspace(-0.5, 1.5, 33)
"""Midpoint of the sigmoid as a fraction of the range of the pressure, tried at the start."""

_ADVICE = {
    "a1": "add levels at higher pressure, where the curve saturates",
    "b1": "add levels on the steep part of the curve",
    "c1": "add levels at low pressure",
}


@dataclass(frozen=True, eq=False)
class LevelsFit:
    """The static curve x∞(p) = 1/(a1 + c1·exp(−b1·p)) + zero, p in bar.

    Attributes
    ----------
    a1, b1, c1
        Parameters of P = exp(b1·p) and Q = a1·P + c1; a1 and c1 per ``unit``, b1 per bar.
    zero
        Sensor zero in ``unit``, or None when x∞ was taken as recorded.
    unit
        Unit of x.
    stderr
        Parameter → standard error from the scatter of the levels, taken as independent; None with
        no level to spare.
    condition_number
        Of the Jacobian by (ln a1, ln b1, ln c1[, zero over the range of x]): 32 for levels from 0
        to 3 bar, 380 up to 0.8 bar only, 2250 above 2.5 bar only.
    pressure_kpa, contraction, fitted
        The levels, their recorded x and the curve there, each of shape (m,).
    rmse
        Root mean square of recorded − fitted.
    issues
        Parameters that the levels do not fix, with the levels that would.
    """

    a1: float
    b1: float
    c1: float
    zero: float | None
    unit: str
    stderr: Mapping[str, float | None]
    condition_number: float
    pressure_kpa: Array
    contraction: Array
    fitted: Array
    rmse: float
    issues: tuple[Issue, ...] = ()

    def static(self, pressure_kpa: npt.ArrayLike) -> Array:
        """x∞ with the zero, as recorded, at pressures of any shape."""
        p = np.asarray(pressure_kpa, dtype=np.float64) / KPA_PER_BAR
        theta = np.log([self.a1, self.b1, self.c1])
        return _sigmoid(theta, p)[0] + (self.zero or 0.0)

    def force_balance(self, pressure_kpa: npt.ArrayLike, contraction: npt.ArrayLike) -> Array:
        """P(p) − Q(p)·(x − zero): what inertia and damping must carry."""
        force = np.exp(self.b1 * np.asarray(pressure_kpa, dtype=np.float64) / KPA_PER_BAR)
        x = np.asarray(contraction, dtype=np.float64) - (self.zero or 0.0)
        balance: Array = force - (self.a1 * force + self.c1) * x
        return balance


def levels_from_arrays(
    pressure_kpa: npt.ArrayLike,
    contraction: npt.ArrayLike,
    *,
    zero: bool = False,
    unit: str = "mm",
) -> LevelsFit:
    """Fit the sigmoid x∞(p) = 1/(a1 + c1·exp(−b1·p)) to settled levels by least squares.

    Start values come from a grid over steepness and midpoint, in which the height (and the zero)
    follow linearly; no guess is asked for. Weakness: the levels must reach both ends of the curve.
    With 0.3 mm of noise, levels from 0 to 3 bar give a1, b1, c1 to 0.4, 1.3 and 5.7 %; levels
    up to 0.8 bar only give a1 to ±640 %, and levels above 2.5 bar only give c1 to ±319 %.

    Parameters
    ----------
    pressure_kpa, contraction
        One settled pressure and x per level, each of shape (m,); a level may repeat.
    zero
        Whether to estimate a sensor zero: real records have an arbitrary one, and the curve does
        not pass through x = 0 at p = 0. It is nearly the same thing as c1 unless levels near zero
        pressure are there.
    unit
        Unit of x.

    Raises
    ------
    InputError
        The arrays differ in shape or are not finite.
    IdentificationError
        There are fewer different levels than parameters, or x does not rise with the pressure.

    Source: Ru et al. 2019, doi 10.1007/s11432-018-9709-x, Eq 5.

    Examples
    --------
    >>> p = np.linspace(0.0, 300.0, 13)
    >>> fit = levels_from_arrays(p, 1.0 / (0.02 + 1.2 * np.exp(-2.5 * p / 100.0)))
    >>> round(fit.a1, 6), round(fit.b1, 6), round(fit.c1, 6)
    (0.02, 2.5, 1.2)
    """
    pressure, x = _checked(pressure_kpa, contraction)
    names = ("a1", "b1", "c1", "zero") if zero else ("a1", "b1", "c1")
    span = float(np.ptp(pressure)) if pressure.size else 0.0
    distinct = len(distinct_levels(pressure.tolist(), SAME_LEVEL * span))
    if distinct < len(names):
        raise IdentificationError(
            f"there are {distinct} different levels for {len(names)} parameters",
            where="levels",
            remedy="add settled levels, spread from zero pressure to saturation",
        )
    p = pressure / KPA_PER_BAR
    theta = _refined(_start(p, x, zero), p, x)
    curve, jacobian = _with_zero(theta, p)
    residual = x - curve
    norms = np.linalg.norm(jacobian, axis=0)
    norms[norms == 0] = 1.0
    values = np.append(np.exp(theta[:3]), theta[3:])
    relative = _standard_errors(jacobian / norms, norms, residual)
    stderr = {
        name: None if relative is None else float(error * (value if name != "zero" else 1.0))
        for name, value, error in zip(
            names, values, relative if relative is not None else values, strict=True
        )
    }
    return LevelsFit(
        a1=float(values[0]),
        b1=float(values[1]),
        c1=float(values[2]),
        zero=float(values[3]) if zero else None,
        unit=unit,
        stderr=stderr,
        condition_number=_condition(jacobian, x),
        pressure_kpa=read_only(pressure),
        contraction=read_only(x),
        fitted=read_only(curve),
        rmse=float(np.sqrt(np.mean(residual**2))),
        issues=_issues(relative),
    )


def _checked(pressure_kpa: npt.ArrayLike, contraction: npt.ArrayLike) -> tuple[Array, Array]:
    pressure = np.asarray(pressure_kpa, dtype=np.float64)
    x = np.asarray(contraction, dtype=np.float64)
    if pressure.ndim != 1 or pressure.shape != x.shape:
        raise InputError(
            "pressure and contraction differ in shape",
            where="levels",
            value=(pressure.shape, x.shape),
            remedy="give one contraction per settled pressure",
        )
    if not (np.isfinite(pressure).all() and np.isfinite(x).all()):
        raise InputError(
            "a level is not a finite number", where="levels", remedy="leave that level out"
        )
    return pressure, x


def _sigmoid(theta: Array, p: Array) -> tuple[Array, Array]:
    """x∞ and its derivatives by (ln a1, ln b1, ln c1); never overflows."""
    b1 = np.exp(theta[1])
    log_c = theta[2] - b1 * p
    total = np.logaddexp(theta[0], log_c)
    x = np.exp(-total)
    share_a, share_c = np.exp(theta[0] - total), np.exp(log_c - total)
    return x, np.stack([-x * share_a, x * share_c * b1 * p, -x * share_c], axis=-1)


def _with_zero(theta: Array, p: Array) -> tuple[Array, Array]:
    x, by = _sigmoid(theta, p)
    if theta.size == 3:
        return x, by
    return x + theta[3], np.column_stack([by, np.ones(p.size)])


def _start(p: Array, x: Array, zero: bool) -> Array:
    """Best of the grid; the height 1/a1 and the zero are linear in the recorded x."""
    low, span = float(p.min()), float(np.ptp(p))
    tried = np.array(list(product(TRIED_STEEPNESS / span, low + span * TRIED_MIDPOINTS)))
    exponent = tried[:, :1] * (p - tried[:, 1:])
    shape = 1.0 / (1.0 + np.exp(-np.clip(exponent, -500.0, 500.0)))
    shape_mean = shape.mean(axis=1, keepdims=True) if zero else 0.0
    x_mean = x.mean() if zero else 0.0
    rise, target = shape - shape_mean, x - x_mean
    power = np.sum(rise**2, axis=1)
    height = np.divide(rise @ target, power, out=np.zeros_like(power), where=power > 0.0)
    cost = np.sum((target - height[:, None] * rise) ** 2, axis=1)
    best = int(np.argmin(np.where(height > 0.0, cost, np.inf)))
    if height[best] <= 0.0 or np.polyfit(p, x, 1)[0] <= 0.0:
        raise IdentificationError(
            "x does not rise with the pressure",
            where="levels",
            remedy="flip the sign of the output, or choose another output",
        )
    log_a = -np.log(height[best])
    start = np.array([log_a, np.log(tried[best, 0]), log_a + tried[best].prod()])
    return np.append(start, x_mean - height[best] * shape[best].mean()) if zero else start


def _refined(start: Array, p: Array, x: Array) -> Array:
    from scipy.optimize import least_squares  # 0.3 s to import

    def residual(theta: Array) -> Array:
        return _with_zero(theta, p)[0] - x

    def jacobian(theta: Array) -> Array:
        return _with_zero(theta, p)[1]

    found = least_squares(
        residual,
        start,
        jac=jacobian,
        x_scale="jac",
        xtol=1e-15,
        ftol=1e-15,
        gtol=1e-15,
        max_nfev=500,
    )
    theta: Array = found.x
    return theta


def _standard_errors(unit_jacobian: Array, norms: Array, residual: Array) -> Array | None:
    m, k = unit_jacobian.shape
    if m <= k:
        return None
    variance = float(residual @ residual) / (m - k)
    inverse = np.linalg.pinv(unit_jacobian.T @ unit_jacobian, hermitian=True)
    errors: Array = np.sqrt(variance * np.diag(inverse)) / norms
    return errors


def _condition(jacobian: Array, x: Array) -> float:
    units = np.append(np.ones(3), np.full(jacobian.shape[1] - 3, np.ptp(x)))
    return float(np.linalg.cond(jacobian * units))


def _issues(relative: Array | None) -> tuple[Issue, ...]:
    if relative is None:
        return (
            Issue(
                "no-spare-level",
                "warning",
                "the static curve passes through every level, so its errors are not known",
                "add settled levels",
            ),
        )
    return tuple(
        Issue(
            "poorly-known",
            "warning",
            f"the levels give {name} only to ±{100 * error:.0f} %"
            if error < UNKNOWN
            else f"the levels do not give {name} at all",
            _ADVICE[name],
        )
        for name, error in zip(("a1", "b1", "c1"), relative, strict=False)
        if error > POORLY_KNOWN
    )
