"""Levenberg–Marquardt for affine laws without a step of Python in between.

The iteration is that of `softid.fitters.levenberg_marquardt.minimise`, which explains it.
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
    small_solve,
)
from softid.kernels.affine_evaluation import bend, evaluate
from softid.kernels.affine_work import Drive, Measured, Room, Rules, Unknowns
from softid.kernels.decorators import inner, kernel, written_out
from softid.kernels.small_solve import damped_step, solve_in_place
from softid.kernels.sources import follow_sources

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

ENDED, GOES_ON, SHORTENED, SINGULAR, NEEDS_COLUMNS = 0, 1, 2, 3, 4
"""What a part of the iteration says. `descend` ends as `minimise` would, before a system that has
no single solution, or before a step so long that its bend must be known while no columns are kept.
"""

COST, DAMPING, GROWTH, USED, NEXT_LOOK, SEEN, PREDICTED = 0, 1, 2, 3, 4, 5, 6
"""Where the numbers of the iteration stand."""


@written_out
def _find_movable(unknowns: Unknowns, room: Room, side: int, moving: BoolArray) -> int:
    """Mark the unknowns inside their bounds or pulled inward, and count them."""
    count = 0
    for k in range(moving.size):
        z, pull = room.point[side, k], room.gradient[side, k]
        low, high = unknowns.lower[k], unknowns.upper[k]
        stuck = (z <= low and pull < 0.0) or (z >= high and pull > 0.0)
        moving[k] = not stuck and high > low
        count += moving[k]
    return count


@written_out
def _find_offset(
    unknowns: Unknowns, room: Room, side: int, moving: BoolArray, count: int, cost: float, n: int
) -> float:
    """`attainable_offset`; NaN where its system is singular."""
    if count == 0:
        return 0.0
    variance = max(2.0 * cost / max(n - count, 1), 1e-300)
    matrix, gradient, reach = room.matrix[side], room.gradient[side], unknowns.reach
    right, scale = room.solve[moving.size], room.small[1]
    m = 0
    for i in range(moving.size):
        scale[i] = 1.0 / np.sqrt(matrix[i, i] + variance / (reach[i] * reach[i]))
    for i in range(moving.size):
        if moving[i]:
            k = 0
            for j in range(moving.size):
                if moving[j]:
                    room.solve[m, k] = matrix[i, j] * scale[i] * scale[j]
                    k += 1
            room.solve[m, m] = 1.0
            right[m] = gradient[i] * scale[i]
            m += 1
    if not solve_in_place(room.solve, right, m):
        return np.nan
    gain, m = 0.0, 0
    for i in range(moving.size):
        if moving[i]:
            gain += right[m] * gradient[i] * scale[i]
            m += 1
    return float(np.sqrt(max(gain, 0.0) / count / variance))


@inner
def _longest(step: Array, reach: Array) -> float:
    """Largest share of what is plausible that a step moves an unknown by."""
    most = 0.0
    for k in range(step.size):
        most = max(most, abs(step[k]) / reach[k])
    return most


@inner
def _length(step: Array, reach: Array) -> float:
    total = 0.0
    for k in range(step.size):
        total += (step[k] / reach[k]) ** 2
    return float(np.sqrt(total))


@written_out
def _predicted(unknowns: Unknowns, room: Room, side: int, step: Array) -> float:
    """Fall of the cost along a straight step, cut at the bounds."""
    gradient, matrix, cut = room.gradient[side], room.matrix[side], room.small[1]
    for k in range(step.size):
        z = room.point[side, k]
        cut[k] = min(max(z + step[k], unknowns.lower[k]), unknowns.upper[k]) - z
    gain = 0.0
    for k in range(step.size):
        pull = gradient[k]
        for j in range(step.size):
            pull -= 0.5 * matrix[k, j] * cut[j]
        gain += cut[k] * pull
    return gain


@written_out
def _try(unknowns: Unknowns, room: Room, side: int, step: Array, smallest: float) -> bool:
    """Put the trial into the other place; False where it is no step at all."""
    moved = False
    for k in range(step.size):
        z = room.point[side, k]
        there = min(max(z + step[k], unknowns.lower[k]), unknowns.upper[k])
        room.point[1 - side, k] = there
        moved = moved or not abs(there - z) <= smallest * (abs(z) + smallest)
    return moved


@written_out
def _shorter_damping(
    unknowns: Unknowns, room: Room, side: int, moving: BoolArray, held: Array, damping: float,
    length: float, doublings: int, step: Array,
) -> float:  # fmt: skip
    """The least damping, in doublings, at which the step is no longer than ``length``."""
    trial = max(damping, 1e-300)
    matrix, gradient = room.matrix[side], room.gradient[side]
    for _ in range(doublings):
        trial *= 2.0
        sound = damped_step(matrix, gradient, moving, held, trial, room.solve, step)
        if sound and _length(step, unknowns.reach) <= length:
            break
    return trial


@written_out
def _settled(
    unknowns: Unknowns, room: Room, rules: Rules, side: int, n: int, moving: BoolArray, now: Array
) -> int:
    """ENDED at the optimum or near it without progress, SINGULAR, or GOES_ON."""
    cost = now[COST]
    count = _find_movable(unknowns, room, side, moving)
    offset = _find_offset(unknowns, room, side, moving, count, cost, n)
    if np.isnan(offset):
        return SINGULAR
    if offset <= rules.tolerance or count == 0:
        return ENDED
    if now[USED] >= now[NEXT_LOOK]:
        variance = 2.0 * cost / max(n - moving.size, 1)
        slow = now[SEEN] - cost < rules.stall_gain * variance
        now[NEXT_LOOK], now[SEEN] = now[USED] + rules.stall_evaluations, cost
        if slow and offset <= rules.stall_offset:
            return ENDED
    return GOES_ON


@written_out
def _propose(
    drive: Drive, measured: Measured, unknowns: Unknowns, room: Room, rules: Rules,
    side: int, moving: BoolArray, held: Array, now: Array, step: Array, bent: Array,
) -> int:  # fmt: skip
    """The next step; SHORTENED where it bends so much that a shorter one must be looked at."""
    matrix, solve = room.matrix[side], room.solve
    if not damped_step(matrix, room.gradient[side], moving, held, now[DAMPING], solve, step):
        return SINGULAR
    longest = _longest(step, unknowns.reach)
    if longest > rules.largest_step:
        _add(step, rules.largest_step / longest - 1.0, step)
        longest = rules.largest_step
    now[PREDICTED] = _predicted(unknowns, room, side, step)
    if longest <= rules.short_step:
        return GOES_ON
    if not room.x.size:
        return NEEDS_COLUMNS if rules.bends else GOES_ON
    there, pull, correction = bent[0], bent[1], bent[2]
    sound = bend(drive, measured, unknowns, room, side, step, rules.bend_step, there, pull)
    now[USED] += 1.0
    if not sound:
        return GOES_ON
    if not damped_step(matrix, pull, moving, held, now[DAMPING], solve, correction):
        return SINGULAR
    length = _length(step, unknowns.reach)
    share = 0.5 * _length(correction, unknowns.reach) / length
    if 2.0 * share <= rules.most_bend:
        _add(step, -0.5, correction)
        return GOES_ON
    least = rules.less_bend * rules.most_bend / (2.0 * share)
    shorter = max(least, rules.most_shortened) * length
    now[DAMPING] = _shorter_damping(
        unknowns, room, side, moving, held, now[DAMPING], shorter, rules.doublings, step
    )
    now[GROWTH] = 2.0
    return SHORTENED


@inner
def _accepts(rules: Rules, then: float, now: Array) -> bool:
    """Whether a trial is better; moves the damping."""
    gained = now[COST] - then
    if np.isfinite(then) and gained > 0.0 and now[PREDICTED] > 0.0:
        ratio = min(gained / now[PREDICTED], 1.5)
        now[DAMPING] *= max(rules.largest_decrease, 1.0 - (2.0 * ratio - 1.0) ** 3)
        now[GROWTH], now[COST] = 2.0, then
        return True
    now[DAMPING] *= now[GROWTH]
    now[GROWTH] *= 2.0
    return False


@inner
def _add(step: Array, factor: float, more: Array) -> None:
    """Array expressions would load scipy's linear algebra with the kernel."""
    for k in range(step.size):
        step[k] += factor * more[k]


