r"""Equation of motion of a bending actuator and its integration with exact sensitivities.

The law is C_m(θ)·[M(θ)·θ̈ + D(θ)·θ̇²] + C_d·θ̇ + s·K(θ) + τ0 − d·F(p) = 0 with the compensation
C_m = a·θ² + b·|θ| + c. M, D and K are those of `softid.kernels.bending_body`, F is proportional to
the pressure.

The parts of the law are one small function, `torque_parts`, which the integrator itself calls; a
further effect adds its own torque to those parts.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels import bending_body
from softid.kernels.bending_body import (
    LARGEST_ANGLE_RAD,
    Body,
    elastic_parts,
    elastic_torque,
    inertia_parts,
    parts_at,
    parts_with_slopes_at,
)
from softid.kernels.cache_invalidation import follow_sources
from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]

SMALLEST_COMPENSATION = 1e-3
"""C_m at or below this is no mass; the response is then NaN."""

MARCH_RAD = 0.05
"""Step towards the smallest rest angle. Six bisections leave less than 1e-3 of it, from where
Newton's method ends at rounding in four moves."""

N_DYNAMIC = 7
"""Parameters of the equation of motion, in order: C_d, a, b, c, stiffness s, drive d, τ0."""


@kernel
def compensation(angle: float, theta: Array) -> float:
    """C_m = a·θ² + b·|θ| + c; NaN where it is no mass."""
    found = (theta[1] * abs(angle) + theta[2]) * abs(angle) + theta[3]
    return found if found > SMALLEST_COMPENSATION else np.nan


@kernel
def torque_parts(
    angle: float, velocity: float, pressure_kpa: float, theta: Array, body: Body
) -> tuple[float, float, float, float, float]:
    """The parts of the equation of motion: m·θ̈ + inertial + damping + elastic − driving = 0.

    Parameters
    ----------
    angle, velocity
        θ in rad and θ̇ in rad/s.
    pressure_kpa
        Pressure; negative drives the other chamber bank.
    theta
        C_d, a, b, c, s, d, τ0, shape (7,) or longer.
    body
        Geometry and material.

    Returns
    -------
    tuple
        m = C_m·M in kg·m²; inertial = C_m·D·θ̇², damping = C_d·θ̇, elastic = s·K + τ0 and
        driving = d·F in N·m. NaN beyond a full circle or where C_m is no mass.
    """
    if not abs(angle) <= LARGEST_ANGLE_RAD:
        return np.nan, np.nan, np.nan, np.nan, np.nan
    m, d, k = parts_at(angle, body)
    c_m = compensation(angle, theta)
    return (
        c_m * m,
        c_m * d * velocity * velocity,
        theta[0] * velocity,
        theta[4] * k + theta[6],
        theta[5] * body.constants[3] * pressure_kpa,
    )


@kernel
def acceleration(
    angle: float, velocity: float, pressure_kpa: float, theta: Array, body: Body
) -> float:
    """θ̈ in rad/s² from `torque_parts`."""
    m, inertial, damping, elastic, driving = torque_parts(
        angle, velocity, pressure_kpa, theta, body
    )
    return (driving - elastic - damping - inertial) / m


@kernel
def acceleration_slopes(
    angle: float, velocity: float, pressure_kpa: float, theta: Array, body: Body, slopes: Array
) -> float:
    """θ̈ and its derivatives.

    Parameters
    ----------
    angle, velocity, pressure_kpa, theta, body
        As in `torque_parts`.
    slopes
        Receives ∂θ̈ by C_d, a, b, c, s, d, τ0, then by θ and θ̇, shape (9,).
    """
    if not abs(angle) <= LARGEST_ANGLE_RAD:
        slopes[:] = np.nan
        return np.nan
    m, m_by, d, d_by, k, k_by = parts_with_slopes_at(angle, body)
    size = abs(angle)
    c_m = compensation(angle, theta)
    bent = 2.0 * theta[1] * angle + theta[2] * (
        1.0 if angle > 0.0 else -1.0 if angle < 0.0 else 0.0
    )
    drive = body.constants[3] * pressure_kpa
    over = 1.0 / (c_m * m)
    static = (theta[5] * drive - theta[4] * k - theta[6] - theta[0] * velocity) * over
    ratio = d / m
    by_c = -static / c_m
    slopes[0] = -velocity * over
    slopes[1] = by_c * size * size
    slopes[2] = by_c * size
    slopes[3] = by_c
    slopes[4] = -k * over
    slopes[5] = drive * over
    slopes[6] = -over
    slopes[7] = (
        -theta[4] * k_by * over
        - static * (bent / c_m + m_by / m)
        - (d_by - ratio * m_by) / m * velocity * velocity
    )
    slopes[8] = -theta[0] * over - 2.0 * ratio * velocity
    found: float = static - ratio * velocity * velocity
    return found


@kernel
def propagate_bending(
    step_s: Array, pressure_kpa: Array, theta: Array, body: Body, state: Array, states: Array
) -> None:
    """Integrate over all steps by the classical fourth-order Runge–Kutta rule.

    Parameters
    ----------
    step_s
        Step lengths, shape (L,).
    pressure_kpa
        Pressure at the start, middle and end of every step, shape (L, 3).
    theta, body
        As in `torque_parts`.
    state
        (θ, θ̇) at the start, shape (2,); overwritten by the state at the end.
    states
        Receives (θ, θ̇) after each step, shape (L, 2).
    """
    x, v = state[0], state[1]
    for i in range(step_s.size):
        h = step_s[i]
        half = 0.5 * h
        a1 = acceleration(x, v, pressure_kpa[i, 0], theta, body)
        v2 = v + half * a1
        a2 = acceleration(x + half * v, v2, pressure_kpa[i, 1], theta, body)
        v3 = v + half * a2
        a3 = acceleration(x + half * v2, v3, pressure_kpa[i, 1], theta, body)
        v4 = v + h * a3
        a4 = acceleration(x + h * v3, v4, pressure_kpa[i, 2], theta, body)
        x += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
        v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        states[i, 0] = x
        states[i, 1] = v
    state[0] = x
    state[1] = v


