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
from softid.diagnosis.residual.single_spikes import spikes_in
from softid.diagnosis.residual.structure import ResidualContext, predicted_beyond_chance
from softid.diagnosis_results import NotNoise
from softid.even_times import even_interval_s
from softid.residuals import ljung_box
from softid.uncertainty.autoregression import fit_ar, run_slices, whiten

Array = npt.NDArray[np.float64]

SHORTEST_MEANS = 0.25
"""The shortest means are over so many time constants of the motion, or just below twice as many: a
misfit lasts longer."""

WIDER = 2.0
"""Each width is at least so many times the one before: a mean of more samples holds less of the
white noise."""

FEWEST_MEANS = 200
"""The widest means are so many. Fewer do not tell one kind of residual from the other."""

LEAST_SHARE_OF_MEANS = 0.8
"""Share of `FEWEST_MEANS` that is enough, for lost samples and the ends of logs take some."""

LONGEST_S, LONGEST_TIMES = 2.0, 2.0
"""Noise with a correlation time up to this, or so many time constants of the motion, is colour.
What is slower may be a drift or a creep as well."""

LARGEST_THETA = 2.0 - 3.0**0.5
"""Largest coefficient of the moving average that means of exponentially correlated noise have."""

LARGEST_LAG = 20
"""Innovations are looked at for correlations up to this lag."""

NOT_WHITE = 1e-4
"""Innovations of less likely correlations are those of a misfit."""

REMEMBERED = 1e-3
"""Means are predicted by those before them where white ones would seem to be in fewer cases. The
p-value is that of two coefficients; white noise tells only their sum, so it is a little too
small."""

NOT_NORMAL = 1e-6
"""Innovations of a less likely skewness and kurtosis are those of a misfit. The p-value is that of
many samples: one draw in 1300 of two hundred normal numbers lies beyond this, one in 10,000 of
eight hundred."""

FOLLOWS = 0.04
"""The size of the innovations follows from the motion where that predicts so large a share of its
logarithm's variance, and chance does not."""

CHANCE_SHARE = 16.0
"""The share that chance predicts in one of 10,000 logs, times the number of innovations: what is
looked at for several widths, in every log, must be so rare."""

AT_REST = 0.01
"""Speeds below this share of their mean are no more telling than it is."""

LEAST_SQUARE = 1e-4
"""Squares of innovations below this share of their mean are no more telling than it is."""

NOISE_ROUNDS = 2
"""The noise and the errors of the parameters are fitted in turn so many times."""

LEAST_SINGULAR = 1e-8
"""Directions of the slopes that are weaker than this share of the strongest are rounding."""

OF_ITS_OWN = 20
"""A segment with so many innovations has a size of its own: its error, a sixth, makes an excess
kurtosis of 0.1 at most. Of fewer the size is that of all."""

STARTING = 3
"""Innovations at the beginning of a run know too little of what was before."""


@dataclass(frozen=True)
class ColourTest:
    """Whether a residual may be slow noise.

    Attributes
    ----------
    correlation_s
        Its correlation time, if it has all marks of noise; else None.
    against
        What it does that noise does not; None where nothing does, or too little is known to tell.
    is_brief
        Whether it has that time, and no means over a quarter of the motion's time constant or more
        remember those before them: a misfit is not forgotten so soon.
    """

    correlation_s: float | None = None
    against: NotNoise | None = None
    is_brief: bool = False


