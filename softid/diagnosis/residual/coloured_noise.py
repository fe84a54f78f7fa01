"""Slow noise where no rest shows it: a residual that is as steady and as normal as noise.

Between neighbouring samples only the fast part of the noise shows, and a residual that is larger
may be a misfit or slow noise. A misfit comes and goes with the motion: it is large where the
actuator is quick, and strays further than a normal number would. Noise does neither, whatever its
spectrum. A misfit also follows one wave after another; so, as means over times that are long beside
the motion, what is left must be what white noise and one that forgets itself exponentially make.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.chi_square import chi_square_tail
from softid.diagnosis.residual.structure import ResidualContext, predicted_beyond_chance
from softid.diagnosis_results import NotNoise
from softid.uncertainty.autoregression import fit_ar, run_slices, whiten

Array = npt.NDArray[np.float64]

WIDTH = 0.25
"""The shortest means are over so many time constants of the motion: a misfit lasts longer."""

WIDER = 2.0
"""Each further width is so many times the one before: the wider, the less of the white noise."""

FEWEST_MEANS = 200
"""The widest means are so many. Fewer do not tell one kind of residual from the other."""

ENOUGH = 0.8
"""So much of them is enough, for lost samples and the ends of logs take some."""

SPIKE = 6.0
"""A sample so many deviations off both neighbours is a fault of the sensor, and is left out."""

NORMAL_MEDIAN = 0.6745
"""Median of the size of a normal number, in its deviations."""

LONGEST_S, LONGEST_TIMES = 2.0, 2.0
"""Noise that forgets itself within so long, or so many time constants of the motion, is colour.
What is slower may be a drift or a creep as well."""

LARGEST_MOVING = 2.0 - 3.0**0.5
"""Largest coefficient of the moving average that means of exponentially correlated noise have."""

LAGS = 20
"""Innovations are looked at for correlations up to this lag."""

LEVEL = 1e-4
"""Noise fails the tests of whiteness and of normality about once in so many times each."""

FOLLOWS = 0.04
"""The size of the innovations follows from the motion where that predicts so large a share of its
logarithm's variance, and chance does not."""

AT_REST = 0.01
"""Speeds below this share of their mean are no more telling than it is."""

SMALLEST = 1e-4
"""The same for the squares of innovations."""

ROUNDS = 2
"""The noise and the errors of the parameters are told from each other so many times in turn."""

DISTINCT = 1e-8
"""Directions of the slopes that are weaker than this share of the strongest are rounding."""

STARTING = 3
"""Innovations at the begin of a run know too little of what was before."""


@dataclass(frozen=True)
class ColourTest:
    """Whether a residual may be slow noise.

    Attributes
    ----------
    correlation_s
        Time in which it forgets itself, if it has all marks of noise; else None.
    against
        What it does that noise does not; None where nothing does, or too little is known to tell.
    """

    correlation_s: float | None = None
    against: NotNoise | None = None


