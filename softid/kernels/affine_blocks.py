"""A block of steps laid out for vector instructions, and what runs over it.

A block holds LANES stretches of ROWS steps that follow each other in time; row j holds step j of
every stretch, so that one vector instruction advances all stretches by a step. Every stretch first
runs from zero along with its propagator; its true start then follows from the end of the one
before it, since the law is affine in its state. All arrays of a block lie in one flat workspace at
constant places: the compiler then sees that they do not overlap.

The law is m·ẍ + (a2·E₂ + c2)·ẋ + (a1·E₁ + c1)·x = E₁, where E₁ and E₂ depend on the input alone:
for the muscle they are exp(b1·p) and exp(b2·p); the oscillator has E₁ = G·(u − offset) and a1 = a2
= 0. Parameters are m, a1, b1, c1, a2, b2, c2, b1 standing for whatever E₁ depends on.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.affine_steps import (
    FIRST_STAGE,
    SECOND_STAGE,
    Places,
    dot,
    inlined,
    line,
    radau_map,
    radau_sums,
    radau_velocities,
    rk4_end,
    rk4_map,
    rk4_sums,
    times,
)
from softid.kernels.exponential import NO_REORDERING, exponential

Array = npt.NDArray[np.float64]

LANES = 8
ROWS = 16
STEPS = ROWS * LANES
POINTS = STEPS + LANES
"""Starts of all steps and, in the last row, the ends of the stretches."""

MUSCLE, OSCILLATOR = 0, 1
RK4, RADAU = 0, 1
N_PARAMETERS = 7
N_STATES = 2

INPUT, STEP = 0 * POINTS, 1 * POINTS
_START, _INNER, _OUTER = 2 * POINTS, 6 * POINTS, 10 * POINTS
_E1, _D1, _E2, _D2 = 0 * POINTS, 1 * POINTS, 2 * POINTS, 3 * POINTS
"""E₁, ∂E₁/∂b1, E₂ and ∂E₂/∂b2 at starts and at the one or two inner places of every step."""

_XX, _XV, _VX, _VV = 14 * POINTS, 15 * POINTS, 16 * POINTS, 17 * POINTS
_PXX, _PXV, _PVX, _PVV = 18 * POINTS, 19 * POINTS, 20 * POINTS, 21 * POINTS
"""Φ of every step, and the propagator from the start of its stretch."""

X, V = 22 * POINTS, 23 * POINTS
BY = 24 * POINTS
"""∂x by the parameters and the initial state at the ends of the steps."""

ONE = BY + (N_PARAMETERS + N_STATES) * POINTS
RESIDUAL = ONE + POINTS
"""Share of every step's end in the cost, 0 or 1, and y and then the residual there; after `BY`."""

_ZERO = RESIDUAL + POINTS
_BY_V = _ZERO + POINTS
_STARTS_X = _BY_V + N_PARAMETERS * LANES
_STARTS_V = _STARTS_X + (N_PARAMETERS + N_STATES) * LANES
"""Derivatives by the parameters at the running row, and what every stretch starts from."""

_ROW_X = _STARTS_V + (N_PARAMETERS + N_STATES) * LANES
_ROW_V = _ROW_X + POINTS
SIZE = _ROW_V + POINTS
N_COLUMNS = N_PARAMETERS + N_STATES + 2
N_PADDED = N_COLUMNS + 1
"""Columns from `BY` on that are summed, and with a last one of zeros that makes them even."""

GIVEN = (_INNER + _D1, _OUTER + _D1, _START + _D1 + LANES)
"""Where `fill_from_stages` expects the input at the three stages of every step."""

