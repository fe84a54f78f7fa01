"""Coefficients of the muscle law at any pressure, and their derivatives."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels import exponential as exponentials
from softid.kernels.cache_invalidation import follow_sources
from softid.kernels.decorators import kernel
from softid.kernels.exponential import exponential

Array = npt.NDArray[np.float64]

KPA_PER_BAR = 100.0
"""b1 and b2 are per bar, as in the paper; pressures are in kPa."""

_PER_KPA = 1.0 / KPA_PER_BAR
"""A product is cheaper than a quotient, sample by sample."""


@kernel
def coefficients(pressure_kpa: Array, theta: Array) -> tuple[Array, Array, Array]:
    """N, Q and P at the given pressures.

    Parameters
    ----------
    pressure_kpa
        Any pressures, shape (L,).
    theta
        M, a1, b1, c1, a2, b2, c2.

    Returns
    -------
    damping, stiffness, force
        N = a2·exp(b2·p) + c2, Q = a1·exp(b1·p) + c1 and P = exp(b1·p), each of shape (L,).
    """
    a1, b1, c1, a2, b2, c2 = theta[1], theta[2], theta[3], theta[4], theta[5], theta[6]
    n = pressure_kpa.size
    damping, stiffness, force = np.empty(n), np.empty(n), np.empty(n)
    for i in range(n):
        p = pressure_kpa[i] * _PER_KPA
        force[i] = exponential(b1 * p)
        stiffness[i] = a1 * force[i] + c1
        damping[i] = a2 * exponential(b2 * p) + c2
    return damping, stiffness, force


follow_sources(coefficients, (exponentials,))


@kernel
def coefficient_derivatives(pressure_bar: Array, theta: Array) -> tuple[Array, Array, Array]:
    """∂N/∂θ, ∂Q/∂θ and ∂P/∂θ at the given pressures, each of shape (L, 7)."""
    a1, b1, a2, b2 = theta[1], theta[2], theta[4], theta[5]
    n = pressure_bar.size
    damping_by = np.zeros((n, 7))
    stiffness_by = np.zeros((n, 7))
    force_by = np.zeros((n, 7))
    for i in range(n):
        p = pressure_bar[i]
        e1 = np.exp(b1 * p)
        e2 = np.exp(b2 * p)
        force_by[i, 2] = p * e1
        stiffness_by[i, 1] = e1
        stiffness_by[i, 2] = a1 * p * e1
        stiffness_by[i, 3] = 1.0
        damping_by[i, 4] = e2
        damping_by[i, 5] = a2 * p * e2
        damping_by[i, 6] = 1.0
    return damping_by, stiffness_by, force_by


@kernel
def pack(pressure_kpa: Array, theta: Array, packed: Array, by: Array) -> None:
    """M, N, Q and P at the stages of many steps, and their derivatives.

    Parameters
    ----------
    pressure_kpa
        Pressures, shape (L, 3).
    theta
        As in `coefficients`.
    packed
        Receives the coefficients, shape (L, 3, 4).
    by
        Receives ∂(M, N, Q, P)/∂θ and a zero, shape (L, 3, 4, 8); of length 0 when none are wanted.
    """
    mass, a1, b1, c1 = theta[0], theta[1], theta[2], theta[3]
    a2, b2, c2 = theta[4], theta[5], theta[6]
    wanted = by.shape[0] > 0
    for i in range(pressure_kpa.shape[0]):
        for c in range(3):
            p = pressure_kpa[i, c] / KPA_PER_BAR
            e1, e2 = np.exp(b1 * p), np.exp(b2 * p)
            packed[i, c, 0] = mass
            packed[i, c, 1] = a2 * e2 + c2
            packed[i, c, 2] = a1 * e1 + c1
            packed[i, c, 3] = e1
            if wanted:
                for q in range(4):
                    for k in range(8):
                        by[i, c, q, k] = 0.0
                by[i, c, 0, 0] = 1.0
                by[i, c, 1, 4] = e2
                by[i, c, 1, 5] = a2 * p * e2
                by[i, c, 1, 6] = 1.0
                by[i, c, 2, 1] = e1
                by[i, c, 2, 2] = a1 * p * e1
                by[i, c, 2, 3] = 1.0
                by[i, c, 3, 2] = p * e1
