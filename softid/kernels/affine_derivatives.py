"""Derivatives of the motion over a block of steps by the parameters and the initial state.

See `softid.kernels.affine_blocks` for the law, the block and its workspace ``w``.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.affine_blocks import (
    BY,
    BY_V,
    D1,
    D2,
    E1,
    E2,
    LANES,
    N_PARAMETERS,
    N_STATES,
    POINTS,
    PVV,
    PVX,
    PXV,
    PXX,
    ROWS,
    STARTS_V,
    STARTS_X,
    STEP,
    STEPS,
    VV,
    VX,
    XV,
    XX,
    V,
    X,
)
from softid.kernels.affine_coefficients import radau_places, rk4_places
from softid.kernels.affine_steps import (
    dot,
    inlined,
    line,
    radau_map,
    radau_sums,
    radau_velocities,
    rk4_sums,
    times,
)
from softid.kernels.exponential import NO_REORDERING

Array = npt.NDArray[np.float64]


@inlined
def _pushes(s, e, d, f, g, a1, a2):  # type: ignore[no-untyped-def]
    """What a change of each parameter pushes, from the `StageSums` of one component of the state.

    ``e``, ``d``, ``f`` and ``g`` are E₁, ∂E₁/∂b1, E₂ and ∂E₂/∂b2.
    """
    b, x, v = s.answer, s.by_x, s.by_v
    return (
        -s.by_a,
        -dot(e, x),
        d.first * (b.first - a1 * x.first)
        + d.second * (b.second - a1 * x.second)
        + d.third * (b.third - a1 * x.third),
        -(x.first + x.second + x.third),
        -dot(f, v),
        -a2 * dot(g, v),
        -(v.first + v.second + v.third),
    )


@inlined
def _advance(w, at, speed, xx, xv, vx, vv, push_x, push_v):  # type: ignore[no-untyped-def]
    sx, sv = w[at], w[speed]
    w[at + LANES] = xx * sx + xv * sv + push_x
    w[speed] = vx * sx + vv * sv + push_v


@inlined
def _advance_all(w, i, lane, s, e, d, f, g, a1, a2):  # type: ignore[no-untyped-def]
    xx, xv, vx, vv = w[XX + i], w[XV + i], w[VX + i], w[VV + i]
    px = _pushes(s[0], e, d, f, g, a1, a2)
    pv = _pushes(s[1], e, d, f, g, a1, a2)
    at, speed = BY + i, BY_V + lane
    _advance(w, at + 0 * POINTS, speed + 0 * LANES, xx, xv, vx, vv, px[0], pv[0])
    _advance(w, at + 1 * POINTS, speed + 1 * LANES, xx, xv, vx, vv, px[1], pv[1])
    _advance(w, at + 2 * POINTS, speed + 2 * LANES, xx, xv, vx, vv, px[2], pv[2])
    _advance(w, at + 3 * POINTS, speed + 3 * LANES, xx, xv, vx, vv, px[3], pv[3])
    _advance(w, at + 4 * POINTS, speed + 4 * LANES, xx, xv, vx, vv, px[4], pv[4])
    _advance(w, at + 5 * POINTS, speed + 5 * LANES, xx, xv, vx, vv, px[5], pv[5])
    _advance(w, at + 6 * POINTS, speed + 6 * LANES, xx, xv, vx, vv, px[6], pv[6])


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def differentiate_rk4(w: Array, theta: Array) -> None:
    """Derivatives by the parameters over every stretch from zero, by the Runge–Kutta rule."""
    _clear_derivatives(w)
    over, a1, c1, a2, c2 = 1.0 / theta[0], theta[1], theta[3], theta[4], theta[6]
    a1m, c1m, a2m, c2m = a1 * over, c1 * over, a2 * over, c2 * over
    for j in range(ROWS):
        for lane in range(LANES):
            i = j * LANES + lane
            h = w[STEP + i]
            e, d = rk4_places(w, E1, i), rk4_places(w, D1, i)
            f, g = rk4_places(w, E2, i), rk4_places(w, D2, i)
            n, q = line(a2m, f, c2m), line(a1m, e, c1m)
            s = rk4_sums(h, over, n, q, times(e, over), w[X + i], w[V + i])
            _advance_all(w, i, lane, s, e, d, f, g, a1, a2)


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def differentiate_radau(w: Array, theta: Array) -> None:
    """Derivatives by the parameters over every stretch from zero, by the Radau rule."""
    _clear_derivatives(w)
    m, a1, c1, a2, c2 = theta[0], theta[1], theta[3], theta[4], theta[6]
    for j in range(ROWS):
        for lane in range(LANES):
            i = j * LANES + lane
            h = w[STEP + i]
            e, d = radau_places(w, E1, i), radau_places(w, D1, i)
            f, g = radau_places(w, E2, i), radau_places(w, D2, i)
            q = line(a1, e, c1)
            velocities = radau_velocities(h, m, line(a2, f, c2), q)
            _, on_x = radau_map(h, m, q, velocities)
            s = radau_sums(h, m, q, e, velocities, on_x, w[X + i], w[V + i])
            _advance_all(w, i, lane, s, e, d, f, g, a1, a2)


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _clear_derivatives(w: Array) -> None:
    for p in range(N_PARAMETERS):
        for lane in range(LANES):
            w[BY + p * POINTS + lane] = 0.0
            w[BY_V + p * LANES + lane] = 0.0


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def join_derivatives(w: Array, tangent: Array) -> None:
    """Move every stretch's derivatives to their true start; ``tangent`` goes on to the block's end.

    ``tangent`` is ∂(x, v)/∂(parameters, x₀, v₀), shape (2, 9).
    """
    for p in range(N_PARAMETERS + N_STATES):
        x, v = tangent[0, p], tangent[1, p]
        for lane in range(LANES):
            w[STARTS_X + p * LANES + lane], w[STARTS_V + p * LANES + lane] = x, v
            k = STEPS + lane
            x, v = w[PXX + k] * x + w[PXV + k] * v, w[PVX + k] * x + w[PVV + k] * v
            if p < N_PARAMETERS:
                x += w[BY + p * POINTS + k]
                v += w[BY_V + p * LANES + lane]
        tangent[0, p], tangent[1, p] = x, v
    for j in range(ROWS):
        for lane in range(LANES):
            i = (j + 1) * LANES + lane
            at, xx, xv = BY + i, w[PXX + i], w[PXV + i]
            _join(w, at, lane, xx, xv, w[at])
            _join(w, at + 1 * POINTS, lane + 1 * LANES, xx, xv, w[at + 1 * POINTS])
            _join(w, at + 2 * POINTS, lane + 2 * LANES, xx, xv, w[at + 2 * POINTS])
            _join(w, at + 3 * POINTS, lane + 3 * LANES, xx, xv, w[at + 3 * POINTS])
            _join(w, at + 4 * POINTS, lane + 4 * LANES, xx, xv, w[at + 4 * POINTS])
            _join(w, at + 5 * POINTS, lane + 5 * LANES, xx, xv, w[at + 5 * POINTS])
            _join(w, at + 6 * POINTS, lane + 6 * LANES, xx, xv, w[at + 6 * POINTS])
            _join(w, at + 7 * POINTS, lane + 7 * LANES, xx, xv, 0.0)
            _join(w, at + 8 * POINTS, lane + 8 * LANES, xx, xv, 0.0)


@inlined
def _join(w, at, start, xx, xv, own):  # type: ignore[no-untyped-def]
    w[at] = own + xx * w[STARTS_X + start] + xv * w[STARTS_V + start]
