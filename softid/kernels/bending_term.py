"""The bending actuator's law as a term that the integrator of effects calls by address."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numba
import numpy as np
import numpy.typing as npt

from softid.kernels.bending import torque_parts
from softid.kernels.bending_body import CELLS, ORDER, Body, parts_at
from softid.kernels.decorators import inlined
from softid.kernels.terms import (
    FACTOR_DAMPING,
    FACTOR_ELASTIC,
    FACTOR_INERTIA,
    FACTOR_INERTIAL,
    LAW_DAMPING,
    LAW_DRIVE,
    LAW_ELASTIC,
    LAW_INERTIA,
    LAW_INERTIAL,
    N_FACTORS,
    compile_term,
)

Array = npt.NDArray[np.float64]

N_THETA = 8
"""Parameters of the model: those of the law, then the sensor's drift, which no torque knows."""

REST_TORQUE = 6
"""Place of τ0 among the parameters."""

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


@inlined
def _unpacked(parameters: Any) -> tuple[Array, Body]:
    """θ and the body from where `pack` has put them."""
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
    return whole[:N_THETA], body


def _law(x: float, v: float, z: float, u: float, t: float, parameters: Any, result: Any) -> None:
    """Inertia, inertial torque, damping, s·K(θ) and d·F(p) − τ0."""
    theta, body = _unpacked(parameters)
    inertia, inertial, damping, elastic, driving = torque_parts(x, v, u, theta, body)
    rest_torque = theta[REST_TORQUE]
    result[LAW_INERTIA] += inertia
    result[LAW_INERTIAL] += inertial
    result[LAW_DAMPING] += damping
    result[LAW_ELASTIC] += elastic - rest_torque
    result[LAW_DRIVE] += driving - rest_torque


def _slopes(
    x: float, v: float, eased: float, u: float, a: float, parameters: Any, result: Any
) -> None:
    """Derivatives of the unbalanced torque by C_d, a, b, c, s, d and τ0."""
    _, body = _unpacked(parameters)
    m, d, k = parts_at(x, body)
    if eased != x:
        _, _, k = parts_at(eased, body)
    by_c = m * result[FACTOR_INERTIA] + d * v * v * result[FACTOR_INERTIAL]
    result[N_FACTORS] += v * result[FACTOR_DAMPING]
    result[N_FACTORS + 1] += by_c * x * x
    result[N_FACTORS + 2] += by_c * abs(x)
    result[N_FACTORS + 3] += by_c
    result[N_FACTORS + 4] += k * result[FACTOR_ELASTIC]
    result[N_FACTORS + 5] -= body.constants[3] * u
    result[N_FACTORS + 6] += 1.0


@cache
def law_address() -> int:
    """Address of the compiled law; a stiffening spring leaves the constant torque τ0 alone."""
    address: int = _compiled(_law).address
    return address


@cache
def slopes_address() -> int:
    """Address of what differentiates it by its parameters."""
    address: int = _compiled(_slopes).address
    return address


@cache
def _compiled(function: Callable[..., None]) -> Any:
    return compile_term(function)
