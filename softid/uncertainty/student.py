"""Quantiles of Student's t distribution, without the 0.15 s that importing scipy.special takes."""

from __future__ import annotations

from functools import lru_cache
from math import erfc, exp, isnan, lgamma, log, log1p, nan, pi, sqrt

from softid.uncertainty.incomplete_beta import incomplete_beta

COVERAGE = 0.95
"""Probability that an interval covers the truth."""

MANY = 16.0
"""Degrees of freedom, in units of 1 or the squared normal quantile, beyond which five terms of the
expansion in 1/ν are exact to 1e-10; Abramowitz and Stegun, 26.7.5, and the term behind theirs."""

EXPANSION_FROM = 4.0
"""Degrees of freedom beyond which the expansion in 1/ν is a start within a few per cent."""

EXPANSION = (
    (4.0, (1.0, 1.0)),
    (96.0, (5.0, 16.0, 3.0)),
    (384.0, (3.0, 19.0, 17.0, -15.0)),
    (92160.0, (79.0, 776.0, 1482.0, -1920.0, -945.0)),
    (368640.0, (27.0, 339.0, 930.0, -1782.0, -765.0, 17955.0)),
)
"""Divisor and coefficients of the odd powers of the normal quantile, highest first."""

_MOST_STEPS = 200
_PRECISION = 1e-15
_CLOSE = 1e-7
"""Relative step after which Newton's method is exact to 1e-13, for its error is squared."""


@lru_cache(maxsize=256)
def student_quantile(freedom: float, probability: float) -> float:
    """The value that Student's t stays below with a given probability.

    Newton's method on P(T > t) = ½ I_x(ν/2, ½), x = ν/(ν + t²), which falls and is convex for
    t > 0, so that a start at the normal quantile, always too small, leads there from one side. So
    does the expansion in 1/ν, from which two or three steps are left.

    Parameters
    ----------
    freedom
        Degrees of freedom ν > 0.
    probability
        Between ½ and 1.

    Examples
    --------
    >>> round(student_quantile(1.0, 0.975), 6)
    12.706205
    """
    t = z = _normal_quantile(probability)
    if isnan(freedom):
        return nan
    if freedom > EXPANSION_FROM:
        for order, (divisor, powers) in enumerate(EXPANSION, 1):
            odd = sum(c * z ** (2 * k + 1) for k, c in enumerate(reversed(powers)))
            t += odd / divisor / freedom**order
    if freedom > MANY * max(1.0, z * z):
        return t
    scale = lgamma(0.5 * (freedom + 1.0)) - lgamma(0.5 * freedom) - 0.5 * log(pi * freedom)
    for _ in range(_MOST_STEPS if probability > 0.5 else 0):
        density = exp(scale - 0.5 * (freedom + 1.0) * log1p(t * t / freedom))
        step = (_upper_tail(t, freedom) - (1.0 - probability)) / density
        t += step
        if abs(step) <= _CLOSE * abs(t):
            break
    return t


@lru_cache(maxsize=64)
def _normal_quantile(probability: float) -> float:
    """Newton's method from zero, which likewise comes from one side."""
    z = 0.0
    for _ in range(_MOST_STEPS):
        tail = 0.5 * erfc(z / sqrt(2.0)) - (1.0 - probability)
        step = tail * sqrt(2.0 * pi) * exp(0.5 * z * z)
        z += step
        if abs(step) <= _PRECISION * 10.0 * abs(z):
            break
    return z


def _upper_tail(t: float, freedom: float) -> float:
    """P(T > t) for t ≥ 0."""
    squared = t * t
    rest = squared / (freedom + squared)
    return 0.5 * incomplete_beta(0.5 * freedom, 0.5, freedom / (freedom + squared), rest)
