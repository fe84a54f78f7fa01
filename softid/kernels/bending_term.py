"""The bending actuator's law as a term that the integrator of effects calls by address."""

from __future__ import annotations

from functools import cache
from typing import Any

import numba
import numpy as np
import numpy.typing as npt

from softid.kernels.bending import torque_parts
from softid.kernels.bending_body import CELLS, ORDER, Body
from softid.kernels.terms import (
    LAW_DAMPING,
    LAW_DRIVE,
    LAW_ELASTIC,
    LAW_INERTIA,
    LAW_INERTIAL,
    compile_term,
)

Array = npt.NDArray[np.float64]

N_THETA = 8
"""Parameters of the model: those of the law, then the sensor's drift, which no torque knows."""

REST_TORQUE = 6

N_CONSTANTS = 5
"""Length of `Body.constants`."""


def pack(theta: Array, body: Body) -> Array:
    """Parameters and body in one array, as `law_address` reads them.

    Parameters
    ----------
    theta
        Parameters of the model, shape (8,).
    body
        Geometry and material.
    """
    sizes = np.array([body.inertia.size, body.stretch.size], np.float64)
    lists = (body.inertia, body.velocity, body.stretch, body.lever, body.constants)
    return np.concatenate((theta, sizes, *lists, body.table.ravel()))


def _law(x: float, v: float, z: float, u: float, t: float, parameters: Any, result: Any) -> None:
    """Inertia, inertial torque, damping, s·K(θ) and d·F(p) − τ0."""
    n_inertia, n_wall = int(parameters[N_THETA]), int(parameters[N_THETA + 1])
    first = N_THETA + 2
    wall = first + 2 * n_inertia
    after = wall + 2 * n_wall
    table = after + N_CONSTANTS
    size = table + 3 * CELLS * ORDER
    whole = numba.carray(parameters, (size,))  # type: ignore[attr-defined]
    body = Body(
        whole[first : first + n_inertia],
        whole[first + n_inertia : wall],
        whole[wall : wall + n_wall],
        whole[wall + n_wall : after],
        whole[after:table],
        whole[table:].reshape(CELLS, 3, ORDER),
    )
    inertia, inertial, damping, elastic, driving = torque_parts(x, v, u, whole[:N_THETA], body)
    rest_torque = parameters[REST_TORQUE]
    result[LAW_INERTIA] += inertia
    result[LAW_INERTIAL] += inertial
    result[LAW_DAMPING] += damping
    result[LAW_ELASTIC] += elastic - rest_torque
    result[LAW_DRIVE] += driving - rest_torque


@cache
def law_address() -> int:
    """Address of the compiled law; a stiffening spring leaves the constant torque τ0 alone."""
    address: int = _compiled().address
    return address


@cache
def _compiled() -> Any:
    return compile_term(_law)
