"""One step of m·v′ + n·v + q·x = f, x′ = v, by two rules, and how its end answers to a push.

Everything is scalar arithmetic without a branch, to be inlined into loops over many steps. A rule
gives the map Φ of the state over a step, the state at the end, and what the sensitivities need:
with β the answer of the step's end to a force added at one place within the step, the sums over
its stages of β, β·x and β·v at each of the three places where the coefficients are known, and of
β·a over all of them.

What goes in and out is named, which costs nothing: the tuples are gone when the loops are compiled.
"""

from __future__ import annotations

from typing import NamedTuple

from numba import njit

from softid.kernels import radau
from softid.kernels.exponential import NO_REORDERING

FIRST_STAGE, SECOND_STAGE, _ = radau.STAGES.tolist()
"""Inner stages of the Radau rule as fractions of the step; its third is the step's end."""

((A00, A01, A02), (A10, A11, A12), (A20, A21, A22)) = radau.A.tolist()
((B00, B01, B02), (B10, B11, B12), (B20, B21, B22)) = radau.B.tolist()
B0, B1, B2 = radau.B1.tolist()
"""The rule as scalars, which loops that vectorise need."""


class Places(NamedTuple):
    """Values at the three places of a step where the coefficients are known.

    Its start, middle and end for the Runge–Kutta rule, the three stages for the Radau rule.
    """

    first: float
    second: float
    third: float


class StepMap(NamedTuple):
    """Φ of a step: by how much the position and the speed at its end follow those at its start."""

    xx: float
    xv: float
    vx: float
    vv: float


class StageSums(NamedTuple):
    """Sums over the stages of a step for one component of the state at its end.

    Attributes
    ----------
    answer, by_x, by_v
        β, β·x and β·v at each place.
    by_a
        β·a over all places.
    """

    answer: Places
    by_x: Places
    by_v: Places
    by_a: float


class StageVelocities(NamedTuple):
    """Inverse of the matrix of the stage velocities: a row for each, by the force at each stage."""

    first: Places
    second: Places
    third: Places


inlined = njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING, forceinline=True)


@inlined
def line(slope, at, level):  # type: ignore[no-untyped-def]
    """`Places` of slope·at + level."""
    return Places(slope * at.first + level, slope * at.second + level, slope * at.third + level)


@inlined
def times(at, factor):  # type: ignore[no-untyped-def]
    """`Places` of at·factor."""
    return Places(at.first * factor, at.second * factor, at.third * factor)


@inlined
def product(a, b):  # type: ignore[no-untyped-def]
    """`Places` of a·b."""
    return Places(a.first * b.first, a.second * b.second, a.third * b.third)


@inlined
def dot(a, b):  # type: ignore[no-untyped-def]
    """Sum of a·b over the places."""
    return a.first * b.first + a.second * b.second + a.third * b.third


@inlined
def rk4_map(h, n, q):  # type: ignore[no-untyped-def]
    """`StepMap` of the classical Runge–Kutta step; ``n`` and ``q`` are `Places`, over m."""
    half, sixth = 0.5 * h, h * (1.0 / 6.0)
    v2 = -half * q.first
    a2 = -q.second - n.second * v2
    v3 = half * a2
    a3 = -q.second * (1.0 + half * v2) - n.second * v3
    v4 = h * a3
    a4 = -q.third * (1.0 + h * v3) - n.third * v4
    xx = 1.0 + sixth * (2.0 * (v2 + v3) + v4)
    vx = sixth * (2.0 * (a2 + a3) + a4 - q.first)
    v2 = 1.0 - half * n.first
    a2 = -q.second * half - n.second * v2
    v3 = 1.0 + half * a2
    a3 = -q.second * half * v2 - n.second * v3
    v4 = 1.0 + h * a3
    a4 = -q.third * h * v3 - n.third * v4
    xv = sixth * (1.0 + 2.0 * (v2 + v3) + v4)
    vv = 1.0 + sixth * (2.0 * (a2 + a3) + a4 - n.first)
    return StepMap(xx, xv, vx, vv)


@inlined
def rk4_end(h, n, q, f, x, v):  # type: ignore[no-untyped-def]
    """Position and speed after the classical Runge–Kutta step from (x, v)."""
    half, sixth = 0.5 * h, h * (1.0 / 6.0)
    a1 = f.first - q.first * x - n.first * v
    v2 = v + half * a1
    a2 = f.second - q.second * (x + half * v) - n.second * v2
    v3 = v + half * a2
    a3 = f.second - q.second * (x + half * v2) - n.second * v3
    v4 = v + h * a3
    a4 = f.third - q.third * (x + h * v3) - n.third * v4
    return x + sixth * (v + 2.0 * (v2 + v3) + v4), v + sixth * (a1 + 2.0 * (a2 + a3) + a4)


