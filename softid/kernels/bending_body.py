"""What geometry and material make of a bending actuator: inertia and elastic torque by its angle.

M is even and D odd in θ; both are power series in θ² whose coefficients are moments of the line
density, so nothing cancels near θ = 0. The elastic torque is a sum over points of the wall. Each of
these takes a dozen or two terms, and an integration asks for them several times a step; so they are
tabulated once, as polynomials over short cells of |θ|, whose error is that of rounding.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inner, kernel

Array = npt.NDArray[np.float64]

LARGEST_ANGLE_RAD = 2.0 * np.pi
"""A full circle: the series hold up to here, and beyond it the actuator would meet itself."""

MOST_STRETCH = 0.9
"""The wall's stretch, as a share of its length, up to which there is a table; at 1 a wall has
vanished, and nothing is smooth."""

CELLS = 512
"""Cells of the table: at `MOST_STRETCH` one is 1/57 of the way that is left to 1, and the error of
its polynomial below 1e-10; elsewhere it is that of rounding."""

ORDER = 6
"""Coefficients of a polynomial."""


class Body(NamedTuple):
    """What geometry and material contribute, as plain arrays.

    Attributes
    ----------
    inertia
        m_k of M(θ) = Σ m_k·θ^(2k) in kg·m², shape (T,).
    velocity
        d_k of D(θ) = θ·Σ d_k·θ^(2k) in kg·m², shape (T,).
    stretch
        Wall point → dλ/dθ in 1/rad, so that λ = 1 ± stretch·θ, shape (W,).
    lever
        Wall point → ∫ y dA in m³, shape (W,).
    constants
        2·C10 and 4·C20 in Pa, the neutral layer's torque per angle in N·m/rad, F/p in N·m/kPa, and
        how many cells of the table there are in a radian; shape (5,).
    table
        M, D and K over |θ| cell by cell, from `tabulated`, shape (cells, 3, 6).
    """

    inertia: Array
    velocity: Array
    stretch: Array
    lever: Array
    constants: Array
    table: Array


@inner
def inertia_parts(angle: float, body: Body) -> tuple[float, float, float, float]:
    """M, dM/dθ, D and dD/dθ at an angle, in kg·m² and kg·m²/rad."""
    q = angle * angle
    m = dm = d = dd = 0.0
    for k in range(body.inertia.size - 1, -1, -1):
        dm = dm * q + m
        m = m * q + body.inertia[k]
        dd = dd * q + d
        d = d * q + body.velocity[k]
    return m, 2.0 * angle * dm, angle * d, d + 2.0 * q * dd


@inner
def elastic_torque(angle: float, body: Body) -> float:
    """K(θ) in N·m: plane-strain Yeoh walls on both sides, and the neutral layer; odd in θ."""
    c1, c2 = body.constants[0], body.constants[1]
    total = 0.0
    for k in range(body.stretch.size):
        z = body.stretch[k] * angle
        up, down = 1.0 + z, 1.0 - z
        over = 1.0 / (up * down)
        by_up, by_down = down * over, up * over
        one, two = up - by_up, down - by_down
        total += body.lever[k] * (
            (up - by_up * by_up * by_up) * (c1 + c2 * one * one)
            - (down - by_down * by_down * by_down) * (c1 + c2 * two * two)
        )
    torque: float = total + body.constants[2] * angle
    return torque


@inner
def elastic_parts(angle: float, body: Body) -> tuple[float, float]:
    """K(θ) in N·m and dK/dθ in N·m/rad."""
    c1, c2 = body.constants[0], body.constants[1]
    total = slope = 0.0
    for k in range(body.stretch.size):
        z = body.stretch[k] * angle
        up, down = 1.0 + z, 1.0 - z
        over = 1.0 / (up * down)
        by_up, by_down = down * over, up * over
        up3, down3 = by_up * by_up * by_up, by_down * by_down * by_down
        one, two = up - by_up, down - by_down
        stress_up, stress_down = c1 + c2 * one * one, c1 + c2 * two * two
        total += body.lever[k] * ((up - up3) * stress_up - (down - down3) * stress_down)
        slope += (
            body.lever[k]
            * body.stretch[k]
            * (
                (1.0 + 3.0 * up3 * by_up) * stress_up
                + (up - up3) * 2.0 * c2 * one * (1.0 + by_up * by_up)
                + (1.0 + 3.0 * down3 * by_down) * stress_down
                + (down - down3) * 2.0 * c2 * two * (1.0 + by_down * by_down)
            )
        )
    return total + body.constants[2] * angle, slope + body.constants[2]


@inner
def parts_at(angle: float, body: Body) -> tuple[float, float, float]:
    """M in kg·m², D in kg·m² and K in N·m at an angle of at most a full circle."""
    size, sign = abs(angle), -1.0 if angle < 0.0 else 1.0
    place = size * body.constants[4]
    cell = int(place)
    if cell >= body.table.shape[0]:
        m, _, d, _ = inertia_parts(angle, body)
        return m, d, elastic_torque(angle, body)
    s, table = place - cell, body.table
    m = d = k = 0.0
    for power in range(ORDER - 1, -1, -1):
        m = m * s + table[cell, 0, power]
        d = d * s + table[cell, 1, power]
        k = k * s + table[cell, 2, power]
    return m, sign * d, sign * k


@inner
def parts_with_slopes_at(
    angle: float, body: Body
) -> tuple[float, float, float, float, float, float]:
    """M, dM/dθ, D, dD/dθ, K and dK/dθ at an angle of at most a full circle."""
    size, sign = abs(angle), -1.0 if angle < 0.0 else 1.0
    place = size * body.constants[4]
    cell = int(place)
    if cell >= body.table.shape[0]:
        m, m_by, d, d_by = inertia_parts(angle, body)
        k, k_by = elastic_parts(angle, body)
        return m, m_by, d, d_by, k, k_by
    s, table = place - cell, body.table
    m = m_by = d = d_by = k = k_by = 0.0
    for power in range(ORDER - 1, -1, -1):
        m_by = m_by * s + m
        m = m * s + table[cell, 0, power]
        d_by = d_by * s + d
        d = d * s + table[cell, 1, power]
        k_by = k_by * s + k
        k = k * s + table[cell, 2, power]
    per_rad = body.constants[4]
    return m, sign * per_rad * m_by, sign * d, per_rad * d_by, sign * k, per_rad * k_by


@kernel
def _sampled(angles: Array, body: Body, values: Array) -> None:
    """M, D and K at angles of shape (n,), by their series; ``values`` has shape (n, 3)."""
    for i in range(angles.size):
        values[i, 0], _, values[i, 1], _ = inertia_parts(angles[i], body)
        values[i, 2] = elastic_torque(angles[i], body)


def tabulated(
    inertia: Array, velocity: Array, stretch: Array, lever: Array, constants: Array
) -> Body:
    """The body with its table: in every cell the polynomials through six Chebyshev points.

    Parameters
    ----------
    inertia, velocity, stretch, lever
        As in `Body`.
    constants
        The first four of `Body`.
    """
    widest = min(LARGEST_ANGLE_RAD, MOST_STRETCH / float(stretch.max()))
    whole = np.append(constants, CELLS / widest)
    exact = Body(inertia, velocity, stretch, lever, whole, np.empty((0, 3, ORDER)))
    nodes = 0.5 - 0.5 * np.cos(np.pi * (np.arange(ORDER) + 0.5) / ORDER)
    angles = (np.arange(CELLS)[:, np.newaxis] + nodes) / whole[4]
    values = np.empty((angles.size, 3))
    _sampled(angles.ravel(), exact, values)
    powers = np.vander(nodes, increasing=True)
    by_cell = values.reshape(CELLS, ORDER, 3)
    table = np.ascontiguousarray(np.linalg.solve(powers, by_cell).transpose(0, 2, 1))
    table[0, 1:, 0] = 0.0  # D and K are odd
    return exact._replace(table=table)
