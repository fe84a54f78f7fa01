"""Start values of the muscle law from data alone.

With a1 = 1 the law answers with x/X, where X = 1/a1 is the largest x, so that for given
steepness b1, midpoint p50 and time constant the measured output is linear in X and in one sensor
zero per segment. With that linear solve inside, a coarse grid over the three finds the static
curve, a grid over frequency and damping ratio the motion, and a few variants how the damping goes
with pressure; only then does the optimiser start.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np
import numpy.typing as npt

from softid.kernels.muscle import KPA_PER_BAR
from softid.kernels.start_value_scores import add_products
from softid.models.division import held
from softid.models.second_order import Law
from softid.models.stretches import Stretch, thinned
from softid.segment import Segment

Array = npt.NDArray[np.float64]

STEEPNESS = (0.7, 2.0, 4.0, 8.0, 16.0)
"""Steepnesses that are tried: b1 times the range of the pressure."""

MIDPOINTS = (-0.5, 0.0, 0.25, 0.5, 0.75, 1.0, 1.5)
"""Midpoints that are tried: p50 as a fraction of the range of the pressure."""

DAMPING_RATIOS = (0.15, 0.4, 1.0, 3.0)
"""Damping ratio at the midpoint on the second grid, next to `N_FREQUENCIES` natural frequencies."""

DAMPING_SHAPES = ((0.0, 0.0), (0.5, 1.0), (0.5, -1.0))
"""Share of the damping that depends on pressure, and its b2 in units of b1."""

N_SPEEDS = 7
N_FREQUENCIES = 14
N_BASES = 8
N_MOTIONS = 5
N_STARTS = 5
"""Judgements: sizes of the grids, how many of the best are looked at further, and are handed on."""

RINGING_RATIO = 0.25
RINGING_FREQUENCIES = slice(4, 11)
"""Damping ratio, with which two periods are seen, and which of the natural frequencies are combined
with every plausible static curve."""

RINGING_BELOW = 0.9
"""Damping ratio below which a start is refined."""

REFINEMENTS = 5
"""Rounds over the four coordinates; after one without any gain the moves are halved."""

FIRST_MOVES = (0.35, 0.8, 0.35, 0.6)
"""First moves of the logarithms of b1, c1, natural frequency and damping ratio; halved in turn."""

SMALL_INERTIA = 0.02
"""M/N of a start without inertia, in units of N/Q: a damping ratio of 3.5, hardly felt."""

CONSTANT_SHARE = 0.3
"""A damping that is constant is divided into a2·exp(0·p), so much of it, and c2: it stays the same,
and tells at once which way b2 wants."""

ROUGH_SAMPLES = 500
"""Samples over which the wide grids are ranked: half the work, and the same basins."""

_MOST_DECAY_LENGTHS = 0.5
"""Longest time constant tried, over the longest stretch: a step is then 86 % done at its end."""


def hammerstein_starts(
    segments: Sequence[Segment],
    motions: Sequence[Array],
    output: str,
    law: Callable[[Array], Law],
    *,
    static: bool,
) -> list[dict[str, float]]:
    """Rank start values for the muscle law, the most promising first.

    Parameters
    ----------
    segments
        Fitted segments.
    motions
        Measured x up to a zero, one array per segment.
    output
        Channel whose unused samples are left out.
    law
        Builds the law from theta of shape (7,).
    static
        Whether the law has no damping, so that no speed is searched.

    Returns
    -------
    list of dict
        Empty when the pressure never changes.
    """
    stretches = thinned(segments, motions, output)
    low = min(float(s.input.min()) for s in stretches) / KPA_PER_BAR
    span = max(float(s.input.max()) for s in stretches) / KPA_PER_BAR - low
    if span <= 0.0:
        return []
    speeds = np.array([0.0]) if static else _speeds(stretches)
    steep, middle, tau = _combined(STEEPNESS, MIDPOINTS, speeds)
    rough = thinned(segments, motions, output, most=ROUGH_SAMPLES) or stretches
    coarse = _ranked(rough, law, _theta(steep / span, low + middle * span, tau))
    if static:
        return [
            as_values(theta, gain) for _, gain, theta in diverse(coarse, N_STARTS, _static_kind)
        ]
    bases = _thetas(diverse(coarse, N_BASES, _static_kind))
    frequencies = _spaced(0.3 / speeds[-1], 1.0 / speeds[0], N_FREQUENCIES)
    moving = _moving(bases, frequencies, low, span)
    ranked = _ranked(rough, law, np.concatenate([bases, moving]))
    medium = _ranked(stretches, law, _thetas(diverse(ranked, N_MOTIONS, motion_kind)))
    shaped = [damping_shapes(_refined(stretches, law, row)[2]) for row in medium]
    fine = diverse(_ranked(stretches, law, np.reshape(shaped, (-1, 7))), N_STARTS, motion_kind)
    return [as_values(theta, gain) for _, gain, theta in fine]


def _thetas(ranked: Sequence[tuple[float, float, Array]]) -> Array:
    """The parameters alone, shape (G, 7)."""
    return np.reshape([theta for _, _, theta in ranked], (-1, 7))


def _combined(*axes: Array | Sequence[float]) -> list[Array]:
    """All combinations of the values on several axes, one array per axis, the last one fastest."""
    return [grid.ravel() for grid in np.meshgrid(*axes, indexing="ij")]


def _moving(bases: Array, frequencies: Array, low: float, span: float) -> Array:
    """Motions with inertia for the best static curves, and lightly damped ones for all.

    The bases were ranked without inertia, which misleads where the motion rings on and on.
    """
    row, omega, ratio = _combined(range(len(bases)), frequencies, DAMPING_RATIOS)
    b1, c1 = bases[row.astype(int), 2], bases[row.astype(int), 3]
    steep, middle, fast = _combined(STEEPNESS[1:], MIDPOINTS[2:5], frequencies[RINGING_FREQUENCIES])
    light = _ringing(steep / span, low + middle * span, fast, RINGING_RATIO)
    return np.concatenate([_ringing(b1, np.log(c1) / b1, omega, ratio), light])


def _ranked(
    stretches: Sequence[Stretch], law: Callable[[Array], Law], grid: Array
) -> Iterator[tuple[float, float, Array]]:
    """Residual sum of squares, gain and theta of every grid point, best first."""
    if not len(grid):
        return
    squares, gains = _scored(stretches, law, grid)
    for k in np.argsort(squares, kind="stable").tolist():
        yield float(squares[k]), float(gains[k]), grid[k]


def _refined(
    stretches: Sequence[Stretch], law: Callable[[Array], Law], row: tuple[float, float, Array]
) -> tuple[float, float, Array]:
    """Move a lightly damped grid point in steepness, level, frequency and damping ratio.

    A ringing response fits only within a fraction of a period, closer than the grid lies.
    """
    mass, _, b1, c1, _, _, damping = row[2].tolist()
    if mass <= 0.0 or damping**2 > 8.0 * c1 * mass * RINGING_BELOW**2:
        return row
    omega, ratio = np.sqrt(2.0 * c1 / mass), damping / np.sqrt(8.0 * c1 * mass)
    at = np.log([b1, c1, omega, ratio])
    size = np.array(FIRST_MOVES)
    best = row
    for _ in range(REFINEMENTS):
        moved = False
        for k in range(at.size):
            for sign in (1.0, -1.0):
                trial = at.copy()
                trial[k] += sign * size[k]
                steep, level, fast, damped = np.exp(trial).tolist()
                theta = _ringing(steep, float(np.log(level)) / steep, fast, damped)
                cost = score(stretches, law, theta)
                if cost[0] < best[0]:
                    best, at, moved = (*cost, theta), trial, True
                    break
        if not moved:
            size /= 2.0
    return best


def _theta(
    b1: float | Array,
    p50: float | Array,
    tau: float | Array,
    *,
    inertia: float | Array = 0.0,
    share: float | Array = 0.0,
    b2: float | Array = 0.0,
) -> Array:
    """Parameters with a1 = 1 that have N/Q = ``tau`` and M/N = ``inertia`` at the midpoint.

    Of shape (7,), or (G, 7) for G values of each argument.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        c1 = np.exp(np.clip(np.multiply(b1, p50), -60.0, 60.0))
        damping = 2.0 * c1 * tau
        a2 = share * damping * np.exp(np.clip(np.multiply(-b2, p50), -60.0, 60.0))
        columns = (inertia * damping, 1.0, b1, c1, a2, b2, (1.0 - share) * damping)
    found = np.empty((*np.shape(a2), len(columns)))
    for k, column in enumerate(columns):
        found[..., k] = column
    return found


