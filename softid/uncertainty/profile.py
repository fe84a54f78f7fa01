"""Profile likelihood of one parameter: an interval that may have no end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from softid.errors import IdentificationError, UsageError
from softid.parameters import ParameterScale
from softid.uncertainty.student import student_quantile

Point = tuple[float, float]
"""Position in the coordinate that is searched, and the excess there."""

CI_METHOD = "profile"
"""Name of this method in results."""

MAX_DOUBLINGS = 12
"""Steps double from one standard deviation: beyond 4096 of them a side is called unbounded."""

LOG_REACH = float(np.log(1e6))
"""On a logarithmic scale a side that reaches a factor of a million is called unbounded."""

LIMIT_TOLERANCE = 0.01
"""Accuracy of a limit, as an error of the square root of the cost rise over its threshold."""

MAX_REFINEMENTS = 30
"""Refits for one limit once it is bracketed; three to five are usual."""

COLLAPSED = 1e-3
"""A bracket this narrow, as a share of its distance from the optimum, holds a jump of the cost."""

MAX_JUMPS = 6
"""How often a side is followed on beyond a jump of the cost."""

STEPS_ON = (0.125, 0.06, 0.03, 0.015)
"""Steps beyond a jump that are tried, as shares of the way from the optimum to it."""

NORMAL_95 = 1.959963984540054
"""Two-sided 95 % quantile of the normal law."""


@dataclass(frozen=True)
class ProfileResult:
    """Cost of a fit against one parameter, the others refitted.

    Attributes
    ----------
    values
        Parameter values tried, ascending, in the parameter's own unit.
    cost_rise
        Rise of the cost above the optimum at each, in units in which one standard deviation
        costs 1; infinite where no fit was found.
    threshold
        Rise at the limits of the interval.
    ci95
        Limits; None on a side where the cost never rises to the threshold.
    evaluations
        Number of refits.
    better_value
        A value at which a refit undercut the optimum, which was then not the optimum; else None.
    """

    values: tuple[float, ...]
    cost_rise: tuple[float, ...]
    threshold: float
    ci95: tuple[float | None, float | None]
    evaluations: int
    better_value: float | None = None

    @property
    def unbounded_below(self) -> bool:
        """Whether the logs set no lower limit."""
        return self.ci95[0] is None

    @property
    def unbounded_above(self) -> bool:
        """Whether the logs set no upper limit."""
        return self.ci95[1] is None


def profile(
    refit: Callable[[float], float],
    value: float,
    *,
    sd: float,
    cost_per_variance: float,
    optimum_cost: float,
    scale: ParameterScale = "linear",
    lower: float = -np.inf,
    upper: float = np.inf,
    degrees_of_freedom: float = np.inf,
) -> ProfileResult:
    """Find where the refitted cost rises to the 95 % threshold on either side of the optimum.

    With S(θ) the least cost at fixed θ, the rise is [S(θ) − S(θ̂)]/c, where c is the rise that one
    standard deviation causes: c = C_θθ/(H⁻¹)_θθ, the field ``cost_per_variance`` of `Covariance`.
    For white noise c = σ²w² and this is the usual likelihood ratio; for coloured noise the same
    ratio is divided by the variance inflation of this parameter, so that the profile of a linear
    model gives the interval of the covariance exactly. Limits lie where the rise is t², with t
    Student's 97.5 % quantile.

    Each side is bracketed by steps that double from one standard deviation, then refined on the
    square root of the rise, which is nearly straight. Where the rise jumps over the threshold, the
    side is walked on from the last point before the jump, so that a refit that was led into a false
    minimum by a far start does not pass for a limit; a jump that stays is one.

    Parameters
    ----------
    refit
        Least cost Σ (w r)² with the parameter held at a value in its own unit; may return a
        number that is not finite where no fit is found, which counts as outside. It may start from
        what it found at the values before.
    value
        Optimum, in its own unit.
    sd, cost_per_variance, degrees_of_freedom
        From `Covariance`; ``sd`` in the internal coordinate, only the first step depends on it.
    optimum_cost
        Cost at the optimum.
    scale
        ``"log"`` searches over the logarithm.
    lower, upper
        Bounds of the search; a side that ends at a bound below the threshold is unbounded.

    Returns
    -------
    ProfileResult

    Raises
    ------
    UsageError
        The value lies outside the bounds, or is not positive on a logarithmic scale.
    IdentificationError
        ``sd`` or ``cost_per_variance`` is not positive.

    Notes
    -----
    D. J. Venzon and S. H. Moolgavkar, J. R. Stat. Soc. C 37 (1988) 87; A. Raue et al.,
    Bioinformatics 25 (2009) 1923, for intervals without end.

    Examples
    --------
    >>> def refit(v):
    ...     return (v - 1.0) ** 2
    >>> found = profile(refit, 1.0, sd=1.0, cost_per_variance=1.0, optimum_cost=0.0)
    >>> [round(limit, 2) for limit in found.ci95]
    [-0.96, 2.96]
    """
    _check(value, sd, cost_per_variance, scale, lower, upper)
    quantile = NORMAL_95
    if np.isfinite(degrees_of_freedom):
        quantile = student_quantile(degrees_of_freedom, 0.975)
    search = _Search(refit, scale, optimum_cost, cost_per_variance, quantile, value)
    limits = [
        search.limit(sd, -1.0, search.internal(lower)),
        search.limit(sd, 1.0, search.internal(upper)),
    ]
    points = sorted(search.points.items())
    worst = min(points, key=lambda point: point[1])
    return ProfileResult(
        values=tuple(v for v, _ in points),
        cost_rise=tuple(rise for _, rise in points),
        threshold=quantile**2,
        ci95=(limits[0], limits[1]),
        evaluations=len(points) - 1,
        better_value=worst[0] if worst[1] < -LIMIT_TOLERANCE else None,
    )


def _check(
    value: float,
    sd: float,
    cost_per_variance: float,
    scale: ParameterScale,
    lower: float,
    upper: float,
) -> None:
    if not lower <= value <= upper or (scale == "log" and value <= 0.0):
        raise UsageError(
            "a profile starts from a value within its bounds",
            value=(value, lower, upper),
            remedy="profile at the optimum, on a linear scale if it is not positive",
        )
    if not (sd > 0.0 and cost_per_variance > 0.0):
        raise IdentificationError(
            "a profile needs a positive standard deviation and cost scale",
            value=(sd, cost_per_variance),
            remedy="the parameter does not change the response; fix it",
        )


class _Search:
    """Refits of one parameter, remembered, and the search for a limit among them."""

    def __init__(
        self,
        refit: Callable[[float], float],
        scale: ParameterScale,
        optimum_cost: float,
        unit: float,
        quantile: float,
        value: float,
    ) -> None:
        self._refit = refit
        self._scale = scale
        self._optimum_cost = optimum_cost
        self._unit = unit
        self._quantile = quantile
        self._start = self.internal(value)
        self.points: dict[float, float] = {value: 0.0}

    def internal(self, value: float) -> float:
        """The coordinate that is searched."""
        if self._scale == "linear":
            return value
        return float(np.log(value)) if value > 0.0 else -np.inf

    def _end(self, bound: float, sign: float) -> float:
        """Where a side stops: at its bound, or on a logarithmic scale `LOG_REACH` away."""
        if self._scale == "linear":
            return bound
        reach = self._start + sign * LOG_REACH
        return min(bound, reach) if sign > 0.0 else max(bound, reach)

    def own(self, position: float) -> float:
        """The value in the parameter's own unit."""
        return position if self._scale == "linear" else float(np.exp(position))

    def excess(self, position: float) -> float:
        """Square root of the cost rise less its threshold."""
        value = self.own(position)
        if value not in self.points:
            rise = (self._refit(value) - self._optimum_cost) / self._unit
            self.points[value] = float(rise) if np.isfinite(rise) else np.inf
        return float(np.sqrt(max(self.points[value], 0.0))) - self._quantile

    def limit(self, sd: float, sign: float, bound: float) -> float | None:
        """Limit on one side, or None when there is none."""
        end = self._end(bound, sign)
        bracket = self._bracketed((self._start, -self._quantile), sd * self._quantile, sign, end)
        for _ in range(MAX_JUMPS):
            if bracket is None:
                return None
            position, last = self._refine(*bracket)
            step = self._step_on(last, sign, end) if last else None
            if last is None or step is None:
                return self.own(position)
            bracket = self._bracketed(last, step, sign, end)
        return None if bracket is None else self.own(self._refine(*bracket)[0])

    def _bracketed(
        self, inside: Point, step: float, sign: float, end: float
    ) -> tuple[Point, Point] | None:
        """Points next to the limit on either side; None where the side ends below the threshold."""
        first = inside[0]
        for _ in range(MAX_DOUBLINGS + 1):
            trial = first + sign * step
            stopped = sign * (trial - end) >= 0.0
            trial = end if stopped else trial
            if trial == first:
                return None
            at_trial = self.excess(trial)
            if at_trial >= 0.0:
                return inside, (trial, at_trial)
            if stopped:
                return None
            inside, step = (trial, at_trial), 2.0 * step
        return None

    def _step_on(self, last: Point, sign: float, end: float) -> float | None:
        """A step from the last point before a jump that stays below the threshold, if any does."""
        for share in STEPS_ON:
            step = share * abs(last[0] - self._start)
            trial = last[0] + sign * step
            if sign * (trial - end) < 0.0 and self.excess(trial) < 0.0:
                return step
        return None

    def _refine(self, inside: Point, outside: Point) -> tuple[float, Point | None]:
        """Root between two points by the Illinois rule, by halving while one side is infinite.

        With it comes the last point before a jump, where there is no root but a jump.
        """
        close = LIMIT_TOLERANCE * self._quantile
        (near, low), (far, high) = inside, outside
        if high <= close:
            return far, None
        last = 0
        for _ in range(MAX_REFINEMENTS):
            if abs(far - near) <= COLLAPSED * abs(far - self._start):
                break
            share = -low / (high - low) if np.isfinite(high) else 0.5
            trial = near + share * (far - near)
            found = self.excess(trial)
            if abs(found) <= close:
                return trial, None
            if found < 0.0:
                near, low = trial, found
                high = high / 2.0 if last < 0 else high
                last = -1
            else:
                far, high = trial, found
                low = low / 2.0 if last > 0 else low
                last = 1
        return far, (near, self.excess(near))