@inlined
def rk4_sums(h, over, n, q, f, x, v):  # type: ignore[no-untyped-def]
    """`StageSums` for the position at the end, and for the speed; ``over`` is 1/m."""
    half, sixth = 0.5 * h, h * over * (1.0 / 6.0)
    a1 = f.first - q.first * x - n.first * v
    x2, v2 = x + half * v, v + half * a1
    a2 = f.second - q.second * x2 - n.second * v2
    x3, v3 = x + half * v2, v + half * a2
    a3 = f.second - q.second * x3 - n.second * v3
    x4, v4 = x + h * v3, v + h * a3
    a4 = f.third - q.third * x4 - n.third * v4
    third = 2.0 * sixth
    push = -n.second * half
    push3 = -q.second * half * half - n.second * half * push
    on_x3 = sixth * h
    on_v3 = third - sixth * n.third * h
    on_x2 = third * half + on_x3 * push
    on_v2 = third - sixth * q.third * h * half + on_v3 * push
    on_x1 = third * half + third * half * push + on_x3 * push3
    on_v1 = sixth + third * push + on_v3 * push3 - sixth * q.third * h * half * push
    return (
        StageSums(
            Places(on_x1, on_x2 + on_x3, 0.0),
            Places(on_x1 * x, on_x2 * x2 + on_x3 * x3, 0.0),
            Places(on_x1 * v, on_x2 * v2 + on_x3 * v3, 0.0),
            on_x1 * a1 + on_x2 * a2 + on_x3 * a3,
        ),
        StageSums(
            Places(on_v1, on_v2 + on_v3, sixth),
            Places(on_v1 * x, on_v2 * x2 + on_v3 * x3, sixth * x4),
            Places(on_v1 * v, on_v2 * v2 + on_v3 * v3, sixth * v4),
            on_v1 * a1 + on_v2 * a2 + on_v3 * a3 + sixth * a4,
        ),
    )


@inlined
def radau_velocities(h, m, n, q):  # type: ignore[no-untyped-def]
    """`StageVelocities` of the Radau step."""
    mh = m / h
    a = mh * B00 + h * q.first * A00 + n.first
    b, c = mh * B01 + h * q.first * A01, mh * B02 + h * q.first * A02
    d, f = mh * B10 + h * q.second * A10, mh * B12 + h * q.second * A12
    e = mh * B11 + h * q.second * A11 + n.second
    g, k = mh * B20 + h * q.third * A20, mh * B21 + h * q.third * A21
    o = mh * B22 + h * q.third * A22 + n.third
    c0, c1, c2 = e * o - f * k, f * g - d * o, d * k - e * g
    scale = 1.0 / (a * c0 + b * c1 + c * c2)
    return StageVelocities(
        Places(c0 * scale, (c * k - b * o) * scale, (b * f - c * e) * scale),
        Places(c1 * scale, (a * o - c * g) * scale, (c * d - a * f) * scale),
        Places(c2 * scale, (b * g - a * k) * scale, (a * e - b * d) * scale),
    )


@inlined
def radau_map(h, m, q, g):  # type: ignore[no-untyped-def]
    """`StepMap` of the Radau step, and the answer of its last position to a force at each stage.

    ``g`` are the `StageVelocities`; the answer of the last speed is their third row.
    """
    mh = m / h
    on_v = g.third
    x0 = h * (A20 * g.first.first + A21 * g.second.first + A22 * on_v.first)
    x1 = h * (A20 * g.first.second + A21 * g.second.second + A22 * on_v.second)
    x2 = h * (A20 * g.first.third + A21 * g.second.third + A22 * on_v.third)
    xx = 1.0 - x0 * q.first - x1 * q.second - x2 * q.third
    xv = mh * (x0 * B0 + x1 * B1 + x2 * B2)
    vx = -(on_v.first * q.first + on_v.second * q.second + on_v.third * q.third)
    vv = mh * (on_v.first * B0 + on_v.second * B1 + on_v.third * B2)
    return StepMap(xx, xv, vx, vv), Places(x0, x1, x2)


@inlined
def radau_sums(h, m, q, f, g, on_x, x, v):  # type: ignore[no-untyped-def]
    """`StageSums` as in `rk4_sums`, at the three stages; ``g`` and ``on_x`` as in `radau_map`."""
    mh = m / h
    r = Places(
        f.first - q.first * x + mh * B0 * v,
        f.second - q.second * x + mh * B1 * v,
        f.third - q.third * x + mh * B2 * v,
    )
    v0, v1, v2 = dot(g.first, r), dot(g.second, r), dot(g.third, r)
    x0 = x + h * (A00 * v0 + A01 * v1 + A02 * v2)
    x1 = x + h * (A10 * v0 + A11 * v1 + A12 * v2)
    x2 = x + h * (A20 * v0 + A21 * v1 + A22 * v2)
    a0 = (B00 * v0 + B01 * v1 + B02 * v2 - B0 * v) / h
    a1 = (B10 * v0 + B11 * v1 + B12 * v2 - B1 * v) / h
    a2 = (B20 * v0 + B21 * v1 + B22 * v2 - B2 * v) / h
    xs, vs, on_v = Places(x0, x1, x2), Places(v0, v1, v2), g.third
    accelerations = Places(a0, a1, a2)
    return (
        StageSums(on_x, product(on_x, xs), product(on_x, vs), dot(on_x, accelerations)),
        StageSums(on_v, product(on_v, xs), product(on_v, vs), dot(on_v, accelerations)),
    )
