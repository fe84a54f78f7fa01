"""Cost, normal equations and the bend of a fit of an affine law.

Every piece contributes columns C (seven derivatives, two by the initial state, one, residual) and
their products G = C Cᵀ; weights T make up the Jacobian, J = Cᵀ T, and t the residual. Then
JᵀJ = Tᵀ G T and Jᵀr = Tᵀ G t, and a zero moves to its optimum by changing t. Arrays are those of
`softid.kernels.affine_work`.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.affine_blocks import run_positions, sum_columns
from softid.kernels.affine_work import (
    ANCHORED,
    BEGIN,
    CENTRE,
    CHANNEL,
    CHUNK,
    END,
    FACTOR,
    GAIN,
    GRADIENT,
    LAW,
    LEVEL,
    LOGARITHMIC,
    MADE,
    OUTPUT,
    PARAMETER,
    POINT,
    PRIOR,
    PULL,
    PULLED,
    RULE,
    SHARE,
    SHIFT,
    STATE_AT,
    STATES,
    STEP,
    TAKEN,
    THERE,
    TOTAL,
    WEIGHT,
    ZERO_AT,
)
from softid.kernels.decorators import inner, written_out
from softid.kernels.lanes import MUSCLE, N_COLUMNS, N_PADDED, N_PARAMETERS, N_STATES, SUMMING
from softid.kernels.rules import BEND_STEP

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]
Counts = npt.NDArray[np.int16]
BoolArray = npt.NDArray[np.bool_]

ONE, RESIDUAL = N_COLUMNS - 2, N_COLUMNS - 1


@inner
def set_parameters(free: Index, vectors: Array, row: int, theta: Array) -> None:
    """The kernels' parameters at the unknowns of a row."""
    for f in range(free.shape[1]):
        value = vectors[row, f]
        if free[LOGARITHMIC, f]:
            value = np.exp(value)
        theta[free[PARAMETER, f]] = vectors[FACTOR, f] * value


@inner
def _begin(
    pieces: Index, p: int, theta: Array, u: float, vectors: Array, row: int, state: Array,
    tangent: Array,
) -> None:  # fmt: skip
    """(x, v) at the first sample of a piece, shape (2,), and its derivatives, shape (2, 9)."""
    for k in range(N_PARAMETERS + N_STATES):
        tangent[0, k], tangent[1, k] = 0.0, 0.0
    tangent[0, N_PARAMETERS] = tangent[1, N_PARAMETERS + 1] = 1.0
    state[0], state[1] = 0.0, 0.0
    if pieces[p, ANCHORED]:
        if pieces[p, LAW] == MUSCLE:
            force = np.exp(theta[2] * u)
            force_by = u * force
        else:
            force, force_by = theta[7] * (u - theta[2]), -theta[7]
        stiffness = theta[1] * force + theta[3]
        rest = force / stiffness
        state[0] = rest
        tangent[0, 1] = -rest * force / stiffness
        tangent[0, 2] = force_by * (1.0 - theta[1] * rest) / stiffness
        tangent[0, 3] = -rest / stiffness
    at = pieces[p, STATE_AT]
    if at >= 0:
        for k in range(pieces[p, STATES]):
            state[k] += vectors[row, at + k]


@written_out
def sum_pieces(
    pieces: Index, lines: Array, free: Index, time_s: Array, u: Array, counts: Counts, y: Array,
    used: BoolArray, theta: Array, vectors: Array, grams: Array, kept: Array, work: Array,
    ends: Index, at: Index, state: Array, tangent: Array, side: int,
) -> None:  # fmt: skip
    """Products of the columns of every piece at a place; ``kept`` receives the columns."""
    set_parameters(free, vectors, POINT + side, theta)
    for p in range(pieces.shape[0]):
        zero = pieces[p, ZERO_AT]
        level = lines[p, LEVEL]
        if zero >= 0:
            level += vectors[POINT + side, zero]
        begin = pieces[p, BEGIN]
        _begin(pieces, p, theta, u[begin], vectors, POINT + side, state, tangent)
        at[0], at[1], at[2] = begin, 0, pieces[p, END] - 1
        sum_columns(
            pieces[p, LAW], pieces[p, RULE], theta, time_s, u, counts, y, used, pieces[p, OUTPUT],
            lines[p, GAIN], level, state, tangent, work, ends, at, kept,
            pieces[p, CHANNEL] * N_COLUMNS, grams, (side * pieces.shape[0] + p) * N_PADDED,
        )  # fmt: skip