SUMMING = {"contract", "arcp", "nsz", "reassoc"}


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def fill_coefficients(w: Array, law: int, rule: int, theta: Array) -> None:
    """E₁, E₂ and their slopes at all places of a block's steps."""
    if law == OSCILLATOR:
        _fill_oscillator(w, rule, theta)
        return
    b1, b2 = theta[2], theta[5]
    _fill_starts(w, b1, b2)
    if rule == RK4:
        _fill_middles(w, b1, b2)
    else:
        _fill_stages(w, b1, b2)


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _fill_starts(w: Array, b1: float, b2: float) -> None:
    for i in range(POINTS):
        u = w[INPUT + i]
        e1, e2 = exponential(b1 * u), exponential(b2 * u)
        w[_START + _E1 + i], w[_START + _D1 + i] = e1, u * e1
        w[_START + _E2 + i], w[_START + _D2 + i] = e2, u * e2


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _fill_middles(w: Array, b1: float, b2: float) -> None:
    for i in range(STEPS):
        u = 0.5 * (w[INPUT + i] + w[INPUT + i + LANES])
        e1, e2 = exponential(b1 * u), exponential(b2 * u)
        w[_INNER + _E1 + i], w[_INNER + _D1 + i] = e1, u * e1
        w[_INNER + _E2 + i], w[_INNER + _D2 + i] = e2, u * e2


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _fill_stages(w: Array, b1: float, b2: float) -> None:
    for i in range(STEPS):
        u = w[INPUT + i] + FIRST_STAGE * (w[INPUT + i + LANES] - w[INPUT + i])
        e1, e2 = exponential(b1 * u), exponential(b2 * u)
        w[_INNER + _E1 + i], w[_INNER + _D1 + i] = e1, u * e1
        w[_INNER + _E2 + i], w[_INNER + _D2 + i] = e2, u * e2
    for i in range(STEPS):
        u = w[INPUT + i] + SECOND_STAGE * (w[INPUT + i + LANES] - w[INPUT + i])
        e1, e2 = exponential(b1 * u), exponential(b2 * u)
        w[_OUTER + _E1 + i], w[_OUTER + _D1 + i] = e1, u * e1
        w[_OUTER + _E2 + i], w[_OUTER + _D2 + i] = e2, u * e2


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _fill_oscillator(w: Array, rule: int, theta: Array) -> None:
    offset, gain = theta[2], theta[7]
    inner = 0.5 if rule == RK4 else FIRST_STAGE
    for i in range(POINTS):
        w[_START + _E1 + i] = gain * (w[INPUT + i] - offset)
        w[_START + _D1 + i] = w[_INNER + _D1 + i] = w[_OUTER + _D1 + i] = -gain
        w[_START + _E2 + i] = w[_INNER + _E2 + i] = w[_OUTER + _E2 + i] = 0.0
        w[_START + _D2 + i] = w[_INNER + _D2 + i] = w[_OUTER + _D2 + i] = 0.0
    for i in range(STEPS):
        start = w[_START + _E1 + i]
        rise = w[_START + _E1 + i + LANES] - start
        w[_INNER + _E1 + i] = start + inner * rise
        w[_OUTER + _E1 + i] = start + SECOND_STAGE * rise


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def fill_from_stages(w: Array, law: int, theta: Array) -> None:
    """The same where the input is known at the stages alone, and stands at `GIVEN`."""
    b1, b2 = theta[2], theta[5]
    for at in (_INNER, _OUTER, _START + LANES):
        if law == OSCILLATOR:
            for i in range(STEPS):
                w[at + _E1 + i] = theta[7] * (w[at + _D1 + i] - b1)
                w[at + _D1 + i] = -theta[7]
                w[at + _E2 + i], w[at + _D2 + i] = 0.0, 0.0
        else:
            for i in range(STEPS):
                u = w[at + _D1 + i]
                e1, e2 = exponential(b1 * u), exponential(b2 * u)
                w[at + _E1 + i], w[at + _D1 + i] = e1, u * e1
                w[at + _E2 + i], w[at + _D2 + i] = e2, u * e2


@inlined
def _rk4_places(w, what, i):  # type: ignore[no-untyped-def]
    """E₁, E₂ or a slope at the start, the middle and the end of step ``i``."""
    return Places(w[_START + what + i], w[_INNER + what + i], w[_START + what + i + LANES])


