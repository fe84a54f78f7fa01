"""Slow wander: a zero that moves while nothing drives it, or from one equal cycle to the next.

What the motion brings is the same in every piece of a rest and in every whole cycle of an input
that repeats. What still differs slowly from block to block comes from elsewhere: temperature, the
supply, a mount that settles, the sensor. A slope, every relaxation and what follows the block's
mean input are taken out first, for drift, warm-up and creep bring those.

The null is noise that forgets itself within `LIMIT_S`. The block means of such noise have a known
covariance, and the p-value of the statistic follows from it without a model fitted to the residual.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.diagnosis.residual.repeats import Run, cycling_runs, resting_runs
from softid.diagnosis.residual.structure import ResidualContext
from softid.errors import Issue

Array = npt.NDArray[np.float64]

CODE = "slow-wander"
"""Code of the remark on a slow wander."""

LIMIT_S = 2.0
"""Noise with a correlation time up to this is colour; blocks are so long."""

LIMIT_TIMES = 2.0
"""Longest correlation time of colour in time constants of the motion, where that is longer than
`LIMIT_S`."""

SLOWER = 3.0
"""A wander is so many times slower than the limit at least: 6 s or more."""

SOUGHT = 10.0
"""The statistic looks best for a wander so many times slower than the limit."""

WANDER_CHANCE = 0.01
"""Noise at the limit is taken for a wander in one of so many logs; faster noise hardly ever."""

TRIED_TIMES = 16
"""Times of the wander among which the likeliest is taken."""

COLOUR_SHARES = (0.0, 0.03, 0.1, 0.3, 0.6)
"""Shares of colour beside the wander among which the likeliest is taken."""

FEWEST_FREE = 5
"""Blocks that remain when slopes and relaxations are taken out."""

RELAXATIONS_APART = 4.0
"""Relaxations are taken out on a grid of times, each so many times longer than the one before:
what lies between two of them is made of both to a hundredth."""

LEAST_SHARE = 0.1
"""Share of the power of what is left that is slow: less is not worth a word."""

LEAST_IRREGULAR = 0.05
"""Share of the slow power that no slope and no relaxation takes away: less is a relaxation with
some other law."""

EXCURSION = 0.75
"""One excursion holds so much of the slow power."""

EXCURSION_BLOCKS = 0.25
"""Largest share of the blocks, in a row, that one excursion takes."""

TENS_S = 15.0
"""Time in s from which on a wander is called one of tens of seconds."""

MINUTES_S = 90.0
"""Time in s from which on a wander is called one of minutes."""

LEAST_SEEN = 0.5
"""Share of a block that was measured at least where it counts."""


@dataclass(frozen=True)
class SlowNoise:
    """How the zero of a residual moves slowly.

    Attributes
    ----------
    rms
        Root mean square of the slow part about the mean of each run, in the residual's unit.
    share
        Its share of the power of the residual.
    time_s
        Its correlation time.
    at_s
        Middle of the one excursion that holds most of it; None where there is no such.
    at_rest
        Whether it was seen while the input rests; otherwise from cycle to cycle.
    """

    rms: float
    share: float
    time_s: float
    at_s: float | None
    at_rest: bool


def slow_noise_in(parts: Sequence[ResidualContext], motion_s: float) -> SlowNoise | None:
    """Slow wander in the rests of a residual or, where the logs have none, in equal cycles.

    With block means m, contrasts y = Qᵀm that slopes and relaxations leave nothing in, and
    S(τ) = Qᵀ C(τ) Q for the covariance C of block means of e^{−|t|/τ}, the statistic is
    yᵀ S(τ₀)⁻¹ y / yᵀ (S(τ₀) + S(τ₁))⁻¹ y for the limit τ₀ and the τ₁ that is sought.

    Parameters
    ----------
    parts
        Residuals with their input.
    motion_s
        Time constant of the motion.

    Returns
    -------
    SlowNoise or None
        None also where there is neither a long rest nor enough equal cycles.

    Source: point-optimal invariant tests of a covariance, King, *Sankhyā A* 42 (1980).
    """
    limit_s = max(LIMIT_S, LIMIT_TIMES * motion_s)
    for find, at_rest in ((resting_runs, True), (cycling_runs, False)):
        rows = [_averaged(parts[run.part], run) for run in find(parts, motion_s, limit_s)]
        series = [s for s in rows if s.contrasts.shape[1]]
        if sum(s.contrasts.shape[1] for s in series) >= FEWEST_FREE:
            return _judged(parts, series, limit_s, at_rest=at_rest)
    return None


def slow_noise_issues(
    parts: Sequence[ResidualContext], motion_s: float, *, channel: str, unit: str, factor: float
) -> tuple[Issue, ...]:
    """The wander as a remark for the user; none where there is no wander.

    Parameters
    ----------
    parts, motion_s
        As in `slow_noise_in`.
    channel, unit, factor
        Name of the output, the unit in which people know it, and the factor to that unit.
    """
    found = slow_noise_in(parts, motion_s)
    if found is None:
        return ()
    when = (
        "also while the input rests" if found.at_rest else "from cycle to cycle of an equal input"
    )
    place = "" if found.at_s is None else f", most of it near {found.at_s:.3g} s"
    return (
        Issue(
            CODE,
            "warning",
            f"what is left of {channel} moves slowly {when}, so that the motion does not bring it: "
            f"{factor * found.rms:.2g} {unit} rms over {_told(found.time_s)}, "
            f"{found.share:.0%} of its power{place}",
            "let the sensor and the supply warm up, look at the mount, and record a rest of some "
            "minutes with the temperature",
        ),
    )


def _told(time_s: float) -> str:
    """A time that a rest of a few such times tells no better than to a factor of three."""
    if time_s < TENS_S:
        return "about ten seconds"
    return "tens of seconds" if time_s < MINUTES_S else "minutes"


@dataclass(frozen=True, eq=False)
class _Series:
    """Block means of one run: their ends, values, and contrasts free of what laws bring."""

    begins_s: Array
    ends_s: Array
    means: Array
    contrasts: Array

    @property
    def about_mean(self) -> Array:
        centred: Array = self.means - self.means.mean()
        return centred


def _averaged(part: ResidualContext, run: Run) -> _Series:
    known = np.isfinite(part.residual)
    times, values = part.time_s[known], part.residual[known]
    begins_s, ends_s = run.edges_s[:-1], run.edges_s[1:]
    count = np.diff(np.searchsorted(times, run.edges_s))
    expected = np.diff(np.searchsorted(part.time_s, run.edges_s))
    seen = count >= np.maximum(LEAST_SEEN * expected, 1)
    if not seen.any():
        return _Series(begins_s[seen], ends_s[seen], np.empty(0), np.empty((0, 0)))
    means = _means(times, values, run.edges_s)[seen]
    inputs = _means(part.time_s, part.u, run.edges_s)[seen]
    begins_s, ends_s = begins_s[seen], ends_s[seen]
    laws = _laws(begins_s, ends_s, inputs)
    basis, sizes, _ = np.linalg.svd(laws)
    rank = int(np.sum(sizes > 1e-9 * sizes[0]))
    return _Series(begins_s, ends_s, means, basis[:, rank:])


def _means(time_s: Array, values: Array, edges_s: Array) -> Array:
    """Mean over time between neighbouring edges of what is straight between the samples."""
    between = np.union1d(time_s, edges_s)
    path = np.interp(between, time_s, values)
    area = np.concatenate(([0.0], np.cumsum(0.5 * (path[1:] + path[:-1]) * np.diff(between))))
    found: Array = np.diff(np.interp(edges_s, between, area)) / np.diff(edges_s)
    return found


def _laws(begins_s: Array, ends_s: Array, inputs: Array) -> Array:
    """Columns of what laws of motion and of sensors may bring to the blocks of a run."""
    middle_s = 0.5 * (begins_s + ends_s) - begins_s[0]
    length_s = float(ends_s[-1] - begins_s[0])
    columns = [np.ones_like(middle_s), middle_s / length_s]
    time_s = float(np.median(ends_s - begins_s))
    while time_s < 0.5 * length_s:
        columns.append(np.exp(-middle_s / time_s))
        time_s *= RELAXATIONS_APART
    spread = float(np.ptp(inputs))
    if spread > 0.0:
        columns.append((inputs - inputs.mean()) / spread)
    return np.column_stack(columns)


def _judged(
    parts: Sequence[ResidualContext], series: Sequence[_Series], limit_s: float, *, at_rest: bool
) -> SlowNoise | None:
    y = np.concatenate([s.contrasts.T @ s.means for s in series])
    slow = np.concatenate([s.about_mean for s in series])
    power = float(np.mean(slow**2))
    residual = np.concatenate([part.residual for part in parts])
    whole = float(np.nanmean(residual**2))
    if power < LEAST_SHARE * whole or float(y @ y) < LEAST_IRREGULAR * float(slow @ slow):
        return None
    colour = _covariance(series, limit_s)
    if _p_value(y, colour, colour + _covariance(series, SOUGHT * limit_s)) > WANDER_CHANCE:
        return None
    time_s = _likeliest_s(y, series, limit_s)
    if time_s < SLOWER * limit_s:
        return None
    return SlowNoise(power**0.5, min(power / whole, 1.0), time_s, _excursion_s(series), at_rest)


def _covariance(series: Sequence[_Series], time_s: float) -> Array:
    """That of the contrasts of all runs for a correlation time; no run knows of another."""
    sizes = [s.contrasts.shape[1] for s in series]
    found = np.zeros((sum(sizes), sum(sizes)))
    at = 0
    for s, size in zip(series, sizes, strict=True):
        own = s.contrasts.T @ covariance_of_means(s.begins_s, s.ends_s, time_s) @ s.contrasts
        found[at : at + size, at : at + size] = own
        at += size
    return found


def covariance_of_means(begins_s: Array, ends_s: Array, time_s: float) -> Array:
    """Covariance of the means over blocks of a signal with the covariance e^{−|t|/τ}.

    For blocks of lengths a and b with a gap g, in units of τ, it is
    e^{−g} (1 − e^{−a})(1 − e^{−b})/(a b), and 2 (a − 1 + e^{−a})/a² within one block.

    Parameters
    ----------
    begins_s, ends_s
        Ends of the blocks in order, none over another, shape (n,).
    time_s
        Correlation time τ.

    Examples
    --------
    >>> covariance_of_means(np.array([0.0]), np.array([1e-6]), 1.0).round(3).tolist()
    [[1.0]]
    """
    length = (ends_s - begins_s) / time_s
    held = -np.expm1(-length) / length
    gap = np.maximum(begins_s[:, None] - ends_s, begins_s - ends_s[:, None]) / time_s
    found: Array = np.exp(-np.maximum(gap, 0.0)) * np.outer(held, held)
    short = 1.0 - length / 3.0  # the closed form loses its digits there
    closed = 2.0 * (length + np.expm1(-length)) / np.maximum(length, 1e-3) ** 2
    np.fill_diagonal(found, np.where(length < 1e-3, short, closed))
    return found


def _p_value(y: Array, limit: Array, sought: Array) -> float:
    """Chance that noise at the limit speaks as much for the wander as the contrasts do."""
    from scipy.linalg import eigh

    ratio = float(y @ np.linalg.solve(limit, y)) / float(y @ np.linalg.solve(sought, y))
    return chance_of_positive(1.0 - ratio * eigh(limit, sought, eigvals_only=True))


def chance_of_positive(weights: Array) -> float:
    """Chance that a weighted sum of squares of independent normal numbers is positive.

    P = ½ + π⁻¹ ∫₀^∞ sin(½ Σ arctan(wᵢ u)) / (u Π (1 + wᵢ² u²)^¼) du.

    Parameters
    ----------
    weights
        The wᵢ, of either sign, shape (n,), n ≥ 3.

    Source: Imhof, *Biometrika* 48 (1961), Eq (3.2).

    Examples
    --------
    >>> round(chance_of_positive(np.array([1.0, 1.0, -1.0, -1.0])), 4)
    0.5
    """
    scaled = weights / np.max(np.abs(weights))
    log_u = np.linspace(-16.0, 16.0, 4001)
    turned = scaled[:, None] * np.exp(log_u)
    angle = 0.5 * np.arctan(turned).sum(axis=0)
    damped = np.sin(angle) * np.exp(-0.25 * np.log1p(turned**2).sum(axis=0))
    return float(np.clip(0.5 + np.trapezoid(damped, log_u) / np.pi, 0.0, 1.0))


def _likeliest_s(y: Array, series: Sequence[_Series], limit_s: float) -> float:
    """Correlation time under which the contrasts are likeliest, whatever size and colour."""
    longest_s = max(float(s.ends_s[-1] - s.begins_s[0]) for s in series)
    times_s = np.geomspace(limit_s, max(longest_s, SOUGHT * limit_s), TRIED_TIMES).tolist()
    colour = _covariance(series, limit_s)
    best_s, least = limit_s, np.inf
    for time_s in times_s:
        slow = _covariance(series, time_s)
        for share in COLOUR_SHARES:
            covariance = share * colour + (1.0 - share) * slow
            misfit = y.size * float(np.log(y @ np.linalg.solve(covariance, y)))
            misfit += float(np.linalg.slogdet(covariance)[1])
            if misfit < least:
                best_s, least = time_s, misfit
    return best_s


def _excursion_s(series: Sequence[_Series]) -> float | None:
    """Middle of the fewest blocks in a row that hold most of the slow power, if they are few."""
    powers = [(s.means - np.median(s.means)) ** 2 for s in series]
    wanted = EXCURSION * sum(float(power.sum()) for power in powers)
    most = int(EXCURSION_BLOCKS * sum(power.size for power in powers))
    found: list[tuple[float, float]] = []
    for s, power in zip(series, powers, strict=True):
        held = np.concatenate(([0.0], np.cumsum(power)))
        stops = np.searchsorted(held, held[:-1] + wanted)
        for first, stop in enumerate(stops.tolist()):
            if stop < held.size and stop - first <= most:
                begin_s, end_s = float(s.begins_s[first]), float(s.ends_s[stop - 1])
                found.append((end_s - begin_s, 0.5 * (begin_s + end_s)))
    return min(found)[1] if found else None