def colour_test(
    parts: Sequence[ResidualContext],
    motion_s: float,
    *,
    slopes: Sequence[Array] = (),
    rng: np.random.Generator,
) -> ColourTest:
    """Whether a residual is noise by all that it shows, and how slow that is.

    Means over equal times, from a quarter of the motion's time constant to a two hundredth of the
    logs, are made white by an autoregression. The innovations are tested for normality by Jarque
    and Bera, and for a size that follows from the speed or from the rate of the input.

    Means of white noise and of one with the covariance s² e^{−|t|/τ} obey
    r_k = φ r_{k−1} + e_k + θ e_{k−1} with φ = e^{−width/τ} and θ ≤ 2 − √3. At the largest width the
    innovations e of the best φ and θ are tested for whiteness by Ljung and Box; τ is that of the
    shortest width at which they are white.

    The parameters were found as if the noise were white, which is not the best under colour. Their
    errors are seen in the innovations, and what the slopes span is taken out of them.

    Parameters
    ----------
    parts
        Residuals with their motion and input.
    motion_s
        Time constant of the motion.
    slopes
        For each of them ∂(simulated)/∂(unknowns) at the samples whose residual is finite, shape
        (m, U); empty for what was not fitted.
    rng
        Draws the shifts that say what chance would make of the size.

    Source: Ljung and Box, *Biometrika* 65 (1978), Eq (1.4); Jarque and Bera, *International
    Statistical Review* 55 (1987), Eq (5).
    """
    length_s = sum(float(part.time_s[-1] - part.time_s[0]) for part in parts)
    period_s = float(np.median(np.concatenate([np.diff(part.time_s) for part in parts])))
    columns = slopes or [np.empty((int(np.isfinite(p.residual).sum()), 0)) for p in parts]
    longest_s = max(LONGEST_S, LONGEST_TIMES * motion_s)
    times_s: list[float] = []
    for width_s in _widths_s(length_s / FEWEST_MEANS, WIDTH * motion_s, period_s):
        both = zip(parts, columns, strict=True)
        runs = [run for part, own in both for run in _runs(part, own, width_s)]
        if sum(run.residual.size for run in runs) < ENOUGH * FEWEST_MEANS:
            return ColourTest()
        left, innovations = _separated(runs)
        if _follow_motion(innovations, runs, rng):
            return ColourTest(against=NotNoise.GROWS_WITH_SPEED)
        if _odds_of_normal(np.concatenate(innovations)) < LEVEL:
            return ColourTest(against=NotNoise.STRAYS)
        time_s, is_white = _exponential(left, width_s)
        times_s += [time_s] if is_white else []
    if not is_white:
        return ColourTest(against=NotNoise.SPECTRUM)
    return ColourTest(correlation_s=times_s[0]) if time_s <= longest_s else ColourTest()


def _widths_s(widest_s: float, short_s: float, period_s: float) -> list[float]:
    """Widths from a short one to the widest, none below a sampling interval."""
    widths_s = [max(widest_s, period_s)]
    while widths_s[-1] > max(short_s, WIDER * period_s):
        widths_s.append(widths_s[-1] / WIDER)
    return widths_s[::-1]


@dataclass(frozen=True, eq=False)
class _Run:
    """Neighbouring means of one segment.

    Attributes
    ----------
    time_s
        When each begins, shape (k,).
    residual, slopes
        Means of the residual, shape (k,), and of the slopes and of one, shape (k, U + 1).
    activity
        Logarithms of the speeds and their squares, shape (k, 4).
    """

    time_s: Array
    residual: Array
    slopes: Array
    activity: Array


def _runs(part: ResidualContext, slopes: Array, width_s: float) -> list[_Run]:
    """Means over equal times; where one holds no sample, a run ends."""
    place = ((part.time_s - part.time_s[0]) / width_s + 1e-9).astype(np.intp)
    count = int(place[-1])  # the last one is not full
    known = np.isfinite(part.residual)
    steady = ~_are_spikes(part.residual[known])
    slopes, known = slopes[steady], np.flatnonzero(known)[steady]

    def mean(values: Array, at: npt.NDArray[np.intp]) -> Array:
        total = np.bincount(at, values, minlength=count + 1)
        with np.errstate(invalid="ignore"):
            found: Array = (total / np.bincount(at, minlength=count + 1))[:count]
        return found

    speeds = [np.abs(part.v), np.abs(np.gradient(part.u, part.time_s))]
    tiny = np.finfo(float).tiny
    logs = [np.log(mean(s, place) + max(AT_REST * float(s.mean()), tiny)) for s in speeds]
    activity = np.column_stack((*logs, *(log**2 for log in logs)))
    residual = mean(part.residual[known], place[known])
    columns = [mean(column, place[known]) for column in slopes.T]
    averaged = np.column_stack((*columns, np.ones(count)))
    time_s = part.time_s[0] + width_s * np.arange(count)
    return [
        _Run(time_s[span], residual[span], averaged[span], activity[span])
        for span in run_slices(np.isfinite(residual))
        if span.stop - span.start > STARTING
    ]


