r"""Integration of a law of motion with extra terms and their own states, with exact sensitivities.

The rule is that of `softid.kernels.radau`, three-stage Radau IIA solved for the stage velocities, so
that a law without terms gives the same numbers; the stages of a nonlinear law are found by Newton's
method. A term is called by its address (`softid.kernels.terms`), and is differentiated numerically
at the stages: a step of 1e-7 of the range of each argument leaves seven digits, while differences
of whole simulations would leave four.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.radau import _A, _B, _B1, STAGES
from softid.kernels.terms import (
    DAMPING,
    FORCE,
    INERTIA,
    LAW_DAMPING,
    LAW_DRIVE,
    LAW_ELASTIC,
    LAW_INERTIA,
    RATE,
    SHIFT,
    STIFFNESS,
    TERM_SIZE,
    call_term,
)

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]

MAX_NEWTON = 12
NEWTON_TOLERANCE = 1e-7
MAX_HALVINGS = 6
DIFFERENCE = 1e-7

EXTRAPOLATION: Array = np.array(
    [[np.prod([(1.0 + c - o) / (n - o) for o in STAGES if o != n]) for n in STAGES] for c in STAGES]
)
"""Stage velocities of the next step from those of this one, by the polynomial through them."""


@njit(cache=True, nogil=True, error_model="numpy")
def evaluate(
    x: float,
    v: float,
    a: float,
    z: Array,
    u: float,
    t: float,
    coefficients: Array,
    law: int,
    theta: Array,
    terms: Index,
    eta: Array,
    eta_from: Index,
    own: Index,
    rates: Array,
    parts: Array,
    out: Array,
) -> float:
    """Unbalanced force of the equation of motion at one instant.

    Parameters
    ----------
    x, v, a, z, u, t
        Position, velocity, acceleration, the terms' own states, input and time.
    coefficients
        m, n, q and f of an affine law, shape (4,); zeros when ``law`` gives them.
    law
        Address of a law, or 0.
    theta
        Parameters of the law, shape (K,).
    terms, eta, eta_from, own
        Addresses, shape (E,); all their parameters; where each one's begin, shape (E + 1,); which
        state is a term's own, −1 for none, shape (E,).
    rates
        Receives ż, shape (Z,).
    parts
        Receives 1 + Δm, 1 + Δd, 1 + Δq, x − s and the inertia, shape (5,).
    out
        Room for one result, shape (6,).
    """
    extra, more_m, more_d, more_q, shift = 0.0, 1.0, 1.0, 1.0, 0.0
    for e in range(terms.size):
        for i in range(TERM_SIZE):
            out[i] = 0.0
        k = own[e]
        mine = z[k] if k >= 0 else 0.0
        call_term(terms[e], x, v, mine, u, t, eta.ctypes.data + 8 * eta_from[e], out.ctypes.data)
        extra += out[FORCE]
        more_m += out[INERTIA]
        more_d += out[DAMPING]
        more_q += out[STIFFNESS]
        shift += out[SHIFT]
        if k >= 0:
            rates[k] = out[RATE]
    eased = x - shift
    inertia = coefficients[0]
    damping = coefficients[1] * v
    elastic = coefficients[2] * eased
    drive = coefficients[3]
    if law != 0:
        for i in range(TERM_SIZE):
            out[i] = 0.0
        call_term(law, eased, v, 0.0, u, t, theta.ctypes.data, out.ctypes.data)
        inertia += out[LAW_INERTIA]
        damping += out[LAW_DAMPING]
        elastic += out[LAW_ELASTIC]
        drive += out[LAW_DRIVE]
    parts[0] = more_m
    parts[1] = more_d
    parts[2] = more_q
    parts[3] = eased
    parts[4] = inertia
    return inertia * more_m * a + damping * more_d + elastic * more_q - drive + extra


@njit(cache=True, nogil=True, error_model="numpy")
def factorise(matrix: Array, order: Index) -> None:
    """LU factors of a small matrix in place, with the order of the rows."""
    n = matrix.shape[0]
    for i in range(n):
        best, row = abs(matrix[i, i]), i
        for r in range(i + 1, n):
            if abs(matrix[r, i]) > best:
                best, row = abs(matrix[r, i]), r
        order[i] = row
        if row != i:
            for c in range(n):
                matrix[i, c], matrix[row, c] = matrix[row, c], matrix[i, c]
        for r in range(i + 1, n):
            matrix[r, i] /= matrix[i, i]
            for c in range(i + 1, n):
                matrix[r, c] -= matrix[r, i] * matrix[i, c]


@njit(cache=True, nogil=True, error_model="numpy")
def solve(factors: Array, order: Index, b: Array) -> None:
    """Solve in place with factors from `factorise`."""
    n = b.size
    for i in range(n):
        row = order[i]
        b[i], b[row] = b[row], b[i]
    for i in range(n):
        for c in range(i):
            b[i] -= factors[i, c] * b[c]
    for i in range(n - 1, -1, -1):
        for c in range(i + 1, n):
            b[i] -= factors[i, c] * b[c]
        b[i] /= factors[i, i]


@njit(cache=True, nogil=True, error_model="numpy")
def linearise(
    h: float,
    place: Array,
    coefficients: Array,
    law: int,
    theta: Array,
    terms: Index,
    eta: Array,
    eta_from: Index,
    own: Index,
    scale: Array,
    state: Array,
    w: Array,
    matrix: Array,
    residual: Array,
    parts: Array,
    points: Array,
    slopes: Array,
) -> None:
    """Residual and Jacobian of the stage equations at the stage velocities and rates ``w``.

    Unknown 3k + c is the rate of state k at stage c, with k = 0 for the position and k = 1 … Z for
    the terms' own states.

    Parameters
    ----------
    h
        Length of the step.
    place
        Time and input at the stages, shape (2, 3).
    coefficients
        Those of the affine law at the stages, shape (3, 4).
    law, theta, terms, eta, eta_from, own
        As in `evaluate`.
    scale
        Ranges of x, v and the own states, shape (2 + Z,).
    state
        x, v and the own states before the step, shape (2 + Z,).
    w
        Where to linearise, shape (3 + 3 Z,).
    matrix, residual
        Receive the Jacobian, shape (3 + 3 Z, 3 + 3 Z), and the residual, shape (3 + 3 Z,).
    parts
        Receives those of `evaluate` at each stage, shape (3, 5).
    points
        Receives x, v, own states and, last, a at each stage, shape (3, 3 + Z).
    slopes
        Receives the derivatives by x, v and the own states of the unbalanced force and of the own
        rates at each stage, shape (3, 2 + Z, 1 + Z).
    """
    n_own = state.size - 2
    rates, moved = np.empty(n_own), np.empty(n_own)
    out, other = np.empty(TERM_SIZE), np.empty(5)
    matrix[:, :] = 0.0
    for c in range(3):
        x, a = state[0], -_B1[c] * state[1] / h
        for j in range(3):
            x += h * _A[c, j] * w[j]
            a += _B[c, j] * w[j] / h
        v = w[c]
        z = points[c, 2 : 2 + n_own]
        for k in range(n_own):
            z[k] = state[2 + k]
            for j in range(3):
                z[k] += h * _A[c, j] * w[3 * (k + 1) + j]
        points[c, 0], points[c, 1], points[c, 2 + n_own] = x, v, a
        t, u = place[0, c], place[1, c]
        at = evaluate(
            x, v, a, z, u, t, coefficients[c], law, theta, terms, eta, eta_from, own, rates,
            parts[c], out,
        )  # fmt: skip
        residual[c] = at
        heavy = parts[c, 4] * parts[c, 0] / h
        for j in range(3):
            matrix[c, j] = heavy * _B[c, j]
        for k in range(n_own):
            row = 3 * (k + 1) + c
            residual[row] = w[row] - rates[k]
            matrix[row, row] += 1.0
        for s in range(2 + n_own):
            d = DIFFERENCE * scale[s]
            if s >= 2:
                z[s - 2] += d
            near = evaluate(
                x + (d if s == 0 else 0.0), v + (d if s == 1 else 0.0), a, z, u, t,
                coefficients[c], law, theta, terms, eta, eta_from, own, moved, other, out,
            )  # fmt: skip
            if s >= 2:
                z[s - 2] -= d
            slope = (near - at) / d
            slopes[c, s, 0] = slope
            if s == 1:
                matrix[c, c] += slope
            else:
                first = 0 if s == 0 else 3 * (s - 1)
                for j in range(3):
                    matrix[c, first + j] += slope * h * _A[c, j]
            for k in range(n_own):
                row = 3 * (k + 1) + c
                change = (moved[k] - rates[k]) / d
                slopes[c, s, 1 + k] = change
                if s == 1:
                    matrix[row, c] -= change
                elif s == 0:
                    for j in range(3):
                        matrix[row, j] -= change * h * _A[c, j]
                elif s - 2 == k:
                    for j in range(3):
                        matrix[row, 3 * (k + 1) + j] -= change * h * _A[c, j]


@njit(cache=True, nogil=True, error_model="numpy")
def solve_stages(
    h: float,
    place: Array,
    coefficients: Array,
    law: int,
    theta: Array,
    terms: Index,
    eta: Array,
    eta_from: Index,
    own: Index,
    scale: Array,
    state: Array,
    w: Array,
    matrix: Array,
    order: Index,
    parts: Array,
    points: Array,
    slopes: Array,
) -> bool:
    """Find the stage velocities and rates by Newton's method from ``w``; False when it fails.

    Leaves the factors of the last Jacobian in ``matrix`` and ``order``. Arguments as in
    `linearise`.
    """
    residual = np.empty(w.size)
    for _ in range(MAX_NEWTON):
        linearise(
            h, place, coefficients, law, theta, terms, eta, eta_from, own, scale, state, w,
            matrix, residual, parts, points, slopes,
        )  # fmt: skip
        factorise(matrix, order)
        solve(matrix, order, residual)
        worst = 0.0
        for i in range(w.size):
            w[i] -= residual[i]
            limit = scale[1] if i < 3 else scale[2 + (i - 3) // 3] / h
            worst = max(worst, abs(residual[i]) / limit)
            if not np.isfinite(residual[i]):
                return False
        if worst < NEWTON_TOLERANCE:
            return True
    return False


@njit(cache=True, nogil=True, error_model="numpy")
def carry(
    h: float,
    place: Array,
    coefficients: Array,
    coefficients_by: Array,
    law: int,
    theta: Array,
    terms: Index,
    eta: Array,
    eta_from: Index,
    own: Index,
    steps: Array,
    matrix: Array,
    order: Index,
    parts: Array,
    points: Array,
    slopes: Array,
    tangent: Array,
) -> None:
    """Carry the derivatives of the states over a step whose stages were found.

    Parameters
    ----------
    coefficients_by
        Derivatives of the affine law's coefficients at the stages, shape (3, 4, K).
    steps
        Steps by which the parameters θ and η are moved to differentiate, shape (K + H,).
    tangent
        ∂(x, v, own states)/∂(θ, η, x₀, v₀), shape (2 + Z, K + H + 2); overwritten.
    law, theta, terms, eta, eta_from, own, matrix, order, parts, points, slopes
        As `solve_stages` left them.
    """
    n_own = tangent.shape[0] - 2
    n_theta, n_eta = theta.size, eta.size
    base, moved = np.empty((3, 1 + n_own)), np.empty(n_own)
    out, other, rates = np.empty(TERM_SIZE), np.empty(5), np.empty(n_own)
    rhs = np.empty(3 + 3 * n_own)
    for c in range(3):
        base[c, 0] = evaluate(
            points[c, 0], points[c, 1], points[c, 2 + n_own], points[c, 2 : 2 + n_own],
            place[1, c], place[0, c], coefficients[c], law, theta, terms, eta, eta_from, own,
            rates, other, out,
        )  # fmt: skip
        base[c, 1:] = rates
    for p in range(n_theta + n_eta + 2):
        for c in range(3):
            by = 0.0
            heavy = parts[c, 4] * parts[c, 0] / h
            for k in range(n_own):
                moved[k] = base[c, 1 + k]
            if p < n_theta and law == 0:
                by = (
                    coefficients_by[c, 0, p] * parts[c, 0] * points[c, 2 + n_own]
                    + coefficients_by[c, 1, p] * parts[c, 1] * points[c, 1]
                    + coefficients_by[c, 2, p] * parts[c, 2] * parts[c, 3]
                    - coefficients_by[c, 3, p]
                )
            elif p < n_theta + n_eta:
                vector = theta if p < n_theta else eta
                at = p if p < n_theta else p - n_theta
                kept = vector[at]
                vector[at] = kept + steps[p]
                by = evaluate(
                    points[c, 0], points[c, 1], points[c, 2 + n_own], points[c, 2 : 2 + n_own],
                    place[1, c], place[0, c], coefficients[c], law, theta, terms, eta, eta_from,
                    own, moved, other, out,
                )  # fmt: skip
                vector[at] = kept
                by = (by - base[c, 0]) / steps[p]
            rhs[c] = -by - slopes[c, 0, 0] * tangent[0, p] + heavy * _B1[c] * tangent[1, p]
            for k in range(n_own):
                rhs[c] -= slopes[c, 2 + k, 0] * tangent[2 + k, p]
                row = 3 * (k + 1) + c
                rhs[row] = slopes[c, 0, 1 + k] * tangent[0, p]
                rhs[row] += slopes[c, 2 + k, 1 + k] * tangent[2 + k, p]
                if n_theta <= p < n_theta + n_eta:
                    rhs[row] += (moved[k] - base[c, 1 + k]) / steps[p]
        solve(matrix, order, rhs)
        for j in range(3):
            tangent[0, p] += h * _A[2, j] * rhs[j]
            for k in range(n_own):
                tangent[2 + k, p] += h * _A[2, j] * rhs[3 * (k + 1) + j]
        tangent[1, p] = rhs[2]


@njit(cache=True, nogil=True, error_model="numpy")
def _between(values: Array, at: Array, inner: Array) -> None:
    """Values at other places of a step from those at its stages, along the last axis but one."""
    for c in range(3):
        inner[c] = 0.0
        for j in range(3):
            weight = 1.0
            for o in range(3):
                if o != j:
                    weight *= (at[c] - STAGES[o]) / (STAGES[j] - STAGES[o])
            inner[c] += weight * values[j]


@njit(cache=True, nogil=True, error_model="numpy")
def propagate_extended(
    step_s: Array,
    places: Array,
    coefficients: Array,
    coefficients_by: Array,
    law: int,
    theta: Array,
    terms: Index,
    eta: Array,
    eta_from: Index,
    own: Index,
    scale: Array,
    steps: Array,
    state: Array,
    tangent: Array,
    states: Array,
    tangents: Array,
    derivatives: bool,
) -> bool:
    """Integrate over all steps; False when a step could not be solved, however finely divided.

    Parameters
    ----------
    step_s
        Step lengths, shape (L,).
    places
        Time and input at the stages of every step, shape (L, 2, 3).
    coefficients, coefficients_by
        m, n, q and f of the affine law at the stages, shape (L, 3, 4), and their derivatives,
        shape (L, 3, 4, K); without an affine law zeros, and shape (L, 3, 4, 0).
    law, theta, terms, eta, eta_from, own
        As in `evaluate`.
    scale, steps
        As in `linearise` and `carry`.
    state
        x, v and own states at the start, shape (2 + Z,); overwritten by those at the end.
    tangent
        Their derivatives, shape (2 + Z, K + H + 2); overwritten.
    states, tangents
        Receive (x, v) after each step, shape (L, 2), and ∂x/∂(θ, η, x₀, v₀), shape (L, K + H + 2).
    derivatives
        Whether to carry the derivatives.
    """
    n_own = state.size - 2
    size = 3 + 3 * n_own
    matrix, order, parts = np.empty((size, size)), np.empty(size, np.int64), np.empty((3, 5))
    points, slopes = np.empty((3, 3 + n_own)), np.zeros((3, 2 + n_own, 1 + n_own))
    w, last = np.zeros(size), np.zeros(size)
    at = np.empty(3)
    inner_place, inner, inner_by = (
        np.empty((2, 3)), np.empty((3, 4)), np.empty((3, 4, coefficients_by.shape[3])),
    )  # fmt: skip
    known = False
    for i in range(step_s.size):
        for halvings in range(MAX_HALVINGS + 1):
            pieces = 1 << halvings
            h = step_s[i] / pieces
            before, tangent_before = state.copy(), tangent.copy()
            solved = True
            for piece in range(pieces):
                for r in range(size // 3):
                    for c in range(3):
                        w[3 * r + c] = state[1] if r == 0 else 0.0
                        if known and halvings == 0 and step_s[i] == step_s[i - 1]:
                            w[3 * r + c] = 0.0
                            for j in range(3):
                                w[3 * r + c] += EXTRAPOLATION[c, j] * last[3 * r + j]
                if halvings == 0:
                    inner_place[:, :] = places[i]
                    inner[:, :] = coefficients[i]
                    if derivatives:
                        inner_by[:, :, :] = coefficients_by[i]
                else:
                    for c in range(3):
                        at[c] = (piece + STAGES[c]) / pieces
                    for q in range(2):
                        _between(places[i, q], at, inner_place[q])
                    _between(coefficients[i], at, inner)
                    if derivatives:
                        _between(coefficients_by[i], at, inner_by)
                solved = solve_stages(
                    h, inner_place, inner, law, theta, terms, eta, eta_from, own, scale, state, w,
                    matrix, order, parts, points, slopes,
                )  # fmt: skip
                if not solved:
                    break
                if derivatives:
                    carry(
                        h, inner_place, inner, inner_by, law, theta, terms, eta, eta_from, own,
                        steps, matrix, order, parts, points, slopes, tangent,
                    )  # fmt: skip
                for j in range(3):
                    state[0] += h * _A[2, j] * w[j]
                    for k in range(n_own):
                        state[2 + k] += h * _A[2, j] * w[3 * (k + 1) + j]
                state[1] = w[2]
            if solved:
                break
            state[:] = before
            tangent[:, :] = tangent_before
        if not solved:
            return False
        last[:] = w
        known = halvings == 0
        states[i, 0], states[i, 1] = state[0], state[1]
        if derivatives:
            tangents[i] = tangent[0]
    return True
