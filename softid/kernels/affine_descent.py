"""Levenberg–Marquardt for affine laws without a step of Python in between.

The iteration is that of `softid.fitters.levenberg_marquardt.minimise`, which explains it; arrays
are those of `softid.kernels.affine_work`.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels import (
    affine_blocks,
    affine_evaluation,
    affine_steps,
    affine_work,
    exponential,
    lanes,
    rules,
    small_solve,
)
from softid.kernels.affine_evaluation import add_up, bend, move_zeros, sum_pieces
from softid.kernels.affine_work import (
    CHUNK,
    CORRECTION,
    COST,
    CUT,
    DAMPING,
    GRADIENT,
    GROWTH,
    HELD,
    LOWER,
    MOVING,
    NEXT_LOOK,
    NOW,
    POINT,
    PREDICTED,
    PULL,
    REACH,
    SCALE,
    SEEN,
    STEP,
    UPPER,
    USED,
)
from softid.kernels.decorators import inner, kernel, written_out
from softid.kernels.lanes import N_PARAMETERS, N_STATES, POINTS, SIZE
from softid.kernels.rules import (
    DOUBLINGS,
    INITIAL_DAMPING,
    LARGEST_DECREASE,
    LARGEST_STEP,
    LESS_BEND,
    MOST_BEND,
    MOST_DAMPING,
    MOST_SHORTENED,
    SCALE_FLOOR,
    SHORT_STEP,
    SMALLEST_STEP,
    STALL_EVALUATIONS,
    STALL_GAIN,
    STALL_OFFSET,
)
from softid.kernels.small_solve import damped_step, solve_in_place
from softid.kernels.sources import follow_sources

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]
Counts = npt.NDArray[np.int16]
BoolArray = npt.NDArray[np.bool_]

ENDED, GOES_ON, SHORTENED, SINGULAR, NEEDS_COLUMNS, LONG = 0, 1, 2, 3, 4, 5
"""What a part of the iteration says. `descend` ends as `minimise` would, before a system that has
no single solution, or before a step so long that its bend must be known while no columns are kept.
"""


@inner
def _find_offset(vectors: Array, matrices: Array, solve: Array, side: int, n: int) -> float:
    """`attainable_offset`; NaN where its system is singular. Marks what moves."""
    size, pull, count = solve.shape[1], GRADIENT + side, 0
    for k in range(size):
        z, down = vectors[POINT + side, k], vectors[pull, k]
        low, high = vectors[LOWER, k], vectors[UPPER, k]
        stuck = (z <= low and down < 0.0) or (z >= high and down > 0.0) or not high > low
        vectors[MOVING, k] = 0.0 if stuck else 1.0
        count += not stuck
    if count == 0:
        return 0.0
    variance = max(2.0 * vectors[NOW, COST] / max(n - count, 1), 1e-300)
    first = side * size
    for i in range(size):
        reach = vectors[REACH, i]
        vectors[SCALE, i] = 1.0 / np.sqrt(matrices[first + i, i] + variance / (reach * reach))
    m = int(np.int64(0))  # a literal would have what it is given to compiled once more
    for i in range(size):
        if vectors[MOVING, i] != 0.0:
            k = 0
            for j in range(size):
                if vectors[MOVING, j] != 0.0:
                    both = matrices[first + i, j] * vectors[SCALE, i] * vectors[SCALE, j]
                    solve[m, k] = 1.0 if i == j else both
                    k += 1
            solve[size, m] = vectors[pull, i] * vectors[SCALE, i]
            m += 1
    if not solve_in_place(solve, m):
        return np.nan
    gain, m = 0.0, 0
    for i in range(size):
        if vectors[MOVING, i] != 0.0:
            gain += solve[size, m] * vectors[pull, i] * vectors[SCALE, i]
            m += 1
    return float(np.sqrt(max(gain, 0.0) / count / variance))


@inner
def _length(vectors: Array, row: int, size: int) -> float:
    total = 0.0
    for k in range(size):
        total += (vectors[row, k] / vectors[REACH, k]) ** 2
    return float(np.sqrt(total))


@inner
def _predicted(vectors: Array, matrices: Array, side: int) -> float:
    """Fall of the cost along a straight step, cut at the bounds."""
    size = matrices.shape[1]
    for k in range(size):
        z = vectors[POINT + side, k]
        there = min(max(z + vectors[STEP, k], vectors[LOWER, k]), vectors[UPPER, k])
        vectors[CUT, k] = there - z
    gain = 0.0
    for k in range(size):
        pull = vectors[GRADIENT + side, k]
        for j in range(size):
            pull -= 0.5 * matrices[side * size + k, j] * vectors[CUT, j]
        gain += vectors[CUT, k] * pull
    return gain


@written_out
def _try(vectors: Array, side: int, size: int) -> bool:
    """Put the trial into the other place; False where it is no step at all."""
    moved = False
    for k in range(size):
        z = vectors[POINT + side, k]
        there = min(max(z + vectors[STEP, k], vectors[LOWER, k]), vectors[UPPER, k])
        vectors[POINT + 1 - side, k] = there
        moved = moved or not abs(there - z) <= SMALLEST_STEP * (abs(z) + SMALLEST_STEP)
    return moved


@written_out
def _settled(
    vectors: Array, matrices: Array, solve: Array, side: int, n: int, evaluations: int,
    tolerance: float,
) -> int:  # fmt: skip
    """ENDED at a limit, at the optimum or near it without progress, SINGULAR, or GOES_ON."""
    cost, used = vectors[NOW, COST], vectors[NOW, USED]
    if used >= evaluations or not np.isfinite(cost) or vectors[NOW, DAMPING] > MOST_DAMPING:
        return ENDED
    offset = _find_offset(vectors, matrices, solve, side, n)
    if np.isnan(offset):
        return SINGULAR
    if offset <= tolerance:
        return ENDED
    if used >= vectors[NOW, NEXT_LOOK]:
        variance = 2.0 * cost / max(n - solve.shape[1], 1)
        slow = vectors[NOW, SEEN] - cost < STALL_GAIN * variance
        vectors[NOW, NEXT_LOOK], vectors[NOW, SEEN] = used + STALL_EVALUATIONS, cost
        if slow and offset <= STALL_OFFSET:
            return ENDED
    return GOES_ON


@written_out
def _go_straight(vectors: Array, matrices: Array, solve: Array, side: int) -> int:
    """The next step, no longer than may be; LONG where its bend should be known."""
    size = solve.shape[1]
    damping = vectors[NOW, DAMPING]
    if not damped_step(matrices, side * size, vectors, GRADIENT + side, damping, solve, STEP):
        return SINGULAR
    longest = 0.0
    for k in range(size):
        longest = max(longest, abs(vectors[STEP, k]) / vectors[REACH, k])
    if longest > LARGEST_STEP:
        for k in range(size):
            vectors[STEP, k] *= LARGEST_STEP / longest
        longest = LARGEST_STEP
    vectors[NOW, PREDICTED] = _predicted(vectors, matrices, side)
    return LONG if longest > SHORT_STEP else GOES_ON


@written_out
def _follow_bend(vectors: Array, matrices: Array, solve: Array, side: int) -> int:
    """Correct the step; SHORTENED, with more damping, where it bends too much to be trusted."""
    size = solve.shape[1]
    first, damping = side * size, vectors[NOW, DAMPING]
    if not damped_step(matrices, first, vectors, PULL, damping, solve, CORRECTION):
        return SINGULAR
    length = _length(vectors, STEP, size)
    share = 0.5 * _length(vectors, CORRECTION, size) / length
    if 2.0 * share <= MOST_BEND:
        for k in range(size):
            vectors[STEP, k] -= 0.5 * vectors[CORRECTION, k]
        return GOES_ON
    shorter = max(LESS_BEND * MOST_BEND / (2.0 * share), MOST_SHORTENED) * length
    trial = max(damping, 1e-300)
    for _ in range(DOUBLINGS):
        trial *= 2.0
        sound = damped_step(matrices, first, vectors, GRADIENT + side, trial, solve, STEP)
        if sound and _length(vectors, STEP, size) <= shorter:
            break
    vectors[NOW, DAMPING], vectors[NOW, GROWTH] = trial, 2.0
    return SHORTENED


@written_out
def _accepts(vectors: Array, then: float) -> bool:
    """Whether a trial is better; moves the damping."""
    gained, predicted = vectors[NOW, COST] - then, vectors[NOW, PREDICTED]
    if np.isfinite(then) and gained > 0.0 and predicted > 0.0:
        bent = 2.0 * min(gained / predicted, 1.5) - 1.0
        vectors[NOW, DAMPING] *= max(LARGEST_DECREASE, 1.0 - bent * bent * bent)
        vectors[NOW, GROWTH], vectors[NOW, COST] = 2.0, then
        return True
    vectors[NOW, DAMPING] *= vectors[NOW, GROWTH]
    vectors[NOW, GROWTH] *= 2.0
    return False


@written_out
def _begin(vectors: Array, matrices: Array, cost: float, damping: float) -> None:
    """Scales and numbers of the iteration behind the first evaluation."""
    size = matrices.shape[1]
    stiffest, steepest = 0.0, 0.0
    for k in range(size):
        reach = vectors[REACH, k]
        stiffest = max(stiffest, 1.0 / reach)
        steepest = max(steepest, matrices[k, k] * reach * reach)
    for k in range(size):
        vectors[HELD, k] = max(1.0 / vectors[REACH, k], SCALE_FLOOR * stiffest)
    vectors[NOW, COST] = cost
    vectors[NOW, DAMPING] = damping if damping >= 0.0 else INITIAL_DAMPING * steepest
    vectors[NOW, GROWTH], vectors[NOW, PREDICTED] = 2.0, np.inf
    vectors[NOW, NEXT_LOOK], vectors[NOW, SEEN] = STALL_EVALUATIONS, np.inf


@kernel
def descend(
    pieces: Index, lines: Array, free: Index, time_s: Array, u: Array, counts: Counts, y: Array,
    used: BoolArray, theta: Array, vectors: Array, matrices: Array, grams: Array, first: Array,
    second: Array, x: Array, evaluations: int, tolerance: float, damping: float, bends: bool,
) -> tuple[int, int, int, float]:  # fmt: skip
    """Minimise from the row `POINT`, which lies within the bounds.

    Parameters
    ----------
    pieces, lines, free, vectors
        See `softid.kernels.affine_work`; shapes (P, 10), (P, 3), (2, F) and (26, U or 11).
    time_s, u, counts
        Sample times, input and steps per sampling interval of all segments, each of shape (N,).
    y, used
        Measured outputs and which samples count, each of shape (C·N,).
    theta
        The kernels' parameters and gain, where the free ones are overwritten, shape (8,).
    matrices, grams
        Receive JᵀJ and the products of columns at either place, shapes (2U, U) and (24·P, 12).
    first, second, x
        Receive the columns at either place, shape (11·C, N), and positions along a trial, shape
        (N,); of shapes (11·C, 0) and (0,) when none are kept.
    evaluations, tolerance
        As in `minimise`.
    damping
        That of a run that goes on; negative begins anew.
    bends
        Whether to stop before a long step where no columns are kept to tell how it bends.

    Returns
    -------
    how, side, n, offset
        SINGULAR or NEEDS_COLUMNS where another run must go on, else anything; the place that holds
        the end; residuals; `attainable_offset` at the end, NaN where its system is singular.
    """
    work, ends, at = np.empty(SIZE), np.empty(POINTS, np.int64), np.zeros(3, np.int64)
    state, tangent = np.empty(N_STATES), np.empty((N_STATES, N_PARAMETERS + N_STATES))
    away, solve = np.empty(CHUNK), np.empty((matrices.shape[1] + 1, matrices.shape[1]))
    side = at[0]  # a literal 0 would have everything compiled once more for it
    place, how = side, GOES_ON
    vectors[NOW, USED] = 0.0
    while how == GOES_ON:
        sum_pieces(
            pieces, lines, free, time_s, u, counts, y, used, theta, vectors, grams,
            second if place else first, work, ends, at, state, tangent, place,
        )  # fmt: skip
        n = move_zeros(pieces, vectors, grams, place)
        then = add_up(pieces, lines, free, theta, vectors, matrices, grams, place)
        vectors[NOW, USED] += 1.0
        if vectors[NOW, USED] == 1.0:
            _begin(vectors, matrices, then, damping)
        elif _accepts(vectors, then):
            side = place
        how = SHORTENED
        while how == SHORTENED:
            how = _settled(vectors, matrices, solve, side, n, evaluations, tolerance)
            if how == GOES_ON:
                how = _go_straight(vectors, matrices, solve, side)
            if how != LONG:
                continue
            how = GOES_ON
            if not x.size:
                how = NEEDS_COLUMNS if bends else GOES_ON
                continue
            vectors[NOW, USED] += 1.0
            if bend(
                pieces, lines, free, time_s, u, counts, y, used, theta, vectors,
                second if side else first, x, work, ends, at, state, tangent, away, side,
            ):  # fmt: skip
                how = _follow_bend(vectors, matrices, solve, side)
        if how == GOES_ON and not _try(vectors, side, solve.shape[1]):
            how = ENDED
        place = 1 - side
    offset = np.inf
    if np.isfinite(vectors[NOW, COST]):
        offset = _find_offset(vectors, matrices, solve, side, n)
    return how, side, n, offset


follow_sources(
    descend,
    (
        affine_blocks,
        affine_evaluation,
        affine_steps,
        affine_work,
        exponential,
        lanes,
        rules,
        small_solve,
    ),
)