def _ringing(
    b1: float | Array, p50: float | Array, omega: float | Array, ratio: float | Array
) -> Array:
    """Parameters with a natural frequency and a damping ratio at the midpoint, as `_theta`."""
    return _theta(b1, p50, 2.0 * ratio / omega, inertia=0.5 / (ratio * omega))


def damping_shapes(theta: Array) -> list[Array]:
    """The same static curve and speed with damping that is constant, grows or falls."""
    mass, _, b1, c1, _, _, damping = theta.tolist()
    p50, tau, inertia = np.log(c1) / b1, damping / (2.0 * c1), max(mass / damping, 0.0)
    share, factor = np.array(DAMPING_SHAPES).T
    return list(_theta(b1, p50, tau, inertia=inertia, share=share, b2=factor * b1))


def diverse(
    ranked: Iterable[tuple[float, float, Array]],
    count: int,
    kind: Callable[[Array], tuple[int, ...]],
) -> list[tuple[float, float, Array]]:
    """The best row of each kind, at most ``count``."""
    chosen: dict[tuple[int, ...], tuple[float, float, Array]] = {}
    for row in ranked:
        if np.isfinite(row[0]):
            chosen.setdefault(kind(row[2]), row)
        if len(chosen) == count:
            break
    return list(chosen.values())


