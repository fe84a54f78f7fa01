r"""Integration of an equation of motion with extra terms, with exact sensitivities.

The rule is that of `softid.kernels.radau`, three-stage Radau IIA solved for the stage velocities,
so that a law without terms gives the same numbers; the stages of a nonlinear law are found by
Newton's method. The terms are differentiated numerically at the stages, which leaves seven digits
where differences of whole simulations would leave four.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from softid.kernels import (
    equation,
    radau,
    radau_stages,
    small_matrix,
    step_sensitivities,
    terms,
)
from softid.kernels.cache_invalidation import follow_sources
from softid.kernels.decorators import bare_kernel, inlined, inner
from softid.kernels.equation import Equation, Instants, unbalanced
from softid.kernels.radau import STAGES
from softid.kernels.radau_stages import Step, advance, solve_stages
from softid.kernels.small_matrix import LANES, groups
from softid.kernels.step_sensitivities import Transfer, carry
from softid.kernels.terms import N_FACTORS, TERM_SIZE

Array = npt.NDArray[np.float64]

WHOLE = 1 << 12
"""Smallest pieces into which a step is divided whose stages cannot be found: dry friction that
comes up within 1/5000 of the largest speed, and gives way as fast, needs thousandths where the
motion breaks away."""

FIRST_SHARE = 0.5
"""Share of a step that is tried first where the whole of it fails."""

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
        Their derivatives in groups of `LANES` filled up with zeros, shape (L + 1, 3, 4, G, LANES),
        the last of which is room for those of a step in pieces; of length 0 when no derivatives are
        wanted. Those of a step that is taken in pieces are lost.
    scale
        Ranges of x, v and the own states, shape (2 + Z,).
    moves
        By how much each parameter of a term is moved to differentiate, shape (H,); zero for a
        constant.
    """

    step_s: Array
    places: Array
    coefficients: Array
    coefficients_by: Array
    scale: Array
    moves: Array


def _room(scale: Array, n_theta: int = 0) -> Step:
    n_own = scale.size - 2
    size = 3 + 3 * n_own
    at = Instants(
        np.empty((2, 3)),
        np.empty((3, 4)),
        np.empty((3, 3 + n_own)),
        np.empty((3, n_own)),
        np.empty((3, 5)),
        np.empty(TERM_SIZE),
        np.empty(N_FACTORS + n_theta),
    )
    return Step(
        at,
        (0,) * n_own,
        scale,
        np.zeros(size),
        np.empty(size),
        np.empty(size),
        np.zeros((3, 2 + n_own, 1 + n_own)),
        np.empty((1 + n_own, 3, 3)),
        np.empty((1 + n_own, 3, 3)),
        np.empty((n_own, 3, 3)),
        np.empty((n_own, 3, 3)),
        np.empty((3, n_own)),
        np.empty(5),
    )


@bare_kernel
def _left_at_rest(equation: Equation, at: Instants) -> float:
    left: float = unbalanced(equation, at, np.int64(0))
    return left


def unbalanced_at_rest(
    equation: Equation, coefficients: Array, follows: Sequence[bool], u: float, t: float
) -> Callable[[float], float]:
    """Position → force that is left when nothing moves there.

    Parameters
    ----------
    equation
        The terms.
    coefficients
        m, n, q and f of an affine law, shape (4,).
    follows
        Which of the own states lie at the position, Z of them; the others are zero.
    u, t
        Input and time.
    """
    at = _room(np.empty(2 + len(follows))).at
    at.place[0, 0], at.place[1, 0] = t, u
    at.coefficients[0] = coefficients
    at.points[0] = 0.0
    moved = [0, *(2 + k for k, does in enumerate(follows) if does)]

    def left(x: float) -> float:
        for k in moved:
            at.points[0, k] = x
        return float(_left_at_rest(equation, at))

    return left


@inner
def _weight(c: int, j: int, begin: float, share: float) -> float:
    """What the value at stage ``j`` of a step adds to that at stage ``c`` of a piece of it."""
    found, at = 1.0, begin + share * STAGES[c]
    for other in range(3):
        if other != j:
            found *= (at - STAGES[other]) / (STAGES[j] - STAGES[other])
    return found


@inlined
def _enter(course: Course, i: int, step: Step) -> None:
    """Take the data of step ``i`` into ``step``."""
    at = step.at
    for c in range(3):
        at.place[0, c], at.place[1, c] = course.places[i, 0, c], course.places[i, 1, c]
        for q in range(4):
            at.coefficients[c, q] = course.coefficients[i, c, q]


