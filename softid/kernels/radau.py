r"""One-pass integration of m·v′ + n(t)·v + q(t)·x = f(t), x′ = v, with exact sensitivities.

The rule is the three-stage Radau IIA collocation (order 5, L-stable; Hairer and Wanner, *Solving
Ordinary Differential Equations II*, §IV.5), solved for the stage velocities. Written that way
nothing is divided by m or n, so the same step covers the second-order law, its first-order limit
m = 0 and its static limit m = n = 0, and it stays stable for any stiffness. The law is affine in
its state: each step is y⁺ = Φ y + Γ, and differentiating that map gives the exact derivatives of
the computed solution, not an approximation of them.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import inlined, kernel

Array = npt.NDArray[np.float64]

_R6 = np.sqrt(6.0)
STAGES: Array = np.array([(4.0 - _R6) / 10.0, (4.0 + _R6) / 10.0, 1.0])
"""Positions of the stages within a step."""

A = np.array(
    [
        [(88.0 - 7.0 * _R6) / 360.0, (296.0 - 169.0 * _R6) / 1800.0, (-2.0 + 3.0 * _R6) / 225.0],
        [(296.0 + 169.0 * _R6) / 1800.0, (88.0 + 7.0 * _R6) / 360.0, (-2.0 - 3.0 * _R6) / 225.0],
        [(16.0 - _R6) / 36.0, (16.0 + _R6) / 36.0, 1.0 / 9.0],
    ]
)
B = np.linalg.inv(A)
B1 = B.sum(axis=1)
"""Butcher matrix A of the rule, its inverse B, and the row sums of B."""


@kernel
def _invert3(w: Array, out: Array) -> None:
    c00 = w[1, 1] * w[2, 2] - w[1, 2] * w[2, 1]
    c01 = w[1, 2] * w[2, 0] - w[1, 0] * w[2, 2]
    c02 = w[1, 0] * w[2, 1] - w[1, 1] * w[2, 0]
    scale = 1.0 / (w[0, 0] * c00 + w[0, 1] * c01 + w[0, 2] * c02)
    out[0, 0] = c00 * scale
    out[1, 0] = c01 * scale
    out[2, 0] = c02 * scale
    out[0, 1] = (w[0, 2] * w[2, 1] - w[0, 1] * w[2, 2]) * scale
    out[1, 1] = (w[0, 0] * w[2, 2] - w[0, 2] * w[2, 0]) * scale
    out[2, 1] = (w[0, 1] * w[2, 0] - w[0, 0] * w[2, 1]) * scale
    out[0, 2] = (w[0, 1] * w[1, 2] - w[0, 2] * w[1, 1]) * scale
    out[1, 2] = (w[0, 2] * w[1, 0] - w[0, 0] * w[1, 2]) * scale
    out[2, 2] = (w[0, 0] * w[1, 1] - w[0, 1] * w[1, 0]) * scale


@inlined
def _solve_stages(
    i: int,
    h: float,
    mh: float,
    damping: Array,
    stiffness: Array,
    force: Array,
    x: float,
    v: float,
    w: Array,
    g: Array,
    velocity: Array,
) -> None:
    """Velocities at the stages of step ``i`` of length h from (x, v); mh is m/h.

    They are g (f − q x + m/h B1 v), with g the inverse of w = m/h B + h q A + n, which remains.
    """
    for r in range(3):
        for c in range(3):
            w[r, c] = mh * B[r, c] + h * stiffness[i, r] * A[r, c]
        w[r, r] += damping[i, r]
    _invert3(w, g)
    for r in range(3):
        velocity[r] = 0.0
        for c in range(3):
            velocity[r] += g[r, c] * (force[i, c] - stiffness[i, c] * x + mh * B1[c] * v)


@kernel
def propagate(
    step_s: Array,
    mass: float,
    damping: Array,
    stiffness: Array,
    force: Array,
    state: Array,
    states: Array,
) -> None:
    """Integrate over all steps without derivatives.

    Parameters
    ----------
    step_s
        Step lengths, shape (L,).
    mass
        m ≥ 0.
    damping, stiffness, force
        n, q and f at the stages of every step, each of shape (L, 3).
    state
        (x, v) at the start, shape (2,); overwritten by the state at the end.
    states
        Receives (x, v) after each step, shape (L, 2).
    """
    w = np.empty((3, 3))
    g = np.empty((3, 3))
    velocity = np.empty(3)
    x, v = state[0], state[1]
    for i in range(step_s.size):
        h = step_s[i]
        mh = mass / h
        _solve_stages(i, h, mh, damping, stiffness, force, x, v, w, g, velocity)
        x += h * (A[2, 0] * velocity[0] + A[2, 1] * velocity[1] + A[2, 2] * velocity[2])
        v = velocity[2]
        states[i, 0] = x
        states[i, 1] = v
    state[0] = x
    state[1] = v


@kernel
def propagate_with_sensitivities(
    step_s: Array,
    mass: float,
    damping: Array,
    stiffness: Array,
    force: Array,
    mass_by: Array,
    damping_by: Array,
    stiffness_by: Array,
    force_by: Array,
    state: Array,
    tangent: Array,
    states: Array,
    tangents: Array,
) -> None:
    """Integrate over all steps with derivatives by K parameters and the initial state.

    Parameters
    ----------
    step_s, mass, damping, stiffness, force, state, states
        As in `propagate`.
    mass_by
        ∂m/∂θ, shape (K,).
    damping_by, stiffness_by, force_by
        ∂n/∂θ, ∂q/∂θ, ∂f/∂θ at the stages, each of shape (L, 3, K).
    tangent
        ∂(x, v)/∂(θ, x₀, v₀) at the start, shape (2, K + 2); overwritten by that at the end.
    tangents
        Receives ∂x/∂(θ, x₀, v₀) after each step, shape (L, K + 2).
    """
    n_parameters = mass_by.size
    w = np.empty((3, 3))
    g = np.empty((3, 3))
    velocity = np.empty(3)
    position = np.empty(3)
    inertia = np.empty(3)
    to_x = np.empty(3)
    x, v = state[0], state[1]
    for i in range(step_s.size):
        h = step_s[i]
        mh = mass / h
        _solve_stages(i, h, mh, damping, stiffness, force, x, v, w, g, velocity)
        for r in range(3):
            position[r] = x
            inertia[r] = -B1[r] * v
            for c in range(3):
                position[r] += h * A[r, c] * velocity[c]
                inertia[r] += B[r, c] * velocity[c]
            inertia[r] /= h
        # Φ: how the end of the step answers to its start.
        phi_xx, phi_xv, phi_vx, phi_vv = 1.0, 0.0, 0.0, 0.0
        for c in range(3):
            to_x[c] = h * (A[2, 0] * g[0, c] + A[2, 1] * g[1, c] + A[2, 2] * g[2, c])
            phi_xx -= to_x[c] * stiffness[i, c]
            phi_xv += to_x[c] * mh * B1[c]
            phi_vx -= g[2, c] * stiffness[i, c]
            phi_vv += g[2, c] * mh * B1[c]
        for k in range(n_parameters + 2):
            sx, sv = tangent[0, k], tangent[1, k]
            new_x = phi_xx * sx + phi_xv * sv
            new_v = phi_vx * sx + phi_vv * sv
            if k < n_parameters:
                for c in range(3):
                    forcing = (
                        force_by[i, c, k]
                        - damping_by[i, c, k] * velocity[c]
                        - stiffness_by[i, c, k] * position[c]
                        - mass_by[k] * inertia[c]
                    )
                    new_x += to_x[c] * forcing
                    new_v += g[2, c] * forcing
            tangent[0, k] = new_x
            tangent[1, k] = new_v
            tangents[i, k] = new_x
        x = position[2]
        v = velocity[2]
        states[i, 0] = x
        states[i, 1] = v
    state[0] = x
    state[1] = v