@written_out
def move_zeros(pieces: Index, vectors: Array, grams: Array, side: int) -> int:
    """Move every zero to its optimum, the mean residual of its log; returns the residuals."""
    for k in range(vectors.shape[1]):
        vectors[SHIFT + side, k], vectors[TOTAL, k] = 0.0, 0.0
    n = int(np.int64(0))  # a literal would have what it is given to compiled once more
    for p in range(pieces.shape[0]):
        one = (side * pieces.shape[0] + p) * N_PADDED + ONE
        zero = pieces[p, ZERO_AT]
        if np.isfinite(grams[one, ONE]):
            n += int(grams[one, ONE] + 0.5)
        if zero >= 0:
            vectors[TOTAL, zero] += grams[one, ONE]
            vectors[SHIFT + side, zero] += grams[one, RESIDUAL]
    for k in range(vectors.shape[1]):
        shift, total = vectors[SHIFT + side, k], vectors[TOTAL, k]
        shift = shift / total if total > 0.0 and np.isfinite(shift) else 0.0
        vectors[SHIFT + side, k] = shift
        vectors[POINT + side, k] += shift
    return n


@inner
def _weigh(
    pieces: Index, lines: Array, free: Index, theta: Array, vectors: Array, p: int, side: int
) -> float:
    """T of a piece: the unknown and the weight of every column; returns by what its zero moved."""
    gain = lines[p, GAIN]
    for k in range(N_PARAMETERS + N_STATES):
        vectors[TAKEN, k], vectors[SHARE, k] = -1.0, 0.0
    for f in range(free.shape[1]):
        k = free[PARAMETER, f]
        vectors[TAKEN, k] = f
        vectors[SHARE, k] = gain * (theta[k] if free[LOGARITHMIC, f] else vectors[FACTOR, f])
    at = pieces[p, STATE_AT]
    if at >= 0:
        for k in range(pieces[p, STATES]):
            vectors[TAKEN, N_PARAMETERS + k], vectors[SHARE, N_PARAMETERS + k] = at + k, gain
    zero = pieces[p, ZERO_AT]
    vectors[TAKEN, ONE], vectors[SHARE, ONE] = zero, 1.0
    return float(vectors[SHIFT + side, zero]) if zero >= 0 else 0.0


@written_out
def add_up(
    pieces: Index, lines: Array, free: Index, theta: Array, vectors: Array, matrices: Array,
    grams: Array, side: int,
) -> float:  # fmt: skip
    """Cost with its prior; fills the place with its normal equations."""
    size = matrices.shape[1]
    first, gradient = side * size, GRADIENT + side
    for i in range(size):
        vectors[gradient, i] = 0.0
        for j in range(size):
            matrices[first + i, j] = 0.0
    cost = 0.0
    for p in range(pieces.shape[0]):
        moved = _weigh(pieces, lines, free, theta, vectors, p, side)
        g, weight = (side * pieces.shape[0] + p) * N_PADDED, lines[p, WEIGHT]
        left = grams[g + RESIDUAL, RESIDUAL] - moved * grams[g + RESIDUAL, ONE]
        left -= moved * (grams[g + ONE, RESIDUAL] - moved * grams[g + ONE, ONE])
        cost += 0.5 * weight * max(left, 0.0)
        for i in range(N_COLUMNS - 1):
            a, share = int(vectors[TAKEN, i]), weight * vectors[SHARE, i]
            if a >= 0:
                vectors[gradient, a] += share * (grams[g + i, RESIDUAL] - moved * grams[g + i, ONE])
                for j in range(N_COLUMNS - 1):
                    b = int(vectors[TAKEN, j])
                    if b >= 0:
                        matrices[first + a, b] += share * vectors[SHARE, j] * grams[g + i, j]
    total = cost
    for i in range(size):
        away, prior = vectors[POINT + side, i] - vectors[CENTRE, i], vectors[PRIOR, i]
        cost += 0.5 * prior * away * away
        vectors[gradient, i] -= prior * away
        matrices[first + i, i] += prior
        total += vectors[gradient, i]
        for j in range(size):
            total += matrices[first + i, j]
    return cost if np.isfinite(total) else np.inf