@kernel
def propagate_bending_with_sensitivities(
    step_s: Array,
    pressure_kpa: Array,
    theta: Array,
    body: Body,
    state: Array,
    tangent: Array,
    states: Array,
    tangents: Array,
) -> None:
    """Integrate as `propagate_bending` and differentiate every step exactly.

    Parameters
    ----------
    step_s, pressure_kpa, theta, body, state, states
        As in `propagate_bending`.
    tangent
        ∂(θ, θ̇)/∂(seven parameters, θ₀, θ̇₀) at the start, shape (2, 9); overwritten at the end.
    tangents
        Receives ∂θ/∂(seven parameters, θ₀, θ̇₀) after each step, shape (L, 9).
    """
    n = N_DYNAMIC + 2
    f = np.empty(n)
    by_x, by_v = np.empty((4, n)), np.empty((4, n))
    x, v = state[0], state[1]
    for i in range(step_s.size):
        h = step_s[i]
        stage_x, stage_v, last_a = x, v, 0.0
        move_x = move_v = 0.0
        for stage in range(4):
            reach = 0.0 if stage == 0 else h if stage == 3 else 0.5 * h
            if stage > 0:
                stage_x, stage_v = x + reach * stage_v, v + reach * last_a
            u = pressure_kpa[i, (stage + 1) // 2]
            last_a = acceleration_slopes(stage_x, stage_v, u, theta, body, f)
            weight = h / 6.0 if stage in (0, 3) else h / 3.0
            move_x += weight * stage_v
            move_v += weight * last_a
            for k in range(n):
                tx, tv = tangent[0, k], tangent[1, k]
                if stage > 0:
                    tx += reach * by_x[stage - 1, k]
                    tv += reach * by_v[stage - 1, k]
                by_x[stage, k] = tv
                by_v[stage, k] = f[7] * tx + f[8] * tv + (f[k] if k < N_DYNAMIC else 0.0)
        for k in range(n):
            inner = 2.0 * (by_x[1, k] + by_x[2, k])
            tangent[0, k] += h / 6.0 * (by_x[0, k] + inner + by_x[3, k])
            inner = 2.0 * (by_v[1, k] + by_v[2, k])
            tangent[1, k] += h / 6.0 * (by_v[0, k] + inner + by_v[3, k])
            tangents[i, k] = tangent[0, k]
        x += move_x
        v += move_v
        states[i, 0] = x
        states[i, 1] = v
    state[0] = x
    state[1] = v


@kernel
def rest_angle(pressure_kpa: float, theta: Array, body: Body) -> float:
    """Smallest angle in rad at which s·K + τ0 = d·F(p); NaN when there is none.

    Marches from zero in steps of 0.05 rad until the elastic torque exceeds the load, then bisects.
    """
    load = theta[5] * body.constants[3] * pressure_kpa - theta[6]
    sign = 1.0 if load >= 0.0 else -1.0
    load = abs(load)
    low, high = 0.0, MARCH_RAD
    while theta[4] * elastic_torque(high, body) < load:
        low, high = high, high + MARCH_RAD
        if high > LARGEST_ANGLE_RAD or high * np.max(body.stretch) >= 1.0:
            return np.nan
    for _ in range(6):
        middle = 0.5 * (low + high)
        if theta[4] * elastic_torque(middle, body) < load:
            low = middle
        else:
            high = middle
    angle = 0.5 * (low + high)
    for _ in range(4):
        torque, slope = elastic_parts(angle, body)
        angle -= (theta[4] * torque - load) / (theta[4] * slope)
    return sign * angle


@kernel
def rest_slopes(angle: float, pressure_kpa: float, theta: Array, body: Body, slopes: Array) -> None:
    """∂(rest angle)/∂(seven parameters) at a rest angle; ``slopes`` has shape (7,)."""
    torque, slope = elastic_parts(angle, body)
    stiffness = theta[4] * slope
    slopes[:4] = 0.0
    slopes[4] = -torque / stiffness
    slopes[5] = body.constants[3] * pressure_kpa / stiffness
    slopes[6] = -1.0 / stiffness


@kernel
def fastest_rates(angles: Array, theta: Array, body: Body) -> tuple[float, float]:
    """Largest natural frequency √(s·K′/C_m·M) and damping rate C_d/(C_m·M) over angles, in 1/s.

    Angles at which C_m is no mass do not count: the motion may never reach them.
    """
    swing = fading = 0.0
    for angle in angles:
        c_m = compensation(angle, theta)
        if np.isnan(c_m):
            continue
        m, _, _, _ = inertia_parts(angle, body)
        _, slope = elastic_parts(angle, body)
        swing = max(swing, theta[4] * slope / (c_m * m))
        fading = max(fading, theta[0] / (c_m * m))
    return np.sqrt(swing), fading


for _kernel in (
    torque_parts,
    acceleration,
    acceleration_slopes,
    propagate_bending,
    propagate_bending_with_sensitivities,
    rest_angle,
    rest_slopes,
    fastest_rates,
):
    follow_sources(_kernel, (bending_body,))