def colour_test(
    parts: Sequence[ResidualContext],
    motion_s: float,
    *,
    slopes: Sequence[Array] = (),
    rng: np.random.Generator,
) -> ColourTest:
    """Whether a residual is noise by all that it shows, and how slow that is.

    Means over equal times, from a quarter of the motion's time constant to 1/200 of the logs'
    length, or as long as lost samples leave enough of them, are made white by an autoregression.
    The innovations are tested for normality by Jarque and Bera, and for a size that follows from
    the speed or from the rate of the input, in units of their deviation in each segment: one log
    may be louder than another.

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
        Time constant of the motion, in s.
    slopes
        For each of them ∂(simulated)/∂(unknowns) at the m samples whose residual is finite, in the
        residual's unit per unknown, shape (m, U); empty for what was not fitted.
    rng
        Draws the shifts that say what chance would make of the size.

    Returns
    -------
    ColourTest
        With neither a time nor a mark where there are too few samples, or where what is left is
        slower than colour.

    Source: Ljung and Box, *Biometrika* 65 (1978), Eq (1.4); Jarque and Bera, *International
    Statistical Review* 55 (1987), Eq (5).
    """
    length_s = sum(float(part.time_s[-1] - part.time_s[0]) for part in parts)
    period_s = even_interval_s(*(part.time_s for part in parts))
    columns = slopes or [np.empty((int(np.isfinite(p.residual).sum()), 0)) for p in parts]
    activities = _activities(parts)
    times_s: list[float] = []
    is_white, is_brief, widest = False, True, 0
    most, few = length_s / FEWEST_MEANS / period_s, SHORTEST_MEANS * motion_s / period_s
    for count in _samples_a_mean(most, few):
        width_s = count * period_s
        given = enumerate(zip(parts, columns, activities, strict=True))
        runs = [run for part, each in given for run in _runs(*each, width_s, part=part)]
        if sum(run.residual.size for run in runs) < LEAST_SHARE_OF_MEANS * FEWEST_MEANS:
            if widest < few:
                return ColourTest()
            break
        widest = count
        left, innovations = _separated(runs)
        if _follow_motion(innovations, runs, rng):
            return ColourTest(against=NotNoise.GROWS_WITH_SPEED)
        if _p_of_normal(np.concatenate(innovations)) < NOT_NORMAL:
            return ColourTest(against=NotNoise.STRAYS)
        time_s, is_white, remember = _exponential(left, width_s)
        times_s += [time_s] if is_white else []
        is_brief = is_brief and not (remember and count >= few)
    if not is_white:
        return ColourTest(against=NotNoise.SPECTRUM)
    is_slow = max(times_s[0], times_s[-1]) > max(LONGEST_S, LONGEST_TIMES * motion_s)
    return ColourTest() if is_slow else ColourTest(times_s[0], is_brief=is_brief)


def _samples_a_mean(most: float, few: float) -> list[int]:
    """Samples in each mean of every width, from few to the most.

    They are whole, for means over unlike numbers of samples have unlike variances.
    """
    counts = [max(round(most), 1)]
    while counts[-1] > max(few, 1.0):
        counts.append(int(counts[-1] / WIDER))
    return counts[::-1]