@inner
def _enter_piece(course: Course, i: int, begin: float, share: float, step: Step) -> None:
    """Take the data of a piece of step ``i``, from a share of it on, into ``step``.

    Derivatives by the coefficients take the place of those of the step, which its first half keeps
    at the end of the course: to read them from either of two places would slow all steps.
    """
    at, by, last = step.at, course.coefficients_by, course.step_s.size
    wanted = by.shape[3] if by.shape[0] > 0 else 0
    for c in range(3 if begin == 0.0 and share == FIRST_SHARE else 0):
        for q in range(4):
            for f in range(wanted):
                for lane in range(LANES):
                    by[last, c, q, f, lane] = by[i, c, q, f, lane]
    for c in range(3):
        at.place[0, c], at.place[1, c] = 0.0, 0.0
        for j in range(3):
            weight = _weight(c, j, begin, share)
            at.place[0, c] += weight * course.places[i, 0, j]
            at.place[1, c] += weight * course.places[i, 1, j]
            for q in range(4):
                before = at.coefficients[c, q] if j > 0 else 0.0
                at.coefficients[c, q] = before + weight * course.coefficients[i, j, q]
                for f in range(wanted):
                    for lane in range(LANES):
                        before = by[i, c, q, f, lane] if j > 0 else 0.0
                        by[i, c, q, f, lane] = before + weight * by[last, j, q, f, lane]


@inlined
def _predict(step: Step, last: Array, state: Array, follows: bool) -> None:
    """Start values of the stage rates: the last step's polynomial, or no acceleration."""
    for r in range(1 + len(step.own)):
        for c in range(3):
            guess = state[1] if r == 0 else 0.0
            if follows:
                guess = 0.0
                for j in range(3):
                    guess += EXTRAPOLATION[c, j] * last[3 * r + j]
            step.w[3 * r + c] = guess


@inlined
def _is_alike(step_s: Array, i: int) -> bool:
    """Whether step ``i`` is as long as the one before."""
    alike: bool = abs(step_s[i] / step_s[i - 1] - 1.0) < ALIKE
    return alike


class Room(NamedTuple):
    """Arrays that a march works in.

    Attributes
    ----------
    step
        The step at hand.
    transfer
        As in `carry`.
    last
        Stage rates of the step before, shape (3 + 3 Z,).
    """

    step: Step
    transfer: Transfer
    last: Array


@bare_kernel
def _march(
    equation: Equation,
    course: Course,
    state: Array,
    tangent: Array,
    states: Array,
    tangents: Array,
    room: Room,
) -> bool:
    """All steps, in arrays that exist already: counting references would double the time.

    A step whose stages cannot be found is taken in pieces, each as long as its own can be. A piece
    begins at ``begin`` and is as long as ``size`` parts of `WHOLE`; what is not found has changed
    nothing. ``follows`` says that what was taken last was as long, so that its inverse serves as a
    start, and ``predicts`` that it was a whole step, whose rates do.
    """
    step, by = room.step, course.coefficients_by
    wanted = by.shape[0] > 0
    i: int = np.int64(0)  # type: ignore[assignment]  # a constant has numba compile its users twice
    begin, size, follows, predicts = 0, WHOLE, False, False
    while i < course.step_s.size:
        h = course.step_s[i]
        if size == WHOLE:
            _enter(course, i, step)
        else:
            h = h * size / WHOLE
            _enter_piece(course, i, begin / WHOLE, size / WHOLE, step)
        _predict(step, room.last, state, predicts)
        if not solve_stages(equation, step, state, h, follows, wanted):
            if not follows:
                size //= 2
            follows = predicts = False
            if size == 0:
                return False
            continue
        if wanted:
            carry(equation, step, by, i, course.moves, room.transfer, tangent, h)
        advance(step, state, h)
        begin += size
        if begin < WHOLE:
            follows = begin % (2 * size) != 0
            size = min(size if follows else 2 * size, WHOLE - begin)
            continue
        for k in range(3 + 3 * len(step.own)):
            room.last[k] = step.w[k]
        states[i, 0], states[i, 1] = state[0], state[1]
        for p in range(tangents.shape[1] if wanted else 0):
            tangents[i, p] = tangent[0, p // LANES, p % LANES]
        i += 1
        was_whole, begin, size = size == WHOLE, 0, WHOLE
        follows = was_whole and i < course.step_s.size and _is_alike(course.step_s, i)
        predicts = follows
    return True


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
    step = _room(course.scale, equation.theta.size)
    n_states, columns = tangent.shape
    carried = np.zeros((n_states, groups(columns), LANES))
    flat = carried.reshape(n_states, -1)
    flat[:, :columns] = tangent
    size = (n_states + 3, *carried.shape[1:])
    room = Room(
        step,
        Transfer(
            np.empty((n_states, step.w.size)),
            np.empty((n_states, size[0])),
            np.zeros(size),
            np.empty(4),
        ),
        np.empty(step.w.size),
    )
    solved: bool = _march(equation, course, state, carried, states, tangents, room)
    tangent[:] = flat[:, :columns]
    return solved


for _kernel in (_march, _left_at_rest):
    follow_sources(
        _kernel, (equation, radau_stages, step_sensitivities, small_matrix, terms, radau)
    )
