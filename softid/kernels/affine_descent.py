"""Levenberg–Marquardt for affine laws without a step of Python in between.

The iteration is that of `softid.fitters.levenberg_marquardt.minimise`, which explains it.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

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
from softid.kernels.decorators import kernel
from softid.kernels.small_solve import damped_step, solve_in_place
from softid.kernels.sources import follow_sources

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

ENDED, SINGULAR = 0, 1
"""How `descend` ends: as `minimise` would, or before a system that has no single solution."""


@njit(nogil=True, error_model="numpy")
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


@njit(nogil=True, error_model="numpy")
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


@njit(nogil=True, error_model="numpy")
def _longest(step: Array, reach: Array) -> float:
    """Largest share of what is plausible that a step moves an unknown by."""
    most = 0.0
    for k in range(step.size):
        most = max(most, abs(step[k]) / reach[k])
    return most


@njit(nogil=True, error_model="numpy")
def _length(step: Array, scale: Array) -> float:
    total = 0.0
    for k in range(step.size):
        total += (scale[k] * step[k]) ** 2
    return float(np.sqrt(total))


@njit(nogil=True, error_model="numpy")
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


@njit(nogil=True, error_model="numpy")
def _try(unknowns: Unknowns, room: Room, side: int, step: Array, smallest: float) -> bool:
    """Put the trial into the other place; False where it is no step at all."""
    moved = False
    for k in range(step.size):
        z = room.point[side, k]
        there = min(max(z + step[k], unknowns.lower[k]), unknowns.upper[k])
        room.point[1 - side, k] = there
        moved = moved or not abs(there - z) <= smallest * (abs(z) + smallest)
    return moved


@njit(nogil=True, error_model="numpy")
def _shorter_damping(
    room: Room, side: int, moving: BoolArray, scale: Array, damping: float, length: float,
    doublings: int, step: Array,
) -> float:  # fmt: skip
    """The least damping, in doublings, at which the step is no longer than ``length``."""
    trial = max(damping, 1e-300)
    matrix, gradient = room.matrix[side], room.gradient[side]
    for _ in range(doublings):
        trial *= 2.0
        sound = damped_step(matrix, gradient, moving, scale, trial, room.solve, step)
        if sound and _length(step, scale) <= length:
            break
    return trial


@kernel
def descend(
    drive: Drive,
    measured: Measured,
    unknowns: Unknowns,
    room: Room,
    rules: Rules,
    evaluations: int,
    damping: float,
) -> tuple[int, int, int, float, float]:
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
    how, side, used, cost, damping
        ENDED or SINGULAR; the place of the room that holds the end; evaluations; cost there with
        the prior; damping at the end.
    """
    size = unknowns.reach.size
    moving = np.empty(size, np.bool_)
    step, pull, correction, there = (
        np.empty(size), np.empty(size), np.empty(size), np.empty(size),
    )  # fmt: skip
    scale = 1.0 / unknowns.reach
    held = np.maximum(scale, rules.scale_floor * scale.max())
    side, used, growth, next_look, seen = 0, 1, 2.0, rules.stall_evaluations, np.inf
    cost, n = evaluate(drive, measured, unknowns, room, side)
    if damping < 0.0:
        damping = 0.0
        for k in range(size):
            damping = max(damping, room.matrix[side, k, k] / (scale[k] * scale[k]))
        damping *= rules.initial_damping
    while used < evaluations and np.isfinite(cost):
        count = _find_movable(unknowns, room, side, moving)
        offset = _find_offset(unknowns, room, side, moving, count, cost, n)
        if np.isnan(offset):
            return SINGULAR, side, used, cost, damping
        if offset <= rules.tolerance or count == 0:
            break
        if used >= next_look:
            variance = 2.0 * cost / max(n - size, 1)
            slow = seen - cost < rules.stall_gain * variance
            next_look, seen = used + rules.stall_evaluations, cost
            if slow and offset <= rules.stall_offset:
                break
        if not damped_step(
            room.matrix[side], room.gradient[side], moving, held, damping, room.solve, step
        ):
            return SINGULAR, side, used, cost, damping
        longest = _longest(step, unknowns.reach)
        if longest > rules.largest_step:
            step *= rules.largest_step / longest
            longest = rules.largest_step
        predicted = _predicted(unknowns, room, side, step)
        if room.x.size and longest > rules.short_step:
            sound = bend(drive, measured, unknowns, room, side, step, rules.bend_step, there, pull)
            used += 1
            if sound:
                if not damped_step(
                    room.matrix[side], pull, moving, held, damping, room.solve, correction
                ):
                    return SINGULAR, side, used, cost, damping
                length = _length(step, scale)
                share = 0.5 * _length(correction, scale) / length
                if 2.0 * share <= rules.most_bend:
                    step -= 0.5 * correction
                else:
                    least = rules.less_bend * rules.most_bend / (2.0 * share)
                    damping = _shorter_damping(
                        room, side, moving, held, damping,
                        max(least, rules.most_shortened) * length, rules.doublings, step,
                    )  # fmt: skip
                    growth = 2.0
                    continue
        if not _try(unknowns, room, side, step, rules.smallest_step):
            break
        then, _ = evaluate(drive, measured, unknowns, room, 1 - side)
        used += 1
        gained = cost - then
        if np.isfinite(then) and gained > 0.0 and predicted > 0.0:
            ratio = min(gained / predicted, 1.5)
            damping *= max(rules.largest_decrease, 1.0 - (2.0 * ratio - 1.0) ** 3)
            growth, side, cost = 2.0, 1 - side, then
        elif damping > rules.most_damping:
            break
        else:
            damping, growth = damping * growth, growth * 2.0
    return ENDED, side, used, cost, damping


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