@inlined
def _radau_places(w, what, i):  # type: ignore[no-untyped-def]
    """E₁, E₂ or a slope at the three stages of step ``i``."""
    return Places(w[_INNER + what + i], w[_OUTER + what + i], w[_START + what + i + LANES])


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def run_rk4(w: Array, theta: Array) -> None:
    """Every stretch from zero, with its propagator, by the Runge–Kutta rule."""
    over = 1.0 / theta[0]
    a1, c1, a2, c2 = theta[1] * over, theta[3] * over, theta[4] * over, theta[6] * over
    for j in range(ROWS):
        for lane in range(LANES):
            i = j * LANES + lane
            k = i + LANES
            h = w[STEP + i]
            e = _rk4_places(w, _E1, i)
            n, q = line(a2, _rk4_places(w, _E2, i), c2), line(a1, e, c1)
            xx, xv, vx, vv = rk4_map(h, n, q)
            x, v = rk4_end(h, n, q, times(e, over), w[X + i], w[V + i])
            w[X + k], w[V + k] = x, v
            w[_XX + i], w[_XV + i], w[_VX + i], w[_VV + i] = xx, xv, vx, vv
            pxx, pxv, pvx, pvv = w[_PXX + i], w[_PXV + i], w[_PVX + i], w[_PVV + i]
            w[_PXX + k] = xx * pxx + xv * pvx
            w[_PXV + k] = xx * pxv + xv * pvv
            w[_PVX + k] = vx * pxx + vv * pvx
            w[_PVV + k] = vx * pxv + vv * pvv


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def run_radau(w: Array, theta: Array) -> None:
    """Every stretch from zero, with its propagator, by the Radau rule."""
    m, a1, c1, a2, c2 = theta[0], theta[1], theta[3], theta[4], theta[6]
    for j in range(ROWS):
        for lane in range(LANES):
            i = j * LANES + lane
            k = i + LANES
            h = w[STEP + i]
            e = _radau_places(w, _E1, i)
            n, q = line(a2, _radau_places(w, _E2, i), c2), line(a1, e, c1)
            g = radau_velocities(h, m, n, q)
            (xx, xv, vx, vv), (x0, x1, x2) = radau_map(h, m, q, g)
            (e0, e1, e2), (v0, v1, v2) = e, g.third
            x, v = w[X + i], w[V + i]
            w[X + k] = xx * x + xv * v + x0 * e0 + x1 * e1 + x2 * e2
            w[V + k] = vx * x + vv * v + v0 * e0 + v1 * e1 + v2 * e2
            w[_XX + i], w[_XV + i], w[_VX + i], w[_VV + i] = xx, xv, vx, vv
            pxx, pxv, pvx, pvv = w[_PXX + i], w[_PXV + i], w[_PVX + i], w[_PVV + i]
            w[_PXX + k] = xx * pxx + xv * pvx
            w[_PXV + k] = xx * pxv + xv * pvv
            w[_PVX + k] = vx * pxx + vv * pvx
            w[_PVV + k] = vx * pxv + vv * pvv


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def reset(w: Array) -> None:
    """Zero state and unit propagator at the start of every stretch."""
    for lane in range(LANES):
        w[X + lane], w[V + lane] = 0.0, 0.0
        w[_PXX + lane], w[_PXV + lane], w[_PVX + lane], w[_PVV + lane] = 1.0, 0.0, 0.0, 1.0


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def join_states(w: Array, state: Array) -> None:
    """Move every stretch to its true start; ``state`` goes on to the end of the block."""
    x, v = state[0], state[1]
    for lane in range(LANES):
        w[_ROW_X + lane], w[_ROW_V + lane] = x, v
        k = STEPS + lane
        x, v = (
            w[X + k] + w[_PXX + k] * x + w[_PXV + k] * v,
            w[V + k] + w[_PVX + k] * x + w[_PVV + k] * v,
        )
    state[0], state[1] = x, v
    for i in range(STEPS):  # the start of a stretch, written beside every row
        w[_ROW_X + LANES + i], w[_ROW_V + LANES + i] = w[_ROW_X + i], w[_ROW_V + i]
    for i in range(POINTS):
        w[X + i] += w[_PXX + i] * w[_ROW_X + i] + w[_PXV + i] * w[_ROW_V + i]
        w[V + i] += w[_PVX + i] * w[_ROW_X + i] + w[_PVV + i] * w[_ROW_V + i]


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
    xx, xv, vx, vv = w[_XX + i], w[_XV + i], w[_VX + i], w[_VV + i]
    px = _pushes(s[0], e, d, f, g, a1, a2)
    pv = _pushes(s[1], e, d, f, g, a1, a2)
    at, speed = BY + i, _BY_V + lane
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
            e, d = _rk4_places(w, _E1, i), _rk4_places(w, _D1, i)
            f, g = _rk4_places(w, _E2, i), _rk4_places(w, _D2, i)
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
            e, d = _radau_places(w, _E1, i), _radau_places(w, _D1, i)
            f, g = _radau_places(w, _E2, i), _radau_places(w, _D2, i)
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
            w[_BY_V + p * LANES + lane] = 0.0


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def join_derivatives(w: Array, tangent: Array) -> None:
    """Move every stretch's derivatives to their true start; ``tangent`` goes on to the block's end.

    ``tangent`` is ∂(x, v)/∂(parameters, x₀, v₀), shape (2, 9).
    """
    for p in range(N_PARAMETERS + N_STATES):
        x, v = tangent[0, p], tangent[1, p]
        for lane in range(LANES):
            w[_STARTS_X + p * LANES + lane], w[_STARTS_V + p * LANES + lane] = x, v
            k = STEPS + lane
            x, v = w[_PXX + k] * x + w[_PXV + k] * v, w[_PVX + k] * x + w[_PVV + k] * v
            if p < N_PARAMETERS:
                x += w[BY + p * POINTS + k]
                v += w[_BY_V + p * LANES + lane]
        tangent[0, p], tangent[1, p] = x, v
    for j in range(ROWS):
        for lane in range(LANES):
            i = (j + 1) * LANES + lane
            at, xx, xv = BY + i, w[_PXX + i], w[_PXV + i]
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
    w[at] = own + xx * w[_STARTS_X + start] + xv * w[_STARTS_V + start]


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def select_ends(w: Array, gain: float, level: float) -> None:
    """Residual y − (gain·x + level) at the ends of the steps, and zero rows where none counts."""
    for i in range(LANES, POINTS):
        w[RESIDUAL + i] = w[ONE + i] * (w[RESIDUAL + i] - level - gain * w[X + i])
    for p in range(N_PARAMETERS + N_STATES):
        for i in range(LANES, POINTS):
            w[BY + p * POINTS + i] *= w[ONE + i]


@njit(nogil=True, error_model="numpy", fastmath=SUMMING)
def add_gram(w: Array, gram: Array) -> None:
    """Add all products of two columns, shape (12, 12), blocks on and below the diagonal."""
    for a in range(0, N_PADDED, 2):
        for b in range(0, a + 1, 2):
            t00, t01, t10, t11 = 0.0, 0.0, 0.0, 0.0
            for i in range(LANES, POINTS):
                a0, a1 = w[BY + a * POINTS + i], w[BY + (a + 1) * POINTS + i]
                b0, b1 = w[BY + b * POINTS + i], w[BY + (b + 1) * POINTS + i]
                t00 += a0 * b0
                t01 += a0 * b1
                t10 += a1 * b0
                t11 += a1 * b1
            gram[a, b] += t00
            gram[a, b + 1] += t01
            gram[a + 1, b] += t10
            gram[a + 1, b + 1] += t11