def _are_spikes(residual: Array) -> npt.NDArray[np.bool_]:
    """Samples that are far off both of their neighbours."""
    if residual.size < 3:
        return np.zeros(residual.size, np.bool_)
    beside = np.concatenate((residual[1:2], residual[:-1])), np.append(residual[1:], residual[-2])
    off = residual - np.clip(residual, np.minimum(*beside), np.maximum(*beside))
    usual = residual - 0.5 * (beside[0] + beside[1])
    deviation = float(np.median(np.abs(usual))) / NORMAL_MEDIAN
    found: npt.NDArray[np.bool_] = np.abs(off) > SPIKE * deviation
    return found


def _separated(runs: Sequence[_Run]) -> tuple[list[Array], list[Array]]:
    """What is left of each run without errors of the parameters, and its innovations."""
    left = [run.residual - run.residual.mean() for run in runs]
    for _ in range(ROUNDS):
        noise = fit_ar(left)
        rows = np.concatenate([whiten(noise, run.residual) for run in runs])
        columns = np.concatenate([whiten(noise, run.slopes) for run in runs])
        size = np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
        moves = np.linalg.lstsq(columns / size, rows, rcond=DISTINCT)[0] / size
        left = [run.residual - run.slopes @ moves for run in runs]
    return left, [whiten(noise, values) for values in left]


def _exponential(left: Sequence[Array], width_s: float) -> tuple[float, bool]:
    """τ of white noise and one that forgets itself exponentially, and whether these are all."""
    phi, theta = _likeliest(left)
    odds = _odds_of_white([_innovations(values, phi, theta) for values in left])
    return float(-width_s / np.log(phi)), odds >= LEVEL


def _innovations(values: Array, phi: float, theta: float) -> Array:
    """e_k = r_k − φ r_{k−1} − θ e_{k−1}, without the first few."""
    from scipy.signal import lfilter

    found: Array = lfilter((1.0, -phi), (1.0, theta), values)[STARTING:]
    return found


def _likeliest(runs: Sequence[Array]) -> tuple[float, float]:
    """φ and θ with the least squares of innovations."""
    from scipy.optimize import least_squares

    def innovations(point: Array) -> Array:
        return np.concatenate([_innovations(run, *point.tolist()) for run in runs])

    bounds = ((1e-6, -1.0 + 1e-6), (1.0 - 1e-6, LARGEST_MOVING))
    fits = [
        least_squares(innovations, start, bounds=bounds, x_scale=0.1)
        for start in ((0.5, 0.0), (0.9, -0.5), (0.98, 0.1))
    ]
    phi, theta = min(fits, key=lambda fit: float(fit.cost)).x.tolist()
    return float(phi), float(theta)


def _odds_of_white(innovations: Sequence[Array]) -> float:
    """Chance of such correlations: n (n + 2) Σ ρ_k²/(n − k) is χ² with two degrees less."""
    n = sum(part.size for part in innovations)
    power = max(sum(float(part @ part) for part in innovations), np.finfo(float).tiny)
    statistic = 0.0
    for lag in range(1, LAGS + 1):
        product = sum(float(part[lag:] @ part[:-lag]) for part in innovations)
        statistic += (product / power) ** 2 / (n - lag)
    return chi_square_tail(n * (n + 2) * statistic, LAGS - 2)


def _odds_of_normal(values: Array) -> float:
    """Chance of such a skewness S and kurtosis K: n (S²/6 + (K − 3)²/24) is χ² with two degrees."""
    scaled = (values - values.mean()) / max(float(values.std()), np.finfo(float).tiny)
    skewness, kurtosis = float(np.mean(scaled**3)), float(np.mean(scaled**4))
    return chi_square_tail(values.size * (skewness**2 / 6.0 + (kurtosis - 3.0) ** 2 / 24.0), 2)


def _follow_motion(
    innovations: Sequence[Array], runs: Sequence[_Run], rng: np.random.Generator
) -> bool:
    """Whether the size of the innovations follows from the motion."""
    squares = np.concatenate(innovations) ** 2
    sizes = np.log(squares + max(SMALLEST * float(squares.mean()), np.finfo(float).tiny))
    share, limit = predicted_beyond_chance(
        np.concatenate([run.activity for run in runs]),
        sizes - sizes.mean(),
        [run.time_s for run in runs],
        rng=rng,
    )
    return share > max(limit, FOLLOWS)
