"""Position and velocity over a block of steps, and the propagators of its stretches.

See `softid.kernels.affine_blocks` for the law, the block and its workspace ``w``.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.affine_blocks import (
    E1,
    E2,
    LANES,
    POINTS,
    PVV,
    PVX,
    PXV,
    PXX,
    ROW_V,
    ROW_X,
    ROWS,
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
from softid.kernels.affine_steps import line, radau_map, radau_velocities, rk4_end, rk4_map, times
from softid.kernels.exponential import NO_REORDERING

Array = npt.NDArray[np.float64]


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
            e = rk4_places(w, E1, i)
            n, q = line(a2, rk4_places(w, E2, i), c2), line(a1, e, c1)
            xx, xv, vx, vv = rk4_map(h, n, q)
            x, v = rk4_end(h, n, q, times(e, over), w[X + i], w[V + i])
            w[X + k], w[V + k] = x, v
            w[XX + i], w[XV + i], w[VX + i], w[VV + i] = xx, xv, vx, vv
            pxx, pxv, pvx, pvv = w[PXX + i], w[PXV + i], w[PVX + i], w[PVV + i]
            w[PXX + k] = xx * pxx + xv * pvx
            w[PXV + k] = xx * pxv + xv * pvv
            w[PVX + k] = vx * pxx + vv * pvx
            w[PVV + k] = vx * pxv + vv * pvv


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def run_radau(w: Array, theta: Array) -> None:
    """Every stretch from zero, with its propagator, by the Radau rule."""
    m, a1, c1, a2, c2 = theta[0], theta[1], theta[3], theta[4], theta[6]
    for j in range(ROWS):
        for lane in range(LANES):
            i = j * LANES + lane
            k = i + LANES
            h = w[STEP + i]
            e = radau_places(w, E1, i)
            n, q = line(a2, radau_places(w, E2, i), c2), line(a1, e, c1)
            g = radau_velocities(h, m, n, q)
            (xx, xv, vx, vv), (x0, x1, x2) = radau_map(h, m, q, g)
            (e0, e1, e2), (v0, v1, v2) = e, g.third
            x, v = w[X + i], w[V + i]
            w[X + k] = xx * x + xv * v + x0 * e0 + x1 * e1 + x2 * e2
            w[V + k] = vx * x + vv * v + v0 * e0 + v1 * e1 + v2 * e2
            w[XX + i], w[XV + i], w[VX + i], w[VV + i] = xx, xv, vx, vv
            pxx, pxv, pvx, pvv = w[PXX + i], w[PXV + i], w[PVX + i], w[PVV + i]
            w[PXX + k] = xx * pxx + xv * pvx
            w[PXV + k] = xx * pxv + xv * pvv
            w[PVX + k] = vx * pxx + vv * pvx
            w[PVV + k] = vx * pxv + vv * pvv


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def reset(w: Array) -> None:
    """Zero state and unit propagator at the start of every stretch."""
    for lane in range(LANES):
        w[X + lane], w[V + lane] = 0.0, 0.0
        w[PXX + lane], w[PXV + lane], w[PVX + lane], w[PVV + lane] = 1.0, 0.0, 0.0, 1.0


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def join_states(w: Array, state: Array) -> None:
    """Move every stretch to its true start; ``state`` goes on to the end of the block."""
    x, v = state[0], state[1]
    for lane in range(LANES):
        w[ROW_X + lane], w[ROW_V + lane] = x, v
        k = STEPS + lane
        x, v = (
            w[X + k] + w[PXX + k] * x + w[PXV + k] * v,
            w[V + k] + w[PVX + k] * x + w[PVV + k] * v,
        )
    state[0], state[1] = x, v
    for i in range(STEPS):  # the start of a stretch, written beside every row
        w[ROW_X + LANES + i], w[ROW_V + LANES + i] = w[ROW_X + i], w[ROW_V + i]
    for i in range(POINTS):
        w[X + i] += w[PXX + i] * w[ROW_X + i] + w[PXV + i] * w[ROW_V + i]
        w[V + i] += w[PVX + i] * w[ROW_X + i] + w[PVV + i] * w[ROW_V + i]
