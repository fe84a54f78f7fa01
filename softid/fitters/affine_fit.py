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

from softid.fitters import levenberg_marquardt as rules_of
from softid.kernels.affine_descent import descend
from softid.kernels.affine_work import CHUNK, Drive, Measured, Room, Rules, Unknowns
from softid.kernels.lanes import (
    N_COLUMNS,
    N_PADDED,
    N_PARAMETERS,
    N_STATES,
    POINTS,
    RADAU,
    RK4,
    SIZE,
)
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
    law
        Kind of the law.
    theta
        The kernels' parameters, shape (8,).
    time_s, u, edges, anchored
        As in `Drive`.
    y, used, gain, level
        As in `Measured`.
    inner, factor, logarithmic, zero_at, state_at, states
        As in `Unknowns`.
    """

    law: int
    theta: Array
    time_s: Array
    u: Array
    edges: npt.NDArray[np.int64]
    anchored: npt.NDArray[np.bool_]
    y: Array
    used: npt.NDArray[np.bool_]
    gain: Array
    level: Array
    inner: npt.NDArray[np.int64]
    factor: Array
    logarithmic: npt.NDArray[np.bool_]
    zero_at: npt.NDArray[np.int64]
    state_at: npt.NDArray[np.int64]
    states: int


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
    positions = [problem.state_positions(k) for k in rows]
    names = problem.outputs
    return AffineArrays(
        law=form.kind,
        theta=form.theta.copy(),
        time_s=_joined([s.time_s for s in segments]),
        u=_joined([s.input for s in segments]),
        edges=np.concatenate(([0], np.cumsum(sizes))).astype(np.int64),
        anchored=np.array([problem.has_equilibrium or not len(p) for p in positions], bool),
        y=_joined([s.outputs[name] for name in names for s in segments]),
        used=_joined([s.used[name] for name in names for s in segments]),
        gain=np.array([line[0] for line in lines if line is not None]),
        level=np.array([line[1] for line in lines if line is not None]),
        inner=np.argmax(slopes != 0.0, axis=0).astype(np.int64),
        factor=slopes.sum(axis=0),
        logarithmic=problem.log_scaled,
        zero_at=np.array(zero_at, np.int64),
        state_at=np.array([p.start if len(p) else -1 for p in positions], np.int64),
        states=len(problem.model.start_states),
    )


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
    size = start.size
    room = _room(arrays, size, keep=keep)
    room.point[0] = start
    theta = arrays.theta.copy()
    centre, weight = (np.zeros(size), np.zeros(size)) if prior is None else prior
    how, side, used, cost, damping, n, offset = descend(
        Drive(
            arrays.law,
            theta,
            arrays.time_s,
            arrays.u,
            _counts(plans),
            arrays.edges,
            np.array([RK4 if p is not None and p.rule == "rk4" else RADAU for p in plans]),
            arrays.anchored,
        ),
        Measured(
            arrays.y,
            arrays.used,
            arrays.gain,
            arrays.level,
            np.array([1.0 / s**2 for s in sigma.values()]),
        ),
        Unknowns(
            arrays.inner,
            arrays.factor,
            arrays.logarithmic,
            arrays.zero_at,
            arrays.state_at,
            arrays.states,
            *limits,
            centre,
            weight,
        ),
        room,
        _rules(tolerance, bends=bends),
        evaluations,
        damping,
    )
    kept = room.first if side == 0 else room.second
    return Descent(
        room.point[side],
        room.shift[side],
        room.gram[side, :, :, :N_COLUMNS, :N_COLUMNS],
        kept.reshape(arrays.gain.size, N_COLUMNS, -1) if keep else None,
        cost,
        room.gradient[side],
        room.matrix[side],
        used,
        damping,
        n,
        offset,
        how,
    )


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


def _room(arrays: AffineArrays, size: int, *, keep: bool) -> Room:
    rows, channels = arrays.time_s.size if keep else 0, arrays.gain.size
    return Room(
        np.zeros((2, size)),
        np.zeros((2, size)),
        np.zeros((2, size)),
        np.zeros((2, size, size)),
        np.zeros((2, arrays.anchored.size, channels, N_PADDED, N_PADDED)),
        np.empty((channels * N_COLUMNS, rows)),
        np.empty((channels * N_COLUMNS, rows)),
        np.empty(rows),
        np.empty(SIZE),
        np.empty(POINTS, np.int64),
        np.empty((size + 1, size)),
        np.empty(N_STATES),
        np.empty((N_STATES, N_PARAMETERS + N_STATES)),
        np.empty(2, np.int64),
        np.empty(CHUNK),
        np.zeros((5, max(size, N_COLUMNS))),
    )


def _rules(tolerance: float, *, bends: bool) -> Rules:
    return Rules(
        bends,
        tolerance,
        rules_of.BEND_STEP,
        rules_of.SHORT_STEP,
        rules_of.MOST_BEND,
        rules_of.LESS_BEND,
        rules_of.MOST_SHORTENED,
        rules_of.INITIAL_DAMPING,
        rules_of.LARGEST_DECREASE,
        rules_of.MOST_DAMPING,
        rules_of.LARGEST_STEP,
        rules_of.SMALLEST_STEP,
        rules_of.STALL_EVALUATIONS,
        rules_of.STALL_GAIN,
        rules_of.STALL_OFFSET,
        rules_of.DOUBLINGS,
        rules_of.SCALE_FLOOR,
    )
