r"""Integration of an equation of motion with extra terms, with exact sensitivities.

The rule is that of `softid.kernels.radau`, three-stage Radau IIA solved for the stage velocities,
so that a law without terms gives the same numbers; the stages of a nonlinear law are found by
Newton's method. The terms are differentiated numerically at the stages, which leaves seven digits
where differences of whole simulations would leave four.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.equation import Equation, Instant
from softid.kernels.radau import STAGES
from softid.kernels.stages import Step, advance, solve_stages
from softid.kernels.tangents import carry
from softid.kernels.terms import TERM_SIZE

Array = npt.NDArray[np.float64]

MAX_HALVINGS = 6
"""How often a step is halved whose stages cannot be found."""

ALIKE = 1e-6
"""Relative difference up to which two steps are equal, so that one predicts the next."""

EXTRAPOLATION: Array = np.array(
    [[np.prod([(1.0 + c - o) / (n - o) for o in STAGES if o != n]) for n in STAGES] for c in STAGES]
)
"""Stage rates of the next step from those of this one, by the polynomial through them."""


class Course(NamedTuple):
    """The steps of an integration.

    Attributes
    ----------
    step_s
        Lengths, shape (L,).
    places
        Time and input at the stages, shape (L, 2, 3).
    coefficients
        m, n, q and f of the affine law at the stages, shape (L, 3, 4).
    coefficients_by
        Their derivatives, shape (L, 3, 4, K); of length 1 when none are wanted.
    scale
        Ranges of x, v and the own states, shape (2 + Z,).
    moves
        By how much each parameter is moved to differentiate, shape (K + H,).
    """

    step_s: Array
    places: Array
    coefficients: Array
    coefficients_by: Array
    scale: Array
    moves: Array


@njit(cache=True, nogil=True, error_model="numpy")
def _room(scale: Array) -> Step:
    n_own = scale.size - 2
    size = 3 + 3 * n_own
    return Step(
        np.empty((2, 3)),
        np.empty((3, 4)),
        scale,
        np.zeros(size),
        np.empty(size),
        np.empty((size, size)),
        np.empty(size, np.int64),
        np.empty((3, 3 + n_own)),
        np.empty((3, 5)),
        np.zeros((3, 2 + n_own, 1 + n_own)),
        Instant(np.empty(n_own), np.empty(5), np.empty(TERM_SIZE)),
        Instant(np.empty(n_own), np.empty(5), np.empty(TERM_SIZE)),
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _weights(piece: int, pieces: int) -> Array:
    """How values at the stages of a piece of a step follow from those at the step's stages."""
    found = np.ones((3, 3))
    for c in range(3):
        at = (piece + STAGES[c]) / pieces
        for j in range(3):
            for other in range(3):
                if other != j:
                    found[c, j] *= (at - STAGES[other]) / (STAGES[j] - STAGES[other])
    return found


@njit(cache=True, nogil=True, error_model="numpy")
def _enter(course: Course, i: int, piece: int, pieces: int, step: Step, by: Array) -> None:
    """Take the data of a piece of step ``i`` into ``step`` and ``by``."""
    wanted = by.shape[2] if course.coefficients_by.shape[0] > 1 else 0
    if pieces == 1:
        step.place[:, :] = course.places[i]
        step.coefficients[:, :] = course.coefficients[i]
        if wanted:
            by[:, :, :] = course.coefficients_by[i]
        return
    weights = _weights(piece, pieces)
    for c in range(3):
        step.place[0, c], step.place[1, c] = 0.0, 0.0
        step.coefficients[c] = 0.0
        by[c] = 0.0
        for j in range(3):
            step.place[0, c] += weights[c, j] * course.places[i, 0, j]
            step.place[1, c] += weights[c, j] * course.places[i, 1, j]
            step.coefficients[c] += weights[c, j] * course.coefficients[i, j]
            if wanted:
                by[c] += weights[c, j] * course.coefficients_by[i, j]


@njit(cache=True, nogil=True, error_model="numpy")
def _predict(step: Step, last: Array, state: Array, follows: bool) -> None:
    """Start values of the stage rates: the last step's polynomial, or no acceleration."""
    for r in range(step.w.size // 3):
        for c in range(3):
            step.w[3 * r + c] = state[1] if r == 0 else 0.0
            if follows:
                step.w[3 * r + c] = 0.0
                for j in range(3):
                    step.w[3 * r + c] += EXTRAPOLATION[c, j] * last[3 * r + j]


@njit(cache=True, nogil=True, error_model="numpy")
def integrate(
    equation: Equation,
    course: Course,
    state: Array,
    tangent: Array,
    states: Array,
    tangents: Array,
) -> bool:
    """Integrate over all steps; False when a step could not be solved, however finely divided.

    Parameters
    ----------
    equation
        The terms. Its parameters are moved and restored on the way.
    course
        The steps.
    state
        x, v and own states at the start, shape (2 + Z,); overwritten by those at the end.
    tangent
        Their derivatives, shape (2 + Z, K + H + 2); overwritten.
    states
        Receives (x, v) after each step, shape (L, 2).
    tangents
        Receives ∂x/∂(θ, η, x₀, v₀) after each step, shape (L, K + H + 2); of length 0 when no
        derivatives are wanted.
    """
    derivatives = tangents.shape[0] > 0
    step = _room(course.scale)
    coefficients_by = np.zeros((3, 4, course.coefficients_by.shape[3]))
    by = np.zeros((3, state.size - 1, course.moves.size))
    rhs = np.zeros((step.w.size, tangent.shape[1]))
    last = np.zeros(step.w.size)
    before, tangent_before = state.copy(), tangent.copy()
    follows = False
    for i in range(course.step_s.size):
        before[:] = state
        tangent_before[:, :] = tangent
        solved = False
        for halvings in range(MAX_HALVINGS + 1):
            pieces = 1 << halvings
            h = course.step_s[i] / pieces
            alike = i > 0 and abs(course.step_s[i] - course.step_s[i - 1]) < ALIKE * h
            follows = follows and pieces == 1 and alike
            for piece in range(pieces):
                _enter(course, i, piece, pieces, step, coefficients_by)
                _predict(step, last, state, follows)
                solved = solve_stages(equation, step, state, h)
                if not solved:
                    break
                if derivatives:
                    carry(equation, step, coefficients_by, course.moves, by, rhs, tangent, h)
                advance(step, state, h)
            if solved:
                break
            state[:] = before
            tangent[:, :] = tangent_before
        if not solved:
            return False
        last[:] = step.w
        follows = pieces == 1
        states[i, 0], states[i, 1] = state[0], state[1]
        if derivatives:
            tangents[i] = tangent[0]
    return True
