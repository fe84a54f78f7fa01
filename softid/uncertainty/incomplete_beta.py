"""The regularised incomplete beta function, and the tail of R² that follows from it.

Without the 0.15 s that importing scipy.special takes.
"""

from __future__ import annotations

from math import exp, lgamma, log

_MOST_TERMS = 5000
"""A fraction takes about the root of its larger argument, so this is enough for 10⁷ samples."""

_TINY = 1e-300
"""Stands for zero where it is divided by: close to the smallest number there is."""

_PRECISION = 1e-15
"""Relative change that ends the fraction: a few roundings of a double."""


def r_squared_tail(r_squared: float, unknowns: int, freedom: int) -> float:
    """P(R² > r) where an output is white noise and a model linear in its unknowns.

    R² has the beta distribution of K/2 and ν/2; this is the F test of R²/K : (1 − R²)/ν.

    Parameters
    ----------
    r_squared
        Share of the variance about the mean that is explained.
    unknowns
        K ≥ 1, without the mean.
    freedom
        ν, samples less all unknowns and means; with none left any R² is reached by chance.

    Examples
    --------
    >>> round(r_squared_tail(0.5, 2, 2), 6)
    0.5
    """
    if freedom < 1 or not r_squared > 0.0:
        return 1.0
    left = max(1.0 - r_squared, 0.0)
    return incomplete_beta(0.5 * freedom, 0.5 * unknowns, left, r_squared)


def incomplete_beta(a: float, b: float, x: float, rest: float) -> float:
    """Regularised incomplete beta function I_x(a, b).

    Parameters
    ----------
    a, b
        Above zero.
    x, rest
        Its place from 0 to 1, and 1 − x, which may be exact where that is not.

    Examples
    --------
    >>> round(incomplete_beta(1.0, 3.0, 0.5, 0.5), 6)
    0.875
    """
    if x < (a + 1.0) / (a + b + 2.0):
        return _by_fraction(a, b, x, rest)
    return 1.0 - _by_fraction(b, a, rest, x)


def _by_fraction(a: float, b: float, x: float, rest: float) -> float:
    """By Lentz's continued fraction, DLMF 8.17.22, fast for x < (a + 1)/(a + b + 2)."""
    if x <= 0.0:
        return 0.0
    front = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log(rest)) / a
    c, d = 1.0, 1.0 / _off_zero(1.0 - (a + b) * x / (a + 1.0))
    fraction = d
    for m in range(1, _MOST_TERMS):
        even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        change = 1.0
        for term in (even, odd):
            d = 1.0 / _off_zero(1.0 + term * d)
            c = _off_zero(1.0 + term / c)
            change = c * d
            fraction *= change
        if abs(change - 1.0) < _PRECISION:
            break
    return front * fraction


def _off_zero(value: float) -> float:
    return value if abs(value) > _TINY else _TINY
