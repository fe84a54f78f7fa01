"""One step of three-stage Radau IIA for an equation of motion with extra terms."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inlined
from softid.kernels.equation import Equation, Instants, unbalanced
from softid.kernels.radau import B1, A, B
from softid.kernels.small_matrix import factorise, solve

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]

MAX_NEWTON = 12
NEWTON_TOLERANCE = 1e-7
SETTLED = 1e-11
"""A move is the last when what it leaves is foreseen to be less than this share of the range."""

NEAR = 1e-5
"""Largest move that a Jacobian may be away from the stages whose derivatives it gives."""

SLOW = 0.1
"""Share of the last move from which on a held Jacobian no longer pays."""

WITHIN = 1e-2
"""Largest move after which a Jacobian is held at all; farther away Newton's own pace is needed."""

DIFFERENCE = 1e-7
"""Relative step of the numerical derivatives at the stages, and of Newton's last one."""


class Step(NamedTuple):
    """A step and room for its stages; Z is the number of own states.

    Unknown 3k + c of the stage equations is the rate of state k at stage c, where k = 0 is the
    position and k = 1 … Z are the own states.

    Attributes
    ----------
    at
        The stages.
    scale
        Ranges of x, v and the own states, shape (2 + Z,).
    w
        The unknowns, shape (3 + 3 Z,).
    residual
        What the stage equations leave, shape (3 + 3 Z,).
    matrix, order
        Their Jacobian or its factors, shapes (3 + 3 Z, 3 + 3 Z) and (3 + 3 Z,).
    slopes
        Derivatives by x, v and the own states of the unbalanced force and of the own rates at each
        stage, shape (3, 2 + Z, 1 + Z).
    kept
        Room for one stage's rates and parts, shape (Z + 5,).
    """

    at: Instants
    scale: Array
    w: Array
    residual: Array
    matrix: Array
    order: Index
    slopes: Array
    kept: Array


@inlined
def _evaluate_stage(equation: Equation, step: Step, c: int) -> None:
    """Residual, parts and slopes at the point of one stage."""
    at, kept = step.at, step.kept
    points, rates, parts = at.points, at.rates, at.parts
    n_own = points.shape[1] - 3
    left = unbalanced(equation, at, c)
    step.residual[c] = left
    for k in range(n_own):
        kept[k] = rates[c, k]
        step.residual[3 * (k + 1) + c] = step.w[3 * (k + 1) + c] - kept[k]
    for i in range(5):
        kept[n_own + i] = parts[c, i]
    for s in range(2 + n_own):
        here = points[c, s]
        d = DIFFERENCE * step.scale[s]
        points[c, s] = here + d
        moved = unbalanced(equation, at, c)
        points[c, s] = here
        step.slopes[c, s, 0] = (moved - left) / d
        for k in range(n_own):
            step.slopes[c, s, 1 + k] = (rates[c, k] - kept[k]) / d
    for k in range(n_own):
        rates[c, k] = kept[k]
    for i in range(5):
        parts[c, i] = kept[n_own + i]


@inlined
def _place(step: Step, state: Array, h: float, c: int) -> None:
    """Put stage ``c`` where the unknowns say."""
    n_own = state.size - 2
    points, w = step.at.points, step.w
    x, a = state[0], -B1[c] * state[1] / h
    for j in range(3):
        x += h * A[c, j] * w[j]
        a += B[c, j] * w[j] / h
    points[c, 0], points[c, 1], points[c, 2 + n_own] = x, w[c], a
    for k in range(n_own):
        z = state[2 + k]
        for j in range(3):
            z += h * A[c, j] * w[3 * (k + 1) + j]
        points[c, 2 + k] = z


@inlined
def _leave(equation: Equation, step: Step, state: Array, h: float) -> None:
    """Residual of the stage equations alone."""
    at = step.at
    n_own = state.size - 2
    for c in range(3):
        _place(step, state, h, c)
        step.residual[c] = unbalanced(equation, at, c)
        for k in range(n_own):
            step.residual[3 * (k + 1) + c] = step.w[3 * (k + 1) + c] - at.rates[c, k]


@inlined
def linearise(equation: Equation, step: Step, state: Array, h: float) -> None:
    """Residual and Jacobian of the stage equations at ``step.w``, from ``state`` over ``h``."""
    n_own = state.size - 2
    slopes, matrix = step.slopes, step.matrix
    size = step.w.size
    for i in range(size):
        for j in range(size):
            matrix[i, j] = 0.0
    for c in range(3):
        _place(step, state, h, c)
        _evaluate_stage(equation, step, c)
        heavy = step.at.parts[c, 4] * step.at.parts[c, 0] / h
        for j in range(3):
            matrix[c, j] = heavy * B[c, j] + slopes[c, 0, 0] * h * A[c, j]
        matrix[c, c] += slopes[c, 1, 0]
        for k in range(n_own):
            row, first = 3 * (k + 1) + c, 3 * (k + 1)
            matrix[row, row] += 1.0
            matrix[row, c] -= slopes[c, 1, 1 + k]
            for j in range(3):
                matrix[c, first + j] += slopes[c, 2 + k, 0] * h * A[c, j]
                matrix[row, j] -= slopes[c, 0, 1 + k] * h * A[c, j]
                matrix[row, first + j] -= slopes[c, 2 + k, 1 + k] * h * A[c, j]


@inlined
def solve_stages(equation: Equation, step: Step, state: Array, h: float, keeps: bool) -> bool:
    """Find the stages by Newton's method from ``step.w``; False when it does not converge.

    Parameters
    ----------
    equation, step, state, h
        The terms, the step with its start values, the state that it starts from, and its length.
    keeps
        Whether the factors of a Jacobian close to the solution are to stay in ``step``. Otherwise
        the first Jacobian serves as long as it brings the stages nearer fast.
    """
    held, holds, before = False, not keeps, 0.0
    for _ in range(MAX_NEWTON):
        if held:
            _leave(equation, step, state, h)
        else:
            linearise(equation, step, state, h)
            factorise(step.matrix, step.order)
        solve(step.matrix, step.order, step.residual)
        worst = 0.0
        for i in range(step.w.size):
            move = step.residual[i]
            if not np.isfinite(move):
                return False
            step.w[i] -= move
            size = step.scale[1] if i < 3 else step.scale[2 + (i - 3) // 3] / h
            worst = max(worst, abs(move) / size)
        if worst < (SETTLED if held else NEWTON_TOLERANCE):
            return True
        if before > 0.0:
            share = worst / before
            left = worst * share if held else worst * share * share
            if left < SETTLED and share < SLOW and (worst < NEAR or not keeps):
                return True
            holds = holds and (share < SLOW or not held)
        held = holds and worst < WITHIN
        before = worst
    return False


@inlined
def advance(step: Step, state: Array, h: float) -> None:
    """Move the state to the end of a solved step."""
    for j in range(3):
        state[0] += h * A[2, j] * step.w[j]
        for k in range(state.size - 2):
            state[2 + k] += h * A[2, j] * step.w[3 * (k + 1) + j]
    state[1] = step.w[2]
