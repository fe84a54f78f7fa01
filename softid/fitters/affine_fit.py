"""The compiled optimiser for laws affine in their state: a problem as arrays, and a run over them.

Every other problem goes through `softid.fitters.levenberg_marquardt.minimise`, one Python call an
evaluation; both make the same steps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from softid.kernels import affine_work as work
from softid.kernels.affine_descent import descend
from softid.kernels.lanes import N_COLUMNS, N_PADDED, RADAU, RK4
from softid.models.division import Division, held

if TYPE_CHECKING:
    from softid.fitters.problem import Problem

Array = npt.NDArray[np.float64]

MOST_UNKNOWNS = 40
"""With more of them a library's linear algebra pays."""


@dataclass(frozen=True, eq=False)
class AffineArrays:
    """A problem of an affine law as the compiled optimiser knows it, but for plans and weights.

    Attributes
    ----------
    theta
        The kernels' parameters, shape (8,).
    time_s, u, y, used, pieces, lines, free
        As in `descend`, but for the rule of every piece and its weight.
    factor
        The row `FACTOR`, shape (F,).
    edges
        Where each segment begins, and N, shape (S + 1,).
    gain
        Every output is gain·x and something, shape (C,).
    zero_at
        Which unknown is the zero of a segment and channel, −1 for none, shape (S, C).
    """

    theta: Array
    time_s: Array
    u: Array
    y: Array
    used: npt.NDArray[np.bool_]
    pieces: npt.NDArray[np.int64]
    lines: Array
    free: npt.NDArray[np.int64]
    factor: Array
    edges: npt.NDArray[np.int64]
    gain: Array
    zero_at: npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Descent:
    """Where a compiled run ended.

    Attributes
    ----------
    point, shift
        Unknowns, and by how much the zeros were moved after the sums were made, each of shape (U,).
    grams
        Products of the columns of every segment and channel, shape (S, C, 11, 11).
    columns
        The columns at every sample, shape (C, 11, N), or None.
    cost, gradient, matrix
        ½Σ(r/σ)², Jᵀr of shape (U,) and JᵀJ of shape (U, U), with the prior.
    used, damping
        Evaluations, and damping at the end.
    n, offset
        Number of residuals, and `attainable_offset` at the end.
    how
        NEEDS_COLUMNS where a run that keeps them must go on, SINGULAR where another optimiser must.
    """

    point: Array
    shift: Array
    grams: Array
    columns: Array | None
    cost: float
    gradient: Array
    matrix: Array
    used: int
    damping: float
    n: int
    offset: float
    how: int


def affine_arrays(problem: Problem) -> AffineArrays | None:
    """The arrays of a problem; None where its law, its outputs or its parameters need Python."""
    lines = [problem.model.line(name) for name in problem.outputs]
    if None in lines:
        return None
    law = problem.model.motion_law(problem.parameters.values_vector())
    form = law.affine() if law is not None else None
    if form is None or problem.tied or not 0 < problem.size <= MOST_UNKNOWNS:
        return None
    slopes = form.by_theta[:, problem.free_index]
    if np.any(np.count_nonzero(slopes, axis=0) != 1):
        return None
    segments = problem.segments
    sizes = [segment.time_s.size for segment in segments]
    rows = range(len(segments))
    zero_at = [
        [
            problem.zero_position(problem.owner[k], n) if problem.zeros else -1
            for n in problem.outputs
        ]
        for k in rows
    ]
    names = problem.outputs
    zeros = np.array(zero_at, np.int64)
    edges = np.concatenate(([0], np.cumsum(sizes))).astype(np.int64)
    gain = np.array([line[0] for line in lines if line is not None])
    level = np.array([line[1] for line in lines if line is not None])
    return AffineArrays(
        theta=form.theta.copy(),
        time_s=_joined([s.time_s for s in segments]),
        u=_joined([s.input for s in segments]),
        y=_joined([s.outputs[name] for name in names for s in segments]),
        used=_joined([s.used[name] for name in names for s in segments]),
        pieces=_pieces(problem, form.kind, edges, zeros),
        lines=np.tile(np.stack([gain, level, np.ones(gain.size)], axis=1), (len(segments), 1)),
        free=np.stack([np.argmax(slopes != 0.0, axis=0), problem.log_scaled]).astype(np.int64),
        factor=slopes.sum(axis=0),
        edges=edges,
        gain=gain,
        zero_at=zeros,
    )


def _pieces(
    problem: Problem, kind: int, edges: npt.NDArray[np.int64], zero_at: npt.NDArray[np.int64]
) -> npt.NDArray[np.int64]:
    """The columns of ``pieces``, segment by segment."""
    segments, channels = zero_at.shape
    pieces = np.zeros((segments, channels, work.PIECE_COLUMNS), np.int64)
    states = [problem.state_positions(k) for k in range(segments)]
    pieces[..., work.LAW] = kind
    pieces[..., work.BEGIN] = edges[:-1, None]
    pieces[..., work.END] = edges[1:, None]
    pieces[..., work.CHANNEL] = np.arange(channels)
    pieces[..., work.OUTPUT] = np.arange(channels) * edges[-1]
    anchored = [problem.has_equilibrium or not len(p) for p in states]
    pieces[..., work.ANCHORED] = np.array(anchored)[:, None]
    pieces[..., work.STATE_AT] = np.array([p.start if len(p) else -1 for p in states])[:, None]
    pieces[..., work.STATES] = len(problem.model.start_states)
    pieces[..., work.ZERO_AT] = zero_at
    return pieces.reshape(-1, work.PIECE_COLUMNS)


