"""Readings that were not taken when their time stamps say.

A sensor with a clock of its own is read now and then before it has a new value, and a computer that
is busy stamps a reading late. What a right model leaves of such a log is the speed times an
unknown time: it grows with the speed, and follows from nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.diagnosis.residual.structure import ResidualContext

Array = npt.NDArray[np.float64]

CLEARLY = 60.0
"""Twice the logarithm of the likelihood that two variances must gain on one. White normal noise
exceeds 15 once in 10,000 logs; noise with outliers, or of few independent samples, exceeds more."""

CLEARER = 20.0
"""The same for noise that grows with the speed, over noise that grows with the reading."""

LEAST_SHARE = 0.5
"""Share of the mean square that uncertain times must make, or it is a detail of the noise."""

MOST_PERIODS = 3.0
"""Uncertain times are less than so many sampling intervals: beyond, whole readings would be
exchanged."""

ROUNDS = 60
"""Reweighted rounds of the two variances, of which each takes a tenth of the way or more."""

SAME = 1e-3
"""Squares of speeds that differ by a smaller share of their mean are all the same."""

FLOOR = 1e-6
"""Share of the mean square below which neither variance is told from nothing."""


@dataclass(frozen=True)
class UncertainTimes:
    """How far readings are off their time stamps, if that is why their noise grows.

    Attributes
    ----------
    sd_s
        Standard deviation of the times.
    share
        Of the mean square that is left, what they make.
    still, moving
        Standard deviation of what is left where nothing moves, and where it is as fast as in the
        fastest tenth.
    """

    sd_s: float
    share: float
    still: float
    moving: float


def uncertain_times(parts: Sequence[ResidualContext], period_s: float) -> UncertainTimes | None:
    """How far readings are off their time stamps; None where that is not what the noise shows.

    Parameters
    ----------
    parts
        What a model leaves that leaves no more than noise.
    period_s
        Median sampling interval.
    """
    residual, speed, place = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("residual", "v", "x")
    )
    kept = np.isfinite(residual) & np.isfinite(speed) & np.isfinite(place)
    squares, fast = residual[kept] ** 2, speed[kept] ** 2
    if squares.size == 0 or not (squares.mean() > 0.0 and fast.mean() > 0.0):
        return None
    alone = _deviance(squares, np.full(squares.size, squares.mean()))
    still, per_speed, of_speed = _two_variances(squares, fast)
    *_, of_reading = _two_variances(squares, (place[kept] - place[kept].min()) ** 2)
    share = per_speed * float(fast.mean()) / float(squares.mean())
    sd_s = per_speed**0.5
    if alone - of_speed < CLEARLY or of_reading - of_speed < CLEARER:
        return None
    if share < LEAST_SHARE or sd_s > MOST_PERIODS * period_s:
        return None
    moving = still + per_speed * float(np.quantile(fast, 0.9))
    return UncertainTimes(sd_s, min(share, 1.0), still**0.5, moving**0.5)


def _two_variances(squares: Array, grows: Array) -> tuple[float, float, float]:
    """Variances a, b ≥ 0 of normal noise of a + b g, by reweighted least squares, and the deviance.

    Squares of such noise have the mean a + b g, and a standard deviation in proportion to it.
    """
    mean, size = float(squares.mean()), float(grows.mean())
    if not np.ptp(grows) > SAME * size:  # a ramp has one speed, and tells nothing
        return mean, 0.0, _deviance(squares, np.full(squares.size, mean))
    a, b = 0.5 * mean, 0.5 * mean / size
    for _ in range(ROUNDS):
        weight = (a + b * grows) ** -2
        matrix = np.array(
            [
                [weight.sum(), weight @ grows],
                [weight @ grows, weight @ grows**2],
            ]
        )
        found_a, found_b = np.linalg.solve(matrix, [weight @ squares, weight @ (grows * squares)])
        a = max(0.5 * (a + float(found_a)), FLOOR * mean)
        b = max(0.5 * (b + float(found_b)), FLOOR * mean / size)
    return a, b, _deviance(squares, a + b * grows)


def _deviance(squares: Array, variance: Array) -> float:
    """Minus twice the logarithm of the likelihood of normal noise, but for a constant."""
    return float(np.sum(np.log(variance) + squares / variance))
