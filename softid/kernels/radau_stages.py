"""One step of three-stage Radau IIA for an equation of motion with extra terms."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inlined
from softid.kernels.equation import Equation, Instants, unbalanced
from softid.kernels.radau import B1, A, B
from softid.kernels.small_matrix import invert_block

Array = npt.NDArray[np.float64]

MAX_NEWTON = 13
"""Newton's moves at most: so many lead from one to `NEWTON_TOLERANCE` where each is `SLOWEST` times
the one before. What takes more is given up."""

MOST_ASTRAY = 1
"""Newton's moves that may be longer than the one before, with slopes taken where they begin: across
a corner they go to and fro without end, and a shorter step finds the way sooner."""

NEWTON_TOLERANCE = 1e-9
"""Newton's last move, in units of the ranges of the states: far below the 1e-4 that a step may err
by, and far above rounding."""

SLOWEST = 0.2
"""An old inverse must shrink Newton's moves by this factor at least."""

LEFT = 0.1
"""Share of the tolerance that Newton's moves may leave, as is known from the factor by which they
shrink, to need no further one."""

DIFFERENCE = 1e-7
"""Relative step of the numerical derivatives at the stages, and of Newton's last one."""

NEARBY = 1e-3
"""Newton's move after which slopes are taken that may serve as those at the solution."""

BESIDE = 1e-5
"""Newton's move up to which slopes from before it serve as those at the solution."""


class Step(NamedTuple):
    """A step and room for its stages; Z is the number of own states.

    Unknown 3k + c of the stage equations is the rate of state k at stage c, where k = 0 is the
    position and k = 1 … Z are the own states. Own states meet in the equation of motion only, so
    their Jacobian is an arrow of blocks of three rows and columns,

        [ X   C₁  C₂ … ]
        [ R₁  S₁       ]
        [ R₂      S₂   ]

    whose inverse needs S⁻¹, G = S⁻¹ R, F = C S⁻¹ and that of X − Σ C G.

    Attributes
    ----------
    at
        The stages.
    own
        Zeros, as many as there are own states: a tuple's length is part of its type, so that there
        is one compiled step for every number of them, whose loops are written out.
    scale
        Ranges of x, v and the own states, shape (2 + Z,).
    w
        The unknowns, shape (3 + 3 Z,).
    residual
        What the stage equations leave, shape (3 + 3 Z,).
    move
        Newton's move, shape (3 + 3 Z,).
    slopes
        Derivatives by x, v and the own states of the unbalanced force and of the own rates at each
        stage, shape (3, 2 + Z, 1 + Z).
    blocks, inverse
        X − Σ C G and S_k, and their inverses, each of shape (1 + Z, 3, 3).
    forth, back
        F and G, each of shape (Z, 3, 3).
    rates
        Rates of the own states at the stages, shape (3, Z).
    kept
        Room for one stage's parts, shape (5,).
    """

    at: Instants
    own: tuple[int, ...]
    scale: Array
    w: Array
    residual: Array
    move: Array
    slopes: Array
    blocks: Array
    inverse: Array
    forth: Array
    back: Array
    rates: Array
    kept: Array


@inlined
def _leave(equation: Equation, step: Step, state: Array, h: float) -> None:
    """Residual of the stage equations at ``step.w``, from ``state`` over ``h``."""
    points, w = step.at.points, step.w
    n_own = len(step.own)
    for c in range(3):
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
        step.residual[c] = unbalanced(equation, step.at, c)
        for k in range(n_own):
            row = 3 * (k + 1) + c
            step.rates[c, k] = step.at.rates[c, k]
            step.residual[row] = w[row] - step.rates[c, k]


@inlined
def _differentiate(equation: Equation, step: Step) -> None:
    """Slopes at the stages whose residual `_leave` left."""
    points, parts, kept, slopes = step.at.points, step.at.parts, step.kept, step.slopes
    n_own = len(step.own)
    for c in range(3):
        for i in range(5):
            kept[i] = parts[c, i]
        for s in range(2 + n_own):
            here = points[c, s]
            d = DIFFERENCE * step.scale[s]
            points[c, s] = here + d
            moved = unbalanced(equation, step.at, c)
            points[c, s] = here
            slopes[c, s, 0] = (moved - step.residual[c]) / d
            for k in range(n_own):
                slopes[c, s, 1 + k] = (step.at.rates[c, k] - step.rates[c, k]) / d
        for i in range(5):
            parts[c, i] = kept[i]


