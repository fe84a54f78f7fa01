"""One step of m·v′ + n·v + q·x = f, x′ = v, by two rules, and how its end answers to a push.

Everything is scalar arithmetic without a branch, to be inlined into loops over many steps. A rule
gives the map Φ of the state over a step, the state at the end, and what the sensitivities need:
with β the answer of the step's end to a force added at one place within the step, the sums over
its stages of β, β·x and β·v at each of the three places where the coefficients are known, and of
β·a over all of them.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from softid.kernels.exponential import NO_REORDERING

_R6 = float(np.sqrt(6.0))
FIRST_STAGE = (4.0 - _R6) / 10.0
SECOND_STAGE = (4.0 + _R6) / 10.0
"""Inner stages of the Radau rule as fractions of the step; its third is the step's end."""

A00, A01, A02 = (88.0 - 7.0 * _R6) / 360.0, (296.0 - 169.0 * _R6) / 1800.0, (-2 + 3 * _R6) / 225.0
A10, A11, A12 = (296.0 + 169.0 * _R6) / 1800.0, (88.0 + 7.0 * _R6) / 360.0, (-2 - 3 * _R6) / 225.0
A20, A21, A22 = (16.0 - _R6) / 36.0, (16.0 + _R6) / 36.0, 1.0 / 9.0
_INVERSE = np.linalg.inv(np.array([[A00, A01, A02], [A10, A11, A12], [A20, A21, A22]]))
((B00, B01, B02), (B10, B11, B12), (B20, B21, B22)) = _INVERSE.tolist()
B0, B1, B2 = _INVERSE.sum(axis=1).tolist()

inlined = njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING, forceinline=True)


@inlined
def rk4_map(h, n0, q0, n1, q1, n2, q2):  # type: ignore[no-untyped-def]
    """Φ of the classical Runge–Kutta step; coefficients over m at its start, middle and end."""
    half, sixth = 0.5 * h, h * (1.0 / 6.0)
    v2 = -half * q0
    a2 = -q1 - n1 * v2
    v3 = half * a2
    a3 = -q1 * (1.0 + half * v2) - n1 * v3
    v4 = h * a3
    a4 = -q2 * (1.0 + h * v3) - n2 * v4
    xx = 1.0 + sixth * (2.0 * (v2 + v3) + v4)
    vx = sixth * (2.0 * (a2 + a3) + a4 - q0)
    v2 = 1.0 - half * n0
    a2 = -q1 * half - n1 * v2
    v3 = 1.0 + half * a2
    a3 = -q1 * half * v2 - n1 * v3
    v4 = 1.0 + h * a3
    a4 = -q2 * h * v3 - n2 * v4
    xv = sixth * (1.0 + 2.0 * (v2 + v3) + v4)
    vv = 1.0 + sixth * (2.0 * (a2 + a3) + a4 - n0)
    return xx, xv, vx, vv


@inlined
def rk4_end(h, n0, q0, f0, n1, q1, f1, n2, q2, f2, x, v):  # type: ignore[no-untyped-def]
    """State after the classical Runge–Kutta step from (x, v)."""
    half, sixth = 0.5 * h, h * (1.0 / 6.0)
    a1 = f0 - q0 * x - n0 * v
    v2 = v + half * a1
    a2 = f1 - q1 * (x + half * v) - n1 * v2
    v3 = v + half * a2
    a3 = f1 - q1 * (x + half * v2) - n1 * v3
    v4 = v + h * a3
    a4 = f2 - q2 * (x + h * v3) - n2 * v4
    return x + sixth * (v + 2.0 * (v2 + v3) + v4), v + sixth * (a1 + 2.0 * (a2 + a3) + a4)


@inlined
def rk4_sums(h, over, n0, q0, f0, n1, q1, f1, n2, q2, f2, x, v):  # type: ignore[no-untyped-def]
    """Sums over the stages for the position at the end, then for the velocity.

    Each is β₀ β₁ β₂, βx₀ βx₁ βx₂, βv₀ βv₁ βv₂, βa; indices are places in the step, ``over`` is 1/m.
    """
    half, sixth = 0.5 * h, h * over * (1.0 / 6.0)
    a1 = f0 - q0 * x - n0 * v
    x2, v2 = x + half * v, v + half * a1
    a2 = f1 - q1 * x2 - n1 * v2
    x3, v3 = x + half * v2, v + half * a2
    a3 = f1 - q1 * x3 - n1 * v3
    x4, v4 = x + h * v3, v + h * a3
    a4 = f2 - q2 * x4 - n2 * v4
    third = 2.0 * sixth
    push = -n1 * half
    push3 = -q1 * half * half - n1 * half * push
    on_x3 = sixth * h
    on_v3 = third - sixth * n2 * h
    on_x2 = third * half + on_x3 * push
    on_v2 = third - sixth * q2 * h * half + on_v3 * push
    on_x1 = third * half + third * half * push + on_x3 * push3
    on_v1 = sixth + third * push + on_v3 * push3 - sixth * q2 * h * half * push
    return (
        on_x1,
        on_x2 + on_x3,
        0.0,
        on_x1 * x,
        on_x2 * x2 + on_x3 * x3,
        0.0,
        on_x1 * v,
        on_x2 * v2 + on_x3 * v3,
        0.0,
        on_x1 * a1 + on_x2 * a2 + on_x3 * a3,
        on_v1,
        on_v2 + on_v3,
        sixth,
        on_v1 * x,
        on_v2 * x2 + on_v3 * x3,
        sixth * x4,
        on_v1 * v,
        on_v2 * v2 + on_v3 * v3,
        sixth * v4,
        on_v1 * a1 + on_v2 * a2 + on_v3 * a3 + sixth * a4,
    )


