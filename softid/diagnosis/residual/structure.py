"""What is still left: how much of a residual follows from the state of the actuator.

A smooth function of position, velocity, input, its rate, the lagged input and the time is fitted to
the residual on some blocks of time and judged on the others. Its share of the residual's power is
the structure that any law could still win. The null comes from the residual itself, shifted in
time: that keeps its colour and breaks its tie to the motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from softid.diagnosis_results import NOTABLE

Array = npt.NDArray[np.float64]

FOLD_COUNT = 12
"""Folds of the cross-validation, each of two contiguous blocks of a log."""

NULL_SHIFTS = 199
"""Circular shifts of the residual that make up the null distribution."""

NULL_QUANTILE = 0.95
"""Quantile of the shares predicted of shifted residuals that chance does not go beyond."""

WANDERING_QUANTILE = 0.99
"""Quantile of the shares predicted of shifted residuals that chance does not go beyond where
nothing pulls the motion back: a residual that adds up disturbances resembles every slow
variable."""

SHIFT_PARTS = 10
"""A shift is a tenth of the samples at least, either way: a slow residual that is shifted by less
still goes with the motion."""

KNOTS_PER_VARIABLE = 7
"""Knots of the smooth function of one variable."""

FINE_KNOTS = 21
"""Knots of the smooth function of position: a thread, a rack or pleats repeat within the stroke."""

RIDGE_SHARE = 1e-3
"""Penalty of the smooth function, as a share of the data's weight."""

INPUT_LAGS = (0.1, 0.5, 2.0)
"""Lags of the input in units of the motion's time constant."""

SLOW_PIECES = 4
"""Knots of the smooth function of time: only what is slow counts as following from it."""

KNOTS_WITHIN = (0.01, 0.99)
"""Quantiles of a variable between which its knots lie: one beyond would have next to no samples."""

SIZE_QUANTILE = 0.98
"""Quantile of the distances from the median that is the size of a variable. The largest distance
may be a short peak, as the speed has at a step."""

REVERSAL_WIDTH = 0.02
"""Share of the size of the speed over which the direction of the motion turns round: the step of
dry friction, with a slope at zero."""

LEAST_SIZE = 1e-12
"""Least size and distance of knots of a variable, as a share of its largest value: less is rounding
of a variable that stands still."""


@dataclass(frozen=True, eq=False)
class ResidualContext:
    """What the residual of one segment is looked at against.

    Attributes
    ----------
    time_s, x, v, u
        Time, position, velocity and input at the samples, each of shape (n,).
    residual
        Measured minus simulated, shape (n,); NaN where a sample is not used.
    begins_at_rest
        Whether the motion begins at rest.
    """

    time_s: Array
    x: Array
    v: Array
    u: Array
    residual: Array
    begins_at_rest: bool = False


@dataclass(frozen=True)
class Structure:
    """How much of a residual is structure.

    Attributes
    ----------
    share
        Share of the residual's power that the smooth function predicts on blocks that it did not
        see; 0 when it predicts nothing.
    limit
        What shifted residuals reach in 95 of 100 cases, or 99 where the motion wanders.
    by
        Variable → the share that a smooth function of it alone predicts.
    """

    share: float
    limit: float
    by: dict[str, float]

    @property
    def significant(self) -> bool:
        """Whether there is structure that chance does not explain."""
        return self.share > max(self.limit, NOTABLE)


