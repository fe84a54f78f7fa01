"""The equation of motion with extra terms, at one instant."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inner
from softid.kernels.terms import (
    DAMPING,
    FACTOR_DAMPING,
    FACTOR_ELASTIC,
    FACTOR_INERTIA,
    FACTOR_INERTIAL,
    FORCE,
    INERTIA,
    LAW_DAMPING,
    LAW_DRIVE,
    LAW_ELASTIC,
    LAW_INERTIA,
    LAW_INERTIAL,
    N_FACTORS,
    RATE,
    SHIFT,
    STIFFNESS,
    TERM_SIZE,
    call_term,
)

Array = npt.NDArray[np.float64]
Index = npt.NDArray[np.int64]


class Equation(NamedTuple):
    """What the equation of motion consists of.

    Attributes
    ----------
    law
        Address of a law that is not affine in its state, or 0.
    law_slopes
        Address of what differentiates that law by θ: (x, v, position of the spring, u,
        acceleration, address of θ, address of the result).
    theta
        Parameters of the model, shape (K,). A law finds its constants behind them in memory, so
        this may be the beginning of a longer array.
    terms
        Addresses of the terms, shape (E,).
    eta
        Parameters of all terms one after the other, shape (H,).
    eta_from
        Where each term's parameters begin, shape (E + 1,).
    own
        Which of the Z own states belongs to each term, −1 for none, shape (E,).
    """

    law: int
    law_slopes: int
    theta: Array
    terms: Index
    eta: Array
    eta_from: Index
    own: Index


class Instants(NamedTuple):
    """The stages of a step as instants, and room for what is found there.

    Functions take the number of an instant and index these arrays: a view of a row would cost more
    than the arithmetic.

    Attributes
    ----------
    place
        Time and input, shape (2, 3).
    coefficients
        m, n, q and f of an affine law, shape (3, 4); zeros when there is none.
    points
        x, v, own states and, last, the acceleration, shape (3, 3 + Z).
    rates
        Rates of the own states, shape (3, Z).
    parts
        1 + Δm, 1 + Δd, 1 + Δq, x − s and the inertia m, shape (3, 5).
    result
        Result of one term, shape (6,).
    by_theta
        That of a law's slopes, shape (4 + K,).
    """

    place: Array
    coefficients: Array
    points: Array
    rates: Array
    parts: Array
    result: Array
    by_theta: Array


@inner
def unbalanced(equation: Equation, at: Instants, c: int) -> float:
    """Force that the equation of motion leaves unbalanced at instant ``c``; fills its rates."""
    points, result = at.points, at.result
    last = points.shape[1] - 1
    x, v, a = points[c, 0], points[c, 1], points[c, last]
    t, u = at.place[0, c], at.place[1, c]
    room = result.ctypes.data
    extra, more_m, more_d, more_q, shift = 0.0, 1.0, 1.0, 1.0, 0.0
    for e in range(equation.terms.size):
        for i in range(TERM_SIZE):
            result[i] = 0.0
        k = equation.own[e]
        mine = points[c, 2 + k] if k >= 0 else 0.0
        eta = equation.eta.ctypes.data + 8 * equation.eta_from[e]
        call_term(equation.terms[e], x, v, mine, u, t, eta, room)
        extra += result[FORCE]
        more_m += result[INERTIA]
        more_d += result[DAMPING]
        more_q += result[STIFFNESS]
        shift += result[SHIFT]
        if k >= 0:
            at.rates[c, k] = result[RATE]
    eased = x - shift
    inertia = at.coefficients[c, 0]
    damping = at.coefficients[c, 1] * v
    elastic = at.coefficients[c, 2] * eased
    drive = at.coefficients[c, 3]
    inertial = 0.0
    if equation.law != 0:
        for i in range(TERM_SIZE):
            result[i] = 0.0
        theta = equation.theta.ctypes.data
        call_term(equation.law, x, v, 0.0, u, t, theta, room)
        inertia += result[LAW_INERTIA]
        damping += result[LAW_DAMPING]
        drive += result[LAW_DRIVE]
        inertial = result[LAW_INERTIAL]
        if shift != 0.0:  # only the spring is at ease elsewhere
            for i in range(TERM_SIZE):
                result[i] = 0.0
            call_term(equation.law, eased, v, 0.0, u, t, theta, room)
        elastic += result[LAW_ELASTIC]
    parts = at.parts
    parts[c, 0], parts[c, 1], parts[c, 2] = more_m, more_d, more_q
    parts[c, 3], parts[c, 4] = eased, inertia
    heavy = (inertia * a + inertial) * more_m
    left: float = heavy + damping * more_d + elastic * more_q - drive + extra
    return left


@inner
def differentiate_law(equation: Equation, at: Instants, c: int) -> None:
    """Derivatives of the unbalanced force at instant ``c`` by θ, behind the factors.

    The parts there are those that `unbalanced` has left.
    """
    points, parts, by_theta = at.points, at.parts, at.by_theta
    a = points[c, points.shape[1] - 1]
    by_theta[FACTOR_INERTIA], by_theta[FACTOR_INERTIAL] = a * parts[c, 0], parts[c, 0]
    by_theta[FACTOR_DAMPING], by_theta[FACTOR_ELASTIC] = parts[c, 1], parts[c, 2]
    for p in range(N_FACTORS, by_theta.size):
        by_theta[p] = 0.0
    theta, room = equation.theta.ctypes.data, by_theta.ctypes.data
    u, eased = at.place[1, c], parts[c, 3]
    call_term(equation.law_slopes, points[c, 0], points[c, 1], eased, u, a, theta, room)
