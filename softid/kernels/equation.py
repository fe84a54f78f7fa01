"""The equation of motion with extra terms, at one instant."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numba import njit

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


class Equation(NamedTuple):
    """What the equation of motion consists of.

    Attributes
    ----------
    law
        Address of a law that is not affine in its state, or 0.
    theta
        Parameters of the model, shape (K,).
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
    theta: Array
    terms: Index
    eta: Array
    eta_from: Index
    own: Index


class Instant(NamedTuple):
    """Room for what is found at one instant.

    Attributes
    ----------
    rates
        Rates of the own states, shape (Z,).
    parts
        1 + Δm, 1 + Δd, 1 + Δq, x − s and the inertia m, shape (5,).
    result
        Result of one term, shape (6,).
    """

    rates: Array
    parts: Array
    result: Array


@njit(cache=True, nogil=True, error_model="numpy")
def unbalanced(
    equation: Equation,
    coefficients: Array,
    x: float,
    v: float,
    a: float,
    z: Array,
    u: float,
    t: float,
    found: Instant,
) -> float:
    """Force that the equation of motion leaves unbalanced.

    Parameters
    ----------
    equation
        The terms.
    coefficients
        m, n, q and f of an affine law, shape (4,); zeros when there is none.
    x, v, a, z, u, t
        Position, velocity, acceleration, own states of shape (Z,), input and time.
    found
        Receives rates and parts.
    """
    result, parts = found.result, found.parts
    extra, more_m, more_d, more_q, shift = 0.0, 1.0, 1.0, 1.0, 0.0
    for e in range(equation.terms.size):
        for i in range(TERM_SIZE):
            result[i] = 0.0
        k = equation.own[e]
        mine = z[k] if k >= 0 else 0.0
        eta = equation.eta.ctypes.data + 8 * equation.eta_from[e]
        call_term(equation.terms[e], x, v, mine, u, t, eta, result.ctypes.data)
        extra += result[FORCE]
        more_m += result[INERTIA]
        more_d += result[DAMPING]
        more_q += result[STIFFNESS]
        shift += result[SHIFT]
        if k >= 0:
            found.rates[k] = result[RATE]
    eased = x - shift
    inertia = coefficients[0]
    damping = coefficients[1] * v
    elastic = coefficients[2] * eased
    drive = coefficients[3]
    if equation.law != 0:
        for i in range(TERM_SIZE):
            result[i] = 0.0
        theta = equation.theta.ctypes.data
        call_term(equation.law, eased, v, 0.0, u, t, theta, result.ctypes.data)
        inertia += result[LAW_INERTIA]
        damping += result[LAW_DAMPING]
        elastic += result[LAW_ELASTIC]
        drive += result[LAW_DRIVE]
    parts[0], parts[1], parts[2], parts[3], parts[4] = more_m, more_d, more_q, eased, inertia
    left: float = inertia * more_m * a + damping * more_d + elastic * more_q - drive + extra
    return left