@inlined
def _invert(step: Step, h: float) -> None:
    """Inverse of the Jacobian of the stage equations, block by block, from the slopes."""
    slopes, blocks, parts = step.slopes, step.blocks, step.at.parts
    inverse, forth, back = step.inverse, step.forth, step.back
    for c in range(3):
        heavy = parts[c, 4] * parts[c, 0] / h
        for j in range(3):
            blocks[0, c, j] = heavy * B[c, j] + slopes[c, 0, 0] * h * A[c, j]
        blocks[0, c, c] += slopes[c, 1, 0]
    for k in range(len(step.own)):
        for c in range(3):
            for j in range(3):
                blocks[1 + k, c, j] = -slopes[c, 2 + k, 1 + k] * h * A[c, j]
            blocks[1 + k, c, c] += 1.0
        invert_block(blocks, 1 + k, inverse)
        for c in range(3):
            for j in range(3):
                found = -inverse[1 + k, c, j] * slopes[j, 1, 1 + k]
                for i in range(3):
                    found -= inverse[1 + k, c, i] * slopes[i, 0, 1 + k] * h * A[i, j]
                back[k, c, j] = found
        for c in range(3):
            along = slopes[c, 2 + k, 0] * h
            for j in range(3):
                found = 0.0
                for i in range(3):
                    found += A[c, i] * inverse[1 + k, i, j]
                    blocks[0, c, j] -= along * A[c, i] * back[k, i, j]
                forth[k, c, j] = along * found
    invert_block(blocks, 0, inverse)


@inlined
def _solve(step: Step) -> None:
    """Newton's move for the residual."""
    residual, move, inverse = step.residual, step.move, step.inverse
    r0, r1, r2 = residual[0], residual[1], residual[2]
    for k in range(len(step.own)):
        for j in range(3):
            left = residual[3 * (k + 1) + j]
            r0 -= step.forth[k, 0, j] * left
            r1 -= step.forth[k, 1, j] * left
            r2 -= step.forth[k, 2, j] * left
    for c in range(3):
        move[c] = inverse[0, c, 0] * r0 + inverse[0, c, 1] * r1 + inverse[0, c, 2] * r2
    for k in range(len(step.own)):
        for c in range(3):
            found = 0.0
            for j in range(3):
                found += inverse[1 + k, c, j] * residual[3 * (k + 1) + j]
                found -= step.back[k, c, j] * move[j]
            move[3 * (k + 1) + c] = found


@inlined
def solve_stages(
    equation: Equation, step: Step, state: Array, h: float, has_inverse: bool, exact: bool
) -> bool:
    """Find the stages by Newton's method from ``step.w``; False when it does not converge.

    The inverse that the step before left serves as long as it brings the stages nearer quickly: the
    law changes little from step to step, and an inverse costs several times a residual. Where
    slopes are wanted anyway they are taken before the last move, which is then the shorter.

    Parameters
    ----------
    equation, step, state, h
        The step; its ``w`` is the start and receives the solution.
    has_inverse
        Whether ``step`` holds the inverse of a step before.
    exact
        Whether slopes and inverse are wanted beside the solution, for `carry`.
    """
    before, astray = 0.0, 0
    for number in range(MAX_NEWTON):
        _leave(equation, step, state, h)
        taken = not has_inverse or (exact and number > 0 and before < NEARBY)
        if taken:
            _differentiate(equation, step)
            _invert(step, h)
        _solve(step)
        worst = 0.0
        for i in range(3 + 3 * len(step.own)):
            move = step.move[i]
            if not np.isfinite(move):
                return False
            step.w[i] -= move
            size = step.scale[1] if i < 3 else step.scale[2 + (i - 3) // 3] / h
            worst = max(worst, abs(move) / size)
        shrinkage = worst / before if number > 0 else SLOWEST
        solved = worst < NEWTON_TOLERANCE or worst * shrinkage < LEFT * NEWTON_TOLERANCE
        if solved and (not exact or (taken and worst < BESIDE)):
            return True
        if shrinkage > 1.0 and taken:
            astray += 1
            if astray > MOST_ASTRAY:
                return False
        if shrinkage > SLOWEST:
            has_inverse = False
        before = worst
    return False


@inlined
def advance(step: Step, state: Array, h: float) -> None:
    """Move the state to the end of a solved step."""
    for j in range(3):
        state[0] += h * A[2, j] * step.w[j]
        for k in range(len(step.own)):
            state[2 + k] += h * A[2, j] * step.w[3 * (k + 1) + j]
    state[1] = step.w[2]
