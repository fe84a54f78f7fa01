"""Derivatives of the states over one step, from the factors that its solution left."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inlined
from softid.kernels.equation import Equation, unbalanced
from softid.kernels.radau import B1, A
from softid.kernels.small_matrix import solve_columns
from softid.kernels.stages import Step

Array = npt.NDArray[np.float64]


@inlined
def _by_parameters(
    equation: Equation, step: Step, coefficients_by: Array, moves: Array, by: Array
) -> None:
    """Derivatives by (θ, η) of the unbalanced force and the own rates at the solved stages.

    ``by`` has shape (3, 1 + Z, K + H).
    """
    at, kept = step.at, step.kept
    n_own = at.points.shape[1] - 3
    n_theta = equation.theta.size
    for c in range(3):
        left = unbalanced(equation, at, c)
        for k in range(n_own):
            kept[k] = at.rates[c, k]
        m, d = at.parts[c, 0] * at.points[c, 2 + n_own], at.parts[c, 1] * at.points[c, 1]
        q = at.parts[c, 2] * at.parts[c, 3]
        if equation.law == 0:
            for p in range(n_theta):
                by[c, 0, p] = (
                    coefficients_by[c, 0, p] * m
                    + coefficients_by[c, 1, p] * d
                    + coefficients_by[c, 2, p] * q
                    - coefficients_by[c, 3, p]
                )
        for p in range(0 if equation.law != 0 else n_theta, by.shape[2]):
            vector = equation.theta if p < n_theta else equation.eta
            place = p if p < n_theta else p - n_theta
            here = vector[place]
            vector[place] = here + moves[p]
            moved = unbalanced(equation, at, c)
            vector[place] = here
            by[c, 0, p] = (moved - left) / moves[p]
            for k in range(n_own):
                by[c, 1 + k, p] = (at.rates[c, k] - kept[k]) / moves[p]
        unbalanced(equation, at, c)


@inlined
def carry(
    equation: Equation,
    step: Step,
    coefficients_by: Array,
    moves: Array,
    by: Array,
    rhs: Array,
    tangent: Array,
    h: float,
) -> None:
    """Carry the derivatives of the states over a solved step.

    Parameters
    ----------
    equation, step, h
        As `solve_stages` left them.
    coefficients_by
        Derivatives of the affine law's coefficients at the stages, shape (3, 4, K).
    moves
        By how much each parameter is moved to differentiate, shape (K + H,).
    by, rhs
        Room: zeros in shape (3, 1 + Z, K + H), and shape (3 + 3 Z, K + H + 2).
    tangent
        ∂(x, v, own states)/∂(θ, η, x₀, v₀), shape (2 + Z, K + H + 2); overwritten.
    """
    n_own = tangent.shape[0] - 2
    _by_parameters(equation, step, coefficients_by, moves, by)
    for c in range(3):
        heavy = step.at.parts[c, 4] * step.at.parts[c, 0] / h * B1[c]
        slope = step.slopes[c, 0, 0]
        for p in range(tangent.shape[1]):
            rhs[c, p] = heavy * tangent[1, p] - slope * tangent[0, p]
        for p in range(by.shape[2]):
            rhs[c, p] -= by[c, 0, p]
        for k in range(n_own):
            row, slope = 3 * (k + 1) + c, step.slopes[c, 2 + k, 0]
            along_x, along_own = step.slopes[c, 0, 1 + k], step.slopes[c, 2 + k, 1 + k]
            for p in range(tangent.shape[1]):
                rhs[c, p] -= slope * tangent[2 + k, p]
                rhs[row, p] = along_x * tangent[0, p] + along_own * tangent[2 + k, p]
            for p in range(by.shape[2]):
                rhs[row, p] += by[c, 1 + k, p]
    solve_columns(step.matrix, step.order, rhs)
    for p in range(tangent.shape[1]):
        tangent[0, p] += h * (A[2, 0] * rhs[0, p] + A[2, 1] * rhs[1, p] + A[2, 2] * rhs[2, p])
        tangent[1, p] = rhs[2, p]
    for k in range(n_own):
        first = 3 * (k + 1)
        for p in range(tangent.shape[1]):
            tangent[2 + k, p] += h * (
                A[2, 0] * rhs[first, p] + A[2, 1] * rhs[first + 1, p] + A[2, 2] * rhs[first + 2, p]
            )