def structure_of(
    parts: Sequence[ResidualContext],
    motion_s: float,
    *,
    rng: np.random.Generator,
    wanders: bool = False,
    chance: Array | None = None,
) -> Structure:
    """Look for structure in the residuals of all segments.

    Parameters
    ----------
    parts
        Residuals and what they are looked at against.
    motion_s
        Time constant of the motion, the unit of the lags.
    rng
        Draws the shifts.
    wanders
        Whether nothing pulls the motion back to a rest. Then it adds up every small disturbance,
        and that its residual follows from the time says nothing.
    chance
        Residuals that mere noise leaves, drawn by the caller at the samples that are used: one in
        each column, shape (m, D). Structure predicts more than of any of them; None where the
        shifted residual alone says what chance predicts.

    Returns
    -------
    Structure
        The share predicted by all variables together, what chance reaches, and the share predicted
        by each variable alone.
    """
    features = [_features(part, motion_s) for part in parts]
    groups = dict(features[0][1])
    matrix = np.concatenate([f for f, _ in features])
    if wanders:
        matrix[:, groups.pop("t")] = 0.0
    matrix = _standardised(matrix)
    residual = np.concatenate([part.residual for part in parts])
    used = np.isfinite(residual)
    fold = _folds([part.time_s for part in parts])
    smooth = _Smooth(matrix[used], fold[used])
    rows = residual[used]
    share, *alone = smooth.predicted_shares(rows[:, None], list(groups.values()))
    by = {name: max(float(s[0]), 0.0) for name, s in zip(groups, alone, strict=True)}
    (null,) = smooth.predicted_shares(_many_shifted(rows, rng))
    limit = float(np.quantile(null, WANDERING_QUANTILE if wanders else NULL_QUANTILE))
    if chance is not None:
        limit = max(limit, float(smooth.predicted_shares(chance)[0].max()))
    return Structure(max(float(share[0]), 0.0), limit, by)


def predicted_beyond_chance(
    matrix: Array, rows: Array, times: Sequence[Array], *, rng: np.random.Generator
) -> tuple[float, float]:
    """Share of a series that columns predict on blocks of time they were not fitted to.

    Parameters
    ----------
    matrix
        Columns, shape (n, C), the same for all runs.
    rows
        The series, shape (n,), about its mean.
    times
        Times of each run, together n.
    rng
        Draws the shifts.

    Returns
    -------
    share, limit
        And what it reaches in 95 of 100 cases when the series is shifted in time.
    """
    smooth = _Smooth(_standardised(matrix), _folds(times))
    (share,) = smooth.predicted_shares(rows[:, None])
    (null,) = smooth.predicted_shares(_many_shifted(rows, rng))
    return float(share[0]), float(np.quantile(null, NULL_QUANTILE))


def _many_shifted(rows: Array, rng: np.random.Generator) -> Array:
    """The null distribution, one residual in each column, shape (n, NULL_SHIFTS)."""
    return np.array([_shifted(rows, rng) for _ in range(NULL_SHIFTS)]).T


def _shifted(rows: Array, rng: np.random.Generator) -> Array:
    """The residual turned by a random amount, and perhaps reversed, in time."""
    least = rows.size // SHIFT_PARTS
    turned = np.roll(rows, int(rng.integers(least, rows.size - least)))
    return turned[::-1] if rng.random() < 0.5 else turned


class _Smooth:
    """Ridge regression on some blocks, judged on the others; the same for many residuals.

    All that it needs of the samples are products over each block: with weights w its error is
    Σ(e − ê)² = Σe² − 2 wᵀXᵀe + wᵀXᵀX w.
    """

    def __init__(self, matrix: Array, fold: npt.NDArray[np.intp]) -> None:
        order = np.argsort(fold, kind="stable")
        edges = np.searchsorted(fold[order], np.arange(FOLD_COUNT + 1))
        self._order = order
        self._slices = [slice(*ends) for ends in pairwise(edges.tolist()) if ends[0] < ends[1]]
        self._parts = [matrix[order[part]] for part in self._slices]
        self._grams = [part.T @ part for part in self._parts]

    def predicted_shares(
        self, rows: Array, groups: Sequence[npt.NDArray[np.intp]] = ()
    ) -> list[Array]:
        """1 − Σ(e − ê)²/Σe² over the blocks, each predicted from the others.

        ``rows`` holds one residual in each column, shape (n, S). One result of shape (S,) for all
        columns of the matrix, and one for each group of them.
        """
        power = np.einsum("ns,ns->s", rows, rows)
        sorted_rows = rows[self._order]
        own = [
            part.T @ sorted_rows[where]
            for part, where in zip(self._parts, self._slices, strict=True)
        ]
        everything = np.arange(own[0].shape[0])
        missed = (self._missed(own, columns) for columns in (everything, *groups))
        return [np.divide(-m, power, out=np.zeros_like(m), where=power > 0.0) for m in missed]

    def _missed(self, own: Sequence[Array], columns: npt.NDArray[np.intp]) -> Array:
        """Σ(e − ê)² − Σe² over the blocks, predicted from some columns, shape (S,)."""
        square = np.ix_(columns, columns)
        grams = [gram[square] for gram in self._grams]
        products = [mine[columns] for mine in own]
        whole, along = np.sum(grams, axis=0), np.sum(products, axis=0)
        ridge = RIDGE_SHARE * self._order.size * np.eye(columns.size)
        missed = np.zeros(along.shape[1])
        for gram, mine in zip(grams, products, strict=True):
            weights = np.linalg.solve(whole - gram + ridge, along - mine)
            missed += np.einsum("cs,cs->s", weights, gram @ weights - 2.0 * mine)
        return missed