@inner
def _scale(reach: Array, floor: float, held: Array) -> None:
    """1/reach, none less than ``floor`` times the largest."""
    most = 0.0
    for k in range(reach.size):
        most = max(most, 1.0 / reach[k])
    for k in range(reach.size):
        held[k] = max(1.0 / reach[k], floor * most)


@written_out
def _first_damping(unknowns: Unknowns, room: Room, initial: float) -> float:
    most = 0.0
    for k in range(unknowns.reach.size):
        most = max(most, room.matrix[0, k, k] * unknowns.reach[k] * unknowns.reach[k])
    return initial * most


@written_out
def _next(
    drive: Drive, measured: Measured, unknowns: Unknowns, room: Room, rules: Rules, side: int,
    n: int, moving: BoolArray, held: Array, now: Array, step: Array, bent: Array, evaluations: int,
) -> int:  # fmt: skip
    """Put the next trial into the other place; anything but GOES_ON where there is none."""
    how = SHORTENED
    while how == SHORTENED:
        if now[USED] >= evaluations or not np.isfinite(now[COST]):
            return ENDED
        if now[DAMPING] > rules.most_damping:
            return ENDED
        how = _settled(unknowns, room, rules, side, n, moving, now)
        if how == GOES_ON:
            how = _propose(
                drive, measured, unknowns, room, rules, side, moving, held, now, step, bent
            )
    if how == GOES_ON and not _try(unknowns, room, side, step, rules.smallest_step):
        return ENDED
    return how