def _activities(parts: Sequence[ResidualContext]) -> list[Array]:
    """Speed and rate of the input at every sample, no smaller than a share of their mean."""
    pairs = [
        np.column_stack((np.abs(part.v), np.abs(np.gradient(part.u, part.time_s))))
        for part in parts
    ]
    least = AT_REST * np.concatenate(pairs).mean(axis=0)
    return [pair + np.maximum(least, np.finfo(float).tiny) for pair in pairs]


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
        Logarithms of the speeds, and their squares, shape (k, 4).
    part
        Position of the segment.
    """

    time_s: Array
    residual: Array
    slopes: Array
    activity: Array
    part: int = 0


def _runs(
    context: ResidualContext, slopes: Array, activity: Array, width_s: float, *, part: int = 0
) -> list[_Run]:
    """Means over equal times; where one holds no sample, a run ends."""
    place = ((context.time_s - context.time_s[0]) / width_s + 1e-6).astype(np.intp)
    count = int(place[-1])  # the last one is not full
    known = np.flatnonzero(np.isfinite(context.residual))
    steady = ~spikes_in(context.residual[known])
    slopes, known = slopes[steady], known[steady]

    def mean(values: Array, at: npt.NDArray[np.intp]) -> Array:
        total = np.bincount(at, values, minlength=count + 1)
        with np.errstate(invalid="ignore"):
            found: Array = (total / np.bincount(at, minlength=count + 1))[:count]
        return found

    residual = mean(context.residual[known], place[known])
    columns = [mean(column, place[known]) for column in slopes.T]
    averaged = np.column_stack((*columns, np.ones(count)))
    logs = [np.log(mean(column, place)) for column in activity.T]
    powers = np.column_stack((*logs, *(log**2 for log in logs)))
    time_s = context.time_s[0] + width_s * np.arange(count)
    return [
        _Run(time_s[span], residual[span], averaged[span], powers[span], part)
        for span in run_slices(np.isfinite(residual))
        if span.stop - span.start > STARTING
    ]


def _separated(runs: Sequence[_Run]) -> tuple[list[Array], list[Array]]:
    """What is left of each run without errors of the parameters, and its innovations.

    Both in units of the innovations' deviation in their segment.
    """
    left, sizes = [run.residual - run.residual.mean() for run in runs], [1.0] * len(runs)
    for _ in range(NOISE_ROUNDS):
        noise = fit_ar([values / size for values, size in zip(left, sizes, strict=True)])
        sized = list(zip(runs, sizes, strict=True))
        rows = np.concatenate([whiten(noise, run.residual / size) for run, size in sized])
        columns = np.concatenate([whiten(noise, run.slopes / size) for run, size in sized])
        norms = np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
        moves = np.linalg.lstsq(columns / norms, rows, rcond=LEAST_SINGULAR)[0] / norms
        left = [run.residual - run.slopes @ moves for run in runs]
        sizes = _sizes([whiten(noise, values) for values in left], [run.part for run in runs])
    left = [values / size for values, size in zip(left, sizes, strict=True)]
    return left, [whiten(noise, values) for values in left]


def _sizes(innovations: Sequence[Array], parts: Sequence[int]) -> list[float]:
    """Deviation of the innovations in the segment of each run.

    A plain one: the pooled kurtosis is then the mean of those within the segments, so that what
    strays in one of them does so in all; a median would be less sure, and zero where the reading is
    coarse.
    """
    whole = float(np.concatenate(innovations).std())
    found = {}
    for part in set(parts):
        own = np.concatenate([e for e, k in zip(innovations, parts, strict=True) if k == part])
        found[part] = float(own.std()) if own.size >= OF_ITS_OWN else whole
    return [
        found[part] if found[part] > 0.0 else max(whole, float(np.finfo(float).tiny))
        for part in parts
    ]


def _exponential(left: Sequence[Array], width_s: float) -> tuple[float, bool, bool]:
    """τ of white noise and one that forgets itself exponentially, whether these are all, and more.

    The last is whether means remember those before them. Where they do not, φ and −θ are anything
    alike: the noise forgets itself within a width.
    """
    phi, theta = _likeliest(left)
    innovations = [_innovations(values, phi, theta) for values in left]
    time_s = float(-width_s / np.log(phi))
    remember = _remember(left, innovations)
    if not remember:
        time_s = min(time_s, width_s)
    return time_s, _p_of_white(innovations) >= NOT_WHITE, remember


def _remember(left: Sequence[Array], innovations: Sequence[Array]) -> bool:
    """Whether values are predicted by those before them, by the ratio of the likelihoods."""
    white = sum(float(values[STARTING:] @ values[STARTING:]) for values in left)
    known = sum(float(values @ values) for values in innovations)
    count = sum(values.size for values in innovations)
    ratio = count * float(np.log(white / max(known, np.finfo(float).tiny)))
    return chi_square_tail(max(ratio, 0.0), 2) < REMEMBERED


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

    bounds = ((1e-6, -1.0 + 1e-6), (1.0 - 1e-6, LARGEST_THETA))
    fits = [
        least_squares(innovations, start, bounds=bounds, x_scale=0.1)
        for start in ((0.5, 0.0), (0.9, -0.5), (0.98, 0.1))
    ]
    phi, theta = min(fits, key=lambda fit: float(fit.cost)).x.tolist()
    return float(phi), float(theta)


def _p_of_white(innovations: Sequence[Array]) -> float:
    """Chance of such correlations within the runs; two coefficients were fitted."""
    apart = np.full(LARGEST_LAG, np.nan)
    joined = np.concatenate([piece for part in innovations for piece in (part, apart)])
    return ljung_box(joined, LARGEST_LAG, fitted_parameters=2).p_value


def _p_of_normal(values: Array) -> float:
    """Chance of such a skewness S and kurtosis K: n (S²/6 + (K − 3)²/24) is χ² with two degrees."""
    scaled = (values - values.mean()) / max(float(values.std()), np.finfo(float).tiny)
    skewness, kurtosis = float(np.mean(scaled**3)), float(np.mean(scaled**4))
    return chi_square_tail(values.size * (skewness**2 / 6.0 + (kurtosis - 3.0) ** 2 / 24.0), 2)


def _follow_motion(
    innovations: Sequence[Array], runs: Sequence[_Run], rng: np.random.Generator
) -> bool:
    """Whether the size of the innovations follows from the motion."""
    squares = np.concatenate(innovations) ** 2
    sizes = np.log(squares + max(LEAST_SQUARE * float(squares.mean()), np.finfo(float).tiny))
    share, limit = predicted_beyond_chance(
        np.concatenate([run.activity for run in runs]),
        sizes - sizes.mean(),
        [run.time_s for run in runs],
        rng=rng,
    )
    return share > max(limit, FOLLOWS, CHANCE_SHARE / squares.size)