def _folds(times: Sequence[Array]) -> npt.NDArray[np.intp]:
    """Block of each sample; neighbouring blocks belong to different folds."""
    folds = []
    for time_s in times:
        share = (time_s - time_s[0]) / max(float(time_s[-1] - time_s[0]), _least(time_s))
        folds.append(
            np.minimum((share * 2 * FOLD_COUNT).astype(np.intp), 2 * FOLD_COUNT - 1) % FOLD_COUNT
        )
    return np.concatenate(folds)


def _features(
    part: ResidualContext, motion_s: float
) -> tuple[Array, dict[str, npt.NDArray[np.intp]]]:
    """Columns of the smooth function, and which of them belong to which variable."""
    rate = np.gradient(part.u, part.time_s)
    variables = {
        "x": _basis(part.x, FINE_KNOTS),
        "v": np.column_stack((_basis(part.v), np.tanh(part.v / (REVERSAL_WIDTH * _size(part.v))))),
        "p": _basis(part.u),
        "rate of p": _basis(rate),
        "t": _basis(part.time_s, SLOW_PIECES),
    }
    lagged = []
    for lag in INPUT_LAGS:
        delayed = np.interp(part.time_s - lag * motion_s, part.time_s, part.u)
        lagged.append(delayed - part.u)
    variables["lagged p"] = np.column_stack(lagged)
    x, v = part.x / _size(part.x), part.v / _size(part.v)
    variables["x and v"] = np.column_stack((x * v, x * np.abs(v), x**2 * v, v * np.abs(v)))
    columns, groups, at = [], {}, 0
    for name, values in variables.items():
        columns.append(values)
        groups[name] = np.arange(at, at + values.shape[1])
        at += values.shape[1]
    return np.concatenate(columns, axis=1), groups


def _least(values: Array) -> float:
    """What of a variable is more than rounding; above zero also where all of it is zero."""
    return max(LEAST_SIZE * float(np.abs(values).max()), float(np.finfo(np.float64).tiny))


def _size(values: Array) -> float:
    distances = np.abs(values - np.median(values))
    return max(float(np.quantile(distances, SIZE_QUANTILE)), _least(values))


def _basis(values: Array, knots: int = KNOTS_PER_VARIABLE) -> Array:
    """Smooth bumps over the quantiles of a variable."""
    low, high = np.quantile(values, KNOTS_WITHIN)
    width = max((high - low) / (knots - 1), _least(values))
    centres = np.linspace(low, high, knots)
    bumps: Array = np.exp(-0.5 * ((values[:, None] - centres[None, :]) / width) ** 2)
    return bumps


def _standardised(matrix: Array) -> Array:
    centred = matrix - matrix.mean(axis=0)
    size = centred.std(axis=0)
    scaled: Array = centred / np.where(size > 0, size, 1.0)
    return scaled