def _static_kind(theta: Array) -> tuple[int, ...]:
    b1, log_c1 = theta[2], np.log(theta[3])
    return round(2 * float(np.log(b1))), round(float(log_c1))


def motion_kind(theta: Array) -> tuple[int, ...]:
    """Steepness, natural frequency, damping ratio and shape of the damping, in coarse steps."""
    mass, stiffness = max(theta[0], 1e-300), theta[1] + theta[3]
    damping = max(theta[4] * np.exp(theta[5] * np.log(theta[3]) / theta[2]) + theta[6], 1e-300)
    ratio = min(damping / (2.0 * np.sqrt(stiffness * mass)), 10.0)
    return (
        round(2 * float(np.log(theta[2]))),
        round(float(np.log(stiffness / damping))),
        round(float(np.log(ratio))),
        int(np.sign(theta[5])),
    )


def as_values(theta: Array, gain: float) -> dict[str, float]:
    """Back to parameters with a gain; what is zero starts small, so that it can still grow."""
    mass, a1, b1, c1, a2, b2, c2 = theta.tolist()
    if a2 == 0.0:
        a2, b2, c2 = CONSTANT_SHARE * c2, 0.0, (1.0 - CONSTANT_SHARE) * c2
    small = SMALL_INERTIA * c2 * (c2 / (2.0 * c1))  # inf, where a power would raise
    return {
        "M": max(mass, small) / gain,
        "a1": a1 / gain,
        "b1": b1,
        "c1": c1 / gain,
        "a2": a2 / gain,
        "b2": b2,
        "c2": c2 / gain,
    }


def score(
    stretches: Sequence[Stretch], law: Callable[[Array], Law], theta: Array
) -> tuple[float, float]:
    """Residual sum of squares and the gain X that reaches it, zeros projected out."""
    return scores(stretches, law, [theta])[0]


def scores(
    stretches: Sequence[Stretch], law: Callable[[Array], Law], grid: Sequence[Array] | Array
) -> list[tuple[float, float]]:
    """`score` of every grid point."""
    if not len(grid):
        return []
    squares, gains = _scored(stretches, law, np.asarray(grid))
    return list(zip(squares.tolist(), gains.tolist(), strict=True))


def _scored(
    stretches: Sequence[Stretch], law: Callable[[Array], Law], rows: Array
) -> tuple[Array, Array]:
    """Residual sums of squares and gains of grid points, each of shape (G,)."""
    form = law(rows[0]).affine()
    assert form is not None
    thetas = rows * np.diag(form.by_theta)  # the kernels' parameters are in other units
    sums = np.zeros((len(rows), 3))
    for s in stretches:
        time_s, u, y, used = map(held, (s.time_s, s.input, s.motion, s.used))
        add_products(thetas, time_s, u, y, used, sums)
    cross, power, total = sums.T
    sound = (cross > 0.0) & (power > 0.0) & (power < np.inf)
    power = np.where(sound, power, 1.0)
    squares = np.where(sound, total - cross**2 / power, np.inf)
    return squares, np.where(sound, cross / power, 1.0)


def _speeds(stretches: Sequence[Stretch]) -> Array:
    shortest = min(float(np.median(np.diff(s.time_s))) for s in stretches)
    longest = max(float(s.time_s[-1] - s.time_s[0]) for s in stretches)
    return _spaced(0.3 * shortest, _MOST_DECAY_LENGTHS * longest, N_SPEEDS)


def _spaced(low: float, high: float, count: int) -> Array:
    """Values from one to another, each as many times the one before."""
    found: Array = low * (high / low) ** np.linspace(0.0, 1.0, count)
    return found
