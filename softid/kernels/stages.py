"""One step of three-stage Radau IIA for an equation of motion with extra terms."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.equation import Equation, Instant, unbalanced
from softid.kernels.radau import B1, A, B
from softid.kernels.small_matrix import factorise, solve

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]

MAX_NEWTON = 12
NEWTON_TOLERANCE = 1e-7
DIFFERENCE = 1e-7
"""Relative step of the numerical derivatives at the stages, and of Newton's last one."""


class Step(NamedTuple):
    """A step and room for its stages; Z is the number of own states.

    Unknown 3k + c of the stage equations is the rate of state k at stage c, where k = 0 is the
    position and k = 1 … Z are the own states.

    Attributes
    ----------
    place
        Time and input at the stages, shape (2, 3).
    coefficients
        m, n, q and f of the affine law at the stages, shape (3, 4).
    scale
        Ranges of x, v and the own states, shape (2 + Z,).
    w
        The unknowns, shape (3 + 3 Z,).
    residual
        What the stage equations leave, shape (3 + 3 Z,).
    matrix, order
        Their Jacobian or its factors, shapes (3 + 3 Z, 3 + 3 Z) and (3 + 3 Z,).
    points
        x, v, own states and, last, the acceleration at each stage, shape (3, 3 + Z).
    parts
        Those of `Instant` at each stage, shape (3, 5).
    slopes
        Derivatives by x, v and the own states of the unbalanced force and of the own rates at each
        stage, shape (3, 2 + Z, 1 + Z).
    here, there
        Room for single instants.
    """

    place: Array
    coefficients: Array
    scale: Array
    w: Array
    residual: Array
    matrix: Array
    order: Index
    points: Array
    parts: Array
    slopes: Array
    here: Instant
    there: Instant


@njit(cache=True, nogil=True, error_model="numpy")
def _evaluate_stage(equation: Equation, step: Step, c: int) -> None:
    """Residual, parts and slopes at the point of one stage."""
    point = step.points[c]
    n_own = point.size - 3
    z, a = point[2 : 2 + n_own], point[2 + n_own]
    t, u, coefficients = step.place[0, c], step.place[1, c], step.coefficients[c]
    here, there = step.here, step.there
    left = unbalanced(equation, coefficients, point[0], point[1], a, z, u, t, here)
    step.residual[c] = left
    step.parts[c] = here.parts
    for k in range(n_own):
        step.residual[3 * (k + 1) + c] = step.w[3 * (k + 1) + c] - here.rates[k]
    for s in range(2 + n_own):
        kept = point[s]
        d = DIFFERENCE * step.scale[s]
        point[s] = kept + d
        moved = unbalanced(equation, coefficients, point[0], point[1], a, z, u, t, there)
        point[s] = kept
        step.slopes[c, s, 0] = (moved - left) / d
        for k in range(n_own):
            step.slopes[c, s, 1 + k] = (there.rates[k] - here.rates[k]) / d


@njit(cache=True, nogil=True, error_model="numpy")
def linearise(equation: Equation, step: Step, state: Array, h: float) -> None:
    """Residual and Jacobian of the stage equations at ``step.w``, from ``state`` over ``h``."""
    n_own = state.size - 2
    points, slopes, matrix, w = step.points, step.slopes, step.matrix, step.w
    matrix[:, :] = 0.0
    for c in range(3):
        points[c, 0], points[c, 1], points[c, 2 + n_own] = state[0], w[c], -B1[c] * state[1] / h
        for j in range(3):
            points[c, 0] += h * A[c, j] * w[j]
            points[c, 2 + n_own] += B[c, j] * w[j] / h
        for k in range(n_own):
            points[c, 2 + k] = state[2 + k]
            for j in range(3):
                points[c, 2 + k] += h * A[c, j] * w[3 * (k + 1) + j]
        _evaluate_stage(equation, step, c)
        heavy = step.parts[c, 4] * step.parts[c, 0] / h
        matrix[c, c] = slopes[c, 1, 0]
        for j in range(3):
            matrix[c, j] += heavy * B[c, j] + slopes[c, 0, 0] * h * A[c, j]
        for k in range(n_own):
            row, first = 3 * (k + 1) + c, 3 * (k + 1)
            matrix[row, row] = 1.0
            matrix[row, c] -= slopes[c, 1, 1 + k]
            for j in range(3):
                matrix[c, first + j] += slopes[c, 2 + k, 0] * h * A[c, j]
                matrix[row, j] -= slopes[c, 0, 1 + k] * h * A[c, j]
                matrix[row, first + j] -= slopes[c, 2 + k, 1 + k] * h * A[c, j]


@njit(cache=True, nogil=True, error_model="numpy")
def solve_stages(equation: Equation, step: Step, state: Array, h: float) -> bool:
    """Find the stages by Newton's method from ``step.w``; False when it does not converge.

    The factors of the last Jacobian stay in ``step``.
    """
    for _ in range(MAX_NEWTON):
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
        if worst < NEWTON_TOLERANCE:
            return True
    return False


@njit(cache=True, nogil=True, error_model="numpy")
def advance(step: Step, state: Array, h: float) -> None:
    """Move the state to the end of a solved step."""
    for j in range(3):
        state[0] += h * A[2, j] * step.w[j]
        for k in range(state.size - 2):
            state[2 + k] += h * A[2, j] * step.w[3 * (k + 1) + j]
    state[1] = step.w[2]