@njit(nogil=True, error_model="numpy", fastmath=SUMMING)
def _dot(kept: Array, row: int, begin: int, end: int, away: Array) -> float:
    total = 0.0
    for i in range(end - begin):
        total += kept[row, begin + i] * away[i]
    return total


@inner
def _pull(kept: Array, row: int, begin: int, end: int, vectors: Array, away: Array) -> None:
    """Add columns times what is left of the straight line, over some samples."""
    for j in range(N_COLUMNS):
        weight = vectors[MADE, j]
        if weight != 0.0:
            for i in range(end - begin):
                away[i] += weight * kept[row + j, begin + i]
    for j in range(N_COLUMNS - 1):
        vectors[PULLED, j] += _dot(kept, row + j, begin, end, away)


@written_out
def _pull_piece(
    pieces: Index, lines: Array, p: int, y: Array, used: BoolArray, vectors: Array, kept: Array,
    x: Array, away: Array,
) -> None:  # fmt: skip
    """Columns times (straight − true) residual of one piece."""
    zero, shift = pieces[p, ZERO_AT], pieces[p, OUTPUT]
    gain, level = lines[p, GAIN], lines[p, LEVEL]
    if zero >= 0:
        level += vectors[THERE, zero]
    for j in range(N_COLUMNS):
        vectors[PULLED, j] = 0.0
    for begin in range(pieces[p, BEGIN], pieces[p, END], CHUNK):
        end = min(begin + CHUNK, pieces[p, END])
        for i in range(end - begin):
            k = begin + i
            there = y[shift + k] - level - gain * x[k]
            away[i] = -there if used[shift + k] else 0.0
        _pull(kept, pieces[p, CHANNEL] * N_COLUMNS, begin, end, vectors, away)


@written_out
def bend(
    pieces: Index, lines: Array, free: Index, time_s: Array, u: Array, counts: Counts, y: Array,
    used: BoolArray, theta: Array, vectors: Array, kept: Array, x: Array, work: Array, ends: Index,
    at: Index, state: Array, tangent: Array, away: Array, side: int,
) -> bool:  # fmt: skip
    """Jᵀ∂²ŷ/∂v² for v in the row `STEP` into the row `PULL`; False where it is not finite.

    Needs the kept columns at the place.
    """
    for k in range(vectors.shape[1]):
        vectors[THERE, k] = vectors[POINT + side, k] + BEND_STEP * vectors[STEP, k]
        vectors[PULL, k] = 0.0
    for p in range(pieces.shape[0]):
        if pieces[p, CHANNEL] == 0:
            begin = pieces[p, BEGIN]
            set_parameters(free, vectors, THERE, theta)
            _begin(pieces, p, theta, u[begin], vectors, THERE, state, tangent)
            at[0], at[1], at[2] = begin, 0, pieces[p, END] - 1
            run_positions(
                pieces[p, LAW], pieces[p, RULE], theta, time_s, u, counts, state, work, ends, at, x
            )
            set_parameters(free, vectors, POINT + side, theta)
        moved = _weigh(pieces, lines, free, theta, vectors, p, side)
        for j in range(N_COLUMNS - 1):
            a = int(vectors[TAKEN, j])
            share = -BEND_STEP * vectors[SHARE, j]
            vectors[MADE, j] = share * vectors[STEP, a] if a >= 0 else 0.0
        vectors[MADE, RESIDUAL] = 1.0
        vectors[MADE, ONE] -= moved
        _pull_piece(pieces, lines, p, y, used, vectors, kept, x, away)
        weight = 2.0 / (BEND_STEP * BEND_STEP) * lines[p, WEIGHT]
        for j in range(N_COLUMNS - 1):
            a = int(vectors[TAKEN, j])
            if a >= 0:
                vectors[PULL, a] += weight * vectors[SHARE, j] * vectors[PULLED, j]
    total = 0.0
    for k in range(vectors.shape[1]):
        total += vectors[PULL, k]
    return bool(np.isfinite(total))