@inlined
def radau_inverse(h, m, n0, q0, n1, q1, n2, q2):  # type: ignore[no-untyped-def]
    """Inverse of the matrix of the stage velocities, row by row."""
    mh = m / h
    a, b, c = mh * B00 + h * q0 * A00 + n0, mh * B01 + h * q0 * A01, mh * B02 + h * q0 * A02
    d, e, f = mh * B10 + h * q1 * A10, mh * B11 + h * q1 * A11 + n1, mh * B12 + h * q1 * A12
    g, k, o = mh * B20 + h * q2 * A20, mh * B21 + h * q2 * A21, mh * B22 + h * q2 * A22 + n2
    c0, c1, c2 = e * o - f * k, f * g - d * o, d * k - e * g
    scale = 1.0 / (a * c0 + b * c1 + c * c2)
    return (
        c0 * scale,
        (c * k - b * o) * scale,
        (b * f - c * e) * scale,
        c1 * scale,
        (a * o - c * g) * scale,
        (c * d - a * f) * scale,
        c2 * scale,
        (b * g - a * k) * scale,
        (a * e - b * d) * scale,
    )


@inlined
def radau_map(h, m, q0, q1, q2, g):  # type: ignore[no-untyped-def]
    """Φ of the Radau step and the answers of position and velocity to a force at each stage."""
    mh = m / h
    x0 = h * (A20 * g[0] + A21 * g[3] + A22 * g[6])
    x1 = h * (A20 * g[1] + A21 * g[4] + A22 * g[7])
    x2 = h * (A20 * g[2] + A21 * g[5] + A22 * g[8])
    xx = 1.0 - x0 * q0 - x1 * q1 - x2 * q2
    xv = mh * (x0 * B0 + x1 * B1 + x2 * B2)
    vx = -(g[6] * q0 + g[7] * q1 + g[8] * q2)
    vv = mh * (g[6] * B0 + g[7] * B1 + g[8] * B2)
    return xx, xv, vx, vv, x0, x1, x2


@inlined
def radau_sums(h, m, q0, f0, q1, f1, q2, f2, g, on_x, x, v):  # type: ignore[no-untyped-def]
    """Sums over the stages as in `rk4_sums`, at the three stages."""
    mh = m / h
    r0, r1, r2 = f0 - q0 * x + mh * B0 * v, f1 - q1 * x + mh * B1 * v, f2 - q2 * x + mh * B2 * v
    v0 = g[0] * r0 + g[1] * r1 + g[2] * r2
    v1 = g[3] * r0 + g[4] * r1 + g[5] * r2
    v2 = g[6] * r0 + g[7] * r1 + g[8] * r2
    x0 = x + h * (A00 * v0 + A01 * v1 + A02 * v2)
    x1 = x + h * (A10 * v0 + A11 * v1 + A12 * v2)
    x2 = x + h * (A20 * v0 + A21 * v1 + A22 * v2)
    a0 = (B00 * v0 + B01 * v1 + B02 * v2 - B0 * v) / h
    a1 = (B10 * v0 + B11 * v1 + B12 * v2 - B1 * v) / h
    a2 = (B20 * v0 + B21 * v1 + B22 * v2 - B2 * v) / h
    return (
        on_x[0],
        on_x[1],
        on_x[2],
        on_x[0] * x0,
        on_x[1] * x1,
        on_x[2] * x2,
        on_x[0] * v0,
        on_x[1] * v1,
        on_x[2] * v2,
        on_x[0] * a0 + on_x[1] * a1 + on_x[2] * a2,
        g[6],
        g[7],
        g[8],
        g[6] * x0,
        g[7] * x1,
        g[8] * x2,
        g[6] * v0,
        g[7] * v1,
        g[8] * v2,
        g[6] * a0 + g[7] * a1 + g[8] * a2,
    )