@kernel
def descend(
    drive: Drive,
    measured: Measured,
    unknowns: Unknowns,
    room: Room,
    rules: Rules,
    evaluations: int,
    damping: float,
) -> tuple[int, int, int, float, float, int, float]:
    """Minimise from ``room.point[0]``, which lies within the bounds.

    Parameters
    ----------
    drive, measured, unknowns, room
        See `softid.kernels.affine_work`.
    rules
        Constants of the iteration.
    evaluations
        Limit of evaluations.
    damping
        That of a run that goes on; negative begins anew.

    Returns
    -------
    how, side, used, cost, damping, n, offset
        SINGULAR or NEEDS_COLUMNS where another run must go on, else anything; the place of the room
        that holds the end; evaluations; cost there with the prior; damping at the end; residuals;
        `attainable_offset` at the end, NaN where its system is singular.
    """
    size = unknowns.reach.size
    moving, step, bent = np.empty(size, np.bool_), np.empty(size), np.empty((3, size))
    held = np.empty(size)
    _scale(unknowns.reach, rules.scale_floor, held)
    now = np.empty(7)
    now[USED], now[GROWTH], now[NEXT_LOOK], now[SEEN] = 0.0, 2.0, rules.stall_evaluations, np.inf
    now[COST], now[PREDICTED] = np.inf, np.inf
    side = int(now[USED])  # a literal 0 would have everything compiled once more for it
    place = side
    while True:  # with one call of `evaluate`, of which the compiler writes out every one
        then, n = evaluate(drive, measured, unknowns, room, place)
        now[USED] += 1.0
        if now[USED] == 1.0:
            now[COST] = then
            fresh = damping < 0.0
            now[DAMPING] = (
                _first_damping(unknowns, room, rules.initial_damping) if fresh else damping
            )
        elif _accepts(rules, then, now):
            side = place
        how = _next(
            drive, measured, unknowns, room, rules, side, n, moving, held, now, step, bent,
            evaluations,
        )  # fmt: skip
        if how != GOES_ON:
            break
        place = 1 - side
    offset = np.inf
    if np.isfinite(now[COST]):
        count = _find_movable(unknowns, room, side, moving)
        offset = _find_offset(unknowns, room, side, moving, count, now[COST], n)
    return how, side, int(now[USED]), now[COST], now[DAMPING], n, offset


follow_sources(
    descend,
    (
        affine_blocks,
        affine_evaluation,
        affine_steps,
        affine_work,
        exponential,
        lanes,
        small_solve,
    ),
)
