"""Derivatives of the states over one step, from the inverse that its solution left."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inlined
from softid.kernels.equation import Equation, differentiate_law, unbalanced
from softid.kernels.radau import B1, A
from softid.kernels.radau_stages import Step
from softid.kernels.small_matrix import LANES, multiply_columns, weighted_sum
from softid.kernels.terms import N_FACTORS

Array = npt.NDArray[np.float64]


class Transfer(NamedTuple):
    """How a step's end answers to its start and to forces within it; S = 2 + Z states.

    Attributes
    ----------
    weights
        Of what is added to the right-hand sides of the stage equations, shape (S, 3 + 3 Z).
    matrix
        Of the states at the start and of forces at the three stages, shape (S, S + 3).
    columns
        Derivatives of those states and forces, shape (S + 3, groups, LANES).
    factors
        Of the derivatives of m, n, q and f in that of the force, shape (4,).
    """

    weights: Array
    matrix: Array
    columns: Array
    factors: Array


@inlined
def _weigh(step: Step, weights: Array, h: float) -> None:
    """States at the end of the step by the right-hand sides of its stage equations.

    The end follows from the stages' velocities directly and, for an own state, from its rates,
    which answer to the velocities by G; the velocities answer to the own right-hand sides by F.
    """
    n_own = len(step.own)
    for s in range(2 + n_own):
        for j in range(3):
            found = 0.0
            for i in range(3):
                if s == 0:
                    share = h * A[2, i]
                elif s == 1:
                    share = 1.0 if i == 2 else 0.0
                else:
                    share = 0.0
                    for c in range(3):
                        share -= h * A[2, c] * step.back[s - 2, c, i]
                found += share * step.inverse[0, i, j]
            weights[s, j] = found
        for k in range(n_own):
            for j in range(3):
                found = 0.0
                for c in range(3):
                    found -= weights[s, c] * step.forth[k, c, j]
                    if s == 2 + k:
                        found += h * A[2, c] * step.inverse[1 + k, c, j]
                weights[s, 3 * (k + 1) + j] = found


@inlined
def _answer(step: Step, transfer: Transfer, h: float) -> None:
    """States at the end by those at the start and by forces at the stages."""
    weights, matrix, slopes = transfer.weights, transfer.matrix, step.slopes
    n_own = len(step.own)
    for s in range(2 + n_own):
        by_x, by_v = 1.0 if s == 0 else 0.0, 0.0
        for c in range(3):
            heavy = step.at.parts[c, 4] * step.at.parts[c, 0] / h * B1[c]
            by_x -= weights[s, c] * slopes[c, 0, 0]
            by_v += weights[s, c] * heavy
            matrix[s, 2 + n_own + c] = -weights[s, c]
        for k in range(n_own):
            by_own = 1.0 if s == 2 + k else 0.0
            for c in range(3):
                own = weights[s, 3 * (k + 1) + c]
                by_x += own * slopes[c, 0, 1 + k]
                by_own += own * slopes[c, 2 + k, 1 + k] - weights[s, c] * slopes[c, 2 + k, 0]
            matrix[s, 2 + k] = by_own
        matrix[s, 0], matrix[s, 1] = by_x, by_v


@inlined
def _force_by_coefficients(step: Step, coefficients_by: Array, i: int, transfer: Transfer) -> None:
    """Derivatives of the force at the stages by the parameters of an affine law."""
    at, factors, columns = step.at, transfer.factors, transfer.columns
    n_own, n_groups = len(step.own), coefficients_by.shape[3]
    stride, row = n_groups * LANES, columns.shape[1] * LANES
    for c in range(3):
        factors[0] = at.parts[c, 0] * at.points[c, 2 + n_own]
        factors[1] = at.parts[c, 1] * at.points[c, 1]
        factors[2] = at.parts[c, 2] * at.parts[c, 3]
        factors[3] = -1.0
        to = columns.ctypes.data + 8 * (2 + n_own + c) * row
        first = coefficients_by.ctypes.data + 8 * 4 * stride * (3 * i + c)
        for f in range(n_groups):
            here = 8 * f * LANES
            weighted_sum(to + here, factors.ctypes.data, first + here, 4, stride)


@inlined
def _add_law(equation: Equation, step: Step, weights: Array, tangent: Array) -> None:
    """Add what the parameters of a law that is not affine do to the force at the stages."""
    for c in range(3):
        differentiate_law(equation, step.at, c)
        for p in range(equation.theta.size):
            for s in range(2 + len(step.own)):
                force = step.at.by_theta[N_FACTORS + p]
                tangent[s, p // LANES, p % LANES] -= weights[s, c] * force


@inlined
def _add_moved(
    equation: Equation, step: Step, moves: Array, weights: Array, tangent: Array
) -> None:
    """Add what moving a parameter of a term does to force and own rates at the stages."""
    at, eta = step.at, equation.eta
    for place in range(moves.size):
        if moves[place] == 0.0:
            continue
        p = equation.theta.size + place
        here = eta[place]
        eta[place] = here + moves[place]
        for c in range(3):
            force = (unbalanced(equation, at, c) - step.residual[c]) / moves[place]
            for s in range(2 + len(step.own)):
                tangent[s, p // LANES, p % LANES] -= weights[s, c] * force
            for k in range(len(step.own)):
                rate = (at.rates[c, k] - step.rates[c, k]) / moves[place]
                for s in range(2 + len(step.own)):
                    tangent[s, p // LANES, p % LANES] += weights[s, 3 * (k + 1) + c] * rate
        eta[place] = here


@inlined
def carry(
    equation: Equation,
    step: Step,
    coefficients_by: Array,
    i: int,
    moves: Array,
    transfer: Transfer,
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
        Derivatives of the affine law's coefficients at the stages, shape (n, 3, 4, groups, LANES).
    i
        Which of the n belong to the step.
    moves
        By how much each parameter of a term is moved to differentiate, shape (H,); zero for a
        constant.
    transfer
        Room; forces are zero in groups that the affine law does not reach.
    tangent
        Derivatives of (x, v, own states), shape (2 + Z, G, LANES); overwritten.
    """
    _weigh(step, transfer.weights, h)
    _answer(step, transfer, h)
    for s in range(2 + len(step.own)):
        for f in range(tangent.shape[1]):
            for lane in range(LANES):
                transfer.columns[s, f, lane] = tangent[s, f, lane]
    if equation.law == 0:
        _force_by_coefficients(step, coefficients_by, i, transfer)
    multiply_columns(transfer.matrix, transfer.columns, tangent)
    if equation.law != 0:
        _add_law(equation, step, transfer.weights, tangent)
    _add_moved(equation, step, moves, transfer.weights, tangent)
