"""Derivatives of the states over one step, from the inverse that its solution left."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inlined
from softid.kernels.equation import Equation, unbalanced
from softid.kernels.radau import B1, A
from softid.kernels.small_matrix import LANES, multiply_columns
from softid.kernels.stages import Step

Array = npt.NDArray[np.float64]


@inlined
def _force_by_parameters(
    equation: Equation, step: Step, coefficients_by: Array, moves: Array, rhs: Array
) -> None:
    """Take the derivatives by (θ, η) of force and own rates at the stages from ``rhs``."""
    at, residual = step.at, step.residual
    n_own = at.points.shape[1] - 3
    n_theta = equation.theta.size
    for c in range(3):
        m, d = at.parts[c, 0] * at.points[c, 2 + n_own], at.parts[c, 1] * at.points[c, 1]
        q = at.parts[c, 2] * at.parts[c, 3]
        first_moved = 0
        if equation.law == 0:
            first_moved = n_theta
            for f in range(coefficients_by.shape[2]):
                for lane in range(LANES):
                    rhs[c, f, lane] -= (
                        coefficients_by[c, 0, f, lane] * m
                        + coefficients_by[c, 1, f, lane] * d
                        + coefficients_by[c, 2, f, lane] * q
                        - coefficients_by[c, 3, f, lane]
                    )
        for p in range(first_moved, moves.size):
            if moves[p] == 0.0:
                continue
            vector = equation.theta if p < n_theta else equation.eta
            place = p if p < n_theta else p - n_theta
            here = vector[place]
            vector[place] = here + moves[p]
            moved = unbalanced(equation, at, c)
            vector[place] = here
            rhs[c, p // LANES, p % LANES] -= (moved - residual[c]) / moves[p]
            for k in range(n_own):
                row = 3 * (k + 1) + c
                rate = step.w[row] - residual[row]
                rhs[row, p // LANES, p % LANES] += (at.rates[c, k] - rate) / moves[p]


@inlined
def carry(
    equation: Equation,
    step: Step,
    coefficients_by: Array,
    moves: Array,
    rhs: Array,
    rates: Array,
    tangent: Array,
    h: float,
) -> None:
    """Carry the derivatives of the states over a solved step.

    Columns stand for (θ, η, x₀, v₀), in G groups of `LANES` filled up with zeros.

    Parameters
    ----------
    equation, step, h
        As `solve_stages` left them when asked to be exact.
    coefficients_by
        Derivatives of the affine law's coefficients at the stages, shape (3, 4, groups, LANES).
    moves
        By how much each parameter is moved to differentiate, shape (K + H,); zero for a constant.
    rhs, rates
        Room, each of shape (3 + 3 Z, G, LANES).
    tangent
        Derivatives of (x, v, own states), shape (2 + Z, G, LANES); overwritten.
    """
    n_own = tangent.shape[0] - 2
    groups = tangent.shape[1]
    for c in range(3):
        heavy = step.at.parts[c, 4] * step.at.parts[c, 0] / h * B1[c]
        slope = step.slopes[c, 0, 0]
        for f in range(groups):
            for lane in range(LANES):
                rhs[c, f, lane] = heavy * tangent[1, f, lane] - slope * tangent[0, f, lane]
        for k in range(n_own):
            row, slope = 3 * (k + 1) + c, step.slopes[c, 2 + k, 0]
            along_x, along_own = step.slopes[c, 0, 1 + k], step.slopes[c, 2 + k, 1 + k]
            for f in range(groups):
                for lane in range(LANES):
                    rhs[c, f, lane] -= slope * tangent[2 + k, f, lane]
                    rhs[row, f, lane] = (
                        along_x * tangent[0, f, lane] + along_own * tangent[2 + k, f, lane]
                    )
    _force_by_parameters(equation, step, coefficients_by, moves, rhs)
    multiply_columns(step.matrix, rhs, rates)
    for f in range(groups):
        for lane in range(LANES):
            tangent[0, f, lane] += h * (
                A[2, 0] * rates[0, f, lane]
                + A[2, 1] * rates[1, f, lane]
                + A[2, 2] * rates[2, f, lane]
            )
            tangent[1, f, lane] = rates[2, f, lane]
    for k in range(n_own):
        row = 3 * (k + 1)
        for f in range(groups):
            for lane in range(LANES):
                tangent[2 + k, f, lane] += h * (
                    A[2, 0] * rates[row, f, lane]
                    + A[2, 1] * rates[row + 1, f, lane]
                    + A[2, 2] * rates[row + 2, f, lane]
                )