def run(
    arrays: AffineArrays,
    start: Array,
    plans: Sequence[Division | None],
    sigma: Mapping[str, float],
    limits: tuple[Array, Array, Array],
    prior: tuple[Array, Array] | None,
    *,
    evaluations: int,
    tolerance: float,
    keep: bool,
    bends: bool = True,
    damping: float = -1.0,
) -> Descent:
    """Minimise from a start within the bounds.

    Parameters
    ----------
    arrays
        The problem.
    start
        Unknowns, shape (U,).
    plans
        Steps of every segment.
    sigma
        Output channel → σ, in the problem's order.
    limits
        Lower and upper bounds and plausible moves, each of shape (U,).
    prior
        Centre and weight, each of shape (U,), or None.
    evaluations, tolerance
        As in `minimise`.
    keep
        Whether to keep the columns at every sample, for the bend of a step.
    bends
        Whether to stop before a long step where they are not kept.
    damping
        That of a run that goes on; negative begins anew.
    """
    size, channels, n_pieces = start.size, arrays.gain.size, len(arrays.pieces)
    rows = arrays.time_s.size if keep else 0
    first, second = (np.empty((channels * N_COLUMNS, rows)) for _ in range(2))
    vectors = _vectors(arrays, start, limits, prior)
    matrices = np.zeros((2 * size, size))
    grams = np.zeros((work.gram_rows(n_pieces), N_PADDED))
    pieces, lines = arrays.pieces.copy(), arrays.lines.copy()
    rules = [RK4 if p is not None and p.rule == "rk4" else RADAU for p in plans]
    pieces[:, work.RULE] = np.repeat(rules, channels)
    lines[:, work.WEIGHT] = np.tile([1.0 / s**2 for s in sigma.values()], len(plans))
    how, side, n, offset = descend(
        pieces,
        lines,
        arrays.free,
        arrays.time_s,
        arrays.u,
        _counts(plans),
        arrays.y,
        arrays.used,
        arrays.theta.copy(),
        vectors,
        matrices,
        grams,
        first,
        second,
        np.empty(rows),
        evaluations,
        tolerance,
        damping,
        bends,
    )
    now = vectors[work.NOW]
    return Descent(
        point=vectors[work.POINT + side, :size],
        shift=vectors[work.SHIFT + side, :size],
        grams=grams.reshape(2, -1, channels, N_PADDED, N_PADDED)[side, ..., :-1, :-1],
        columns=(second if side else first).reshape(channels, N_COLUMNS, -1) if keep else None,
        cost=float(now[work.COST]),
        gradient=vectors[work.GRADIENT + side, :size],
        matrix=matrices.reshape(2, size, size)[side],
        used=int(now[work.USED]),
        damping=float(now[work.DAMPING]),
        n=n,
        offset=offset,
        how=how,
    )


def _vectors(
    arrays: AffineArrays,
    start: Array,
    limits: tuple[Array, Array, Array],
    prior: tuple[Array, Array] | None,
) -> Array:
    size = start.size
    vectors = np.zeros((work.N_VECTORS, work.width(size)))
    vectors[work.POINT, :size] = start
    vectors[work.FACTOR, : arrays.factor.size] = arrays.factor
    for row, values in zip((work.LOWER, work.UPPER, work.REACH), limits, strict=True):
        vectors[row, :size] = values
    if prior is not None:
        vectors[work.CENTRE, :size], vectors[work.PRIOR, :size] = prior
    return vectors


def looked_at(
    problem: Problem, values: Mapping[str, float], sigma: Mapping[str, float]
) -> Array | None:
    """Unknowns at given parameter values with the best zeros and initial states, shape (U,).

    Both stand linearly in a motion that is affine in its state: one evaluation tells where they are
    best. None where the problem has no arrays.

    Parameters
    ----------
    problem
        What is to be fitted.
    values
        Parameter name → value.
    sigma
        Output channel → σ.
    """
    arrays = problem.arrays
    if arrays is None:
        return None
    lower, upper = problem.bounds()
    begin = np.clip(problem.free_unknowns(values), lower, upper)
    limits = lower, upper, problem.reach()
    plans = problem.plans(begin)
    found = run(arrays, begin, plans, sigma, limits, None, evaluations=1, tolerance=0.0, keep=False)
    z = found.point.copy()
    linear = slice(len(problem.free), None)
    if np.isfinite(found.cost) and problem.size > len(problem.free):
        matrix, gradient = found.matrix[linear, linear], found.gradient[linear]
        z[linear] += np.linalg.lstsq(matrix, gradient, rcond=None)[0]
    return z


def _joined(parts: Sequence[npt.NDArray[Any]]) -> npt.NDArray[Any]:
    return held(parts[0] if len(parts) == 1 else np.concatenate(parts))


def _counts(plans: Sequence[Division | None]) -> npt.NDArray[np.int16]:
    counts = [plan.counts for plan in plans if plan is not None]
    if len(counts) == 1:
        return counts[0]
    filler = np.ones(1, np.int16)
    return np.concatenate([part for c in counts for part in (c, filler)])
