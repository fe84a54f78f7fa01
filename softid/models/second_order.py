"""Simulation of any law M·ẍ + N(u)·ẋ + Q(u)·x = F(u) on a log's own times."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.kernels.affine_blocks import (
    N_PARAMETERS,
    N_STATES,
    RADAU,
    RK4,
)
from softid.kernels.affine_simulation import move, move_with_derivatives
from softid.kernels.affine_start import begin
from softid.kernels.radau import propagate, propagate_with_sensitivities
from softid.kernels.small_matrix import LANES, groups
from softid.models.division import Division, divide

Array = npt.NDArray[np.float64]

Order = Literal["second", "first", "static"]
ORDERS: tuple[Order, ...] = ("static", "first", "second")
_BLOCK = 4096
"""Steps whose derivatives are kept at a time: those of a whole log would take many times its
memory."""


@dataclass(frozen=True, eq=False)
class AffineForm:
    """A law as the kernels for laws affine in their state know it (`softid.kernels.affine_blocks`).

    Attributes
    ----------
    kind
        MUSCLE or OSCILLATOR.
    theta
        The kernels' seven parameters and gain, shape (8,).
    by_theta
        ∂(the seven)/∂θ, shape (7, K).
    """

    kind: int
    theta: Array
    by_theta: Array


class Law(ABC):
    """The coefficients of one second-order law at given parameter values."""

    mass: float
    mass_by: Array

    @abstractmethod
    def coefficients(self, u: Array) -> tuple[Array, Array, Array]:
        """N, Q and F at inputs of shape (L,), each of shape (L,)."""

    @abstractmethod
    def derivatives(self, u: Array) -> tuple[Array, Array, Array]:
        """∂N/∂θ, ∂Q/∂θ and ∂F/∂θ at inputs of shape (L,), each of shape (L, K)."""

    def packed(self, u: Array, *, derivatives: bool) -> tuple[Array, Array]:
        """M, N, Q and F at inputs of shape (L, 3), and their derivatives if they are wanted.

        Of shapes (L, 3, 4) and (L, 3, 4, G, LANES), the K derivatives in groups filled up with
        zeros; the second of length 0 otherwise.
        """
        flat = u.ravel()
        packed = np.empty((*u.shape, 4))
        packed[..., 0] = self.mass
        for k, values in enumerate(self.coefficients(flat)):
            packed[..., 1 + k] = values.reshape(u.shape)
        count = self.mass_by.size
        by = np.zeros((len(u) if derivatives else 0, 3, 4, groups(count), LANES))
        if derivatives:
            flat_by = by.reshape(*by.shape[:3], -1)
            flat_by[..., 0, :count] = self.mass_by
            for k, columns in enumerate(self.derivatives(flat)):
                flat_by[..., 1 + k, :count] = columns.reshape(*u.shape, -1)
        return packed, by

    @abstractmethod
    def exponent_rate(self) -> float:
        """Largest |d log coefficient/du|: how fast the coefficients bend with the input."""

    def affine(self) -> AffineForm | None:
        """The form that the fastest kernels take; None for a law that they do not know."""
        return None

    def equilibrium(self, u: float) -> float:
        """Position x = F/Q at constant input; NaN without a spring."""
        _, stiffness, force = self.coefficients(np.array([u]))
        return float(force[0] / stiffness[0]) if stiffness[0] != 0.0 else np.nan

    def equilibrium_by(self, u: float) -> Array:
        """∂(F/Q)/∂θ at constant input, shape (K,)."""
        at = np.array([u])
        _, stiffness, _ = self.coefficients(at)
        _, stiffness_by, force_by = self.derivatives(at)
        by: Array = (force_by[0] - stiffness_by[0] * self.equilibrium(u)) / stiffness[0]
        return by


@dataclass(frozen=True, eq=False)
class Motion:
    """Simulated states at the samples.

    Attributes
    ----------
    x, v
        Position and velocity, each of shape (n,).
    by_parameter
        ∂x/∂θ, shape (n, K), or None.
    by_state
        ∂x/∂(x₀, v₀), shape (n, 2), or None.
    """

    x: Array
    v: Array
    by_parameter: Array | None
    by_state: Array | None


def simulate_law(
    law: Law,
    time_s: Array,
    u: Array,
    start: Array | None,
    *,
    derivatives: bool,
    relative: bool = False,
    plan: Division | None = None,
) -> Motion:
    """Integrate a law over a segment.

    Parameters
    ----------
    law
        The coefficients.
    time_s, u
        Sample times and input, each of shape (n,).
    start
        (x₀, v₀), or None for the equilibrium at ``u[0]``.
    relative
        Whether ``start`` is a deviation from that equilibrium.
    derivatives
        Whether to return exact derivatives too.
    plan
        Division of the sampling intervals; None makes one for these parameters. An optimiser must
        hold it still, or the cost jumps where a count changes.
    """
    if plan is None:
        plan = divide(law, time_s, u)
    form = law.affine()
    if form is not None:
        run = affine_run(form, plan, start, relative=relative)
        return _simulate_affine(form, run, derivatives=derivatives)
    state = _initial_state(law, float(u[0]), start, relative=relative)
    from_rest = start is None or relative
    return _simulate_any(law, plan, state, from_rest=from_rest, derivatives=derivatives)


def _initial_state(law: Law, u: float, start: Array | None, *, relative: bool) -> Array:
    """(x₀, v₀) that `simulate_law` starts from, shape (2,)."""
    if start is not None and not relative:
        return np.array(start, dtype=np.float64)
    moved = (0.0, 0.0) if start is None else start
    return np.array([law.equilibrium(u) + moved[0], moved[1]], dtype=np.float64)


@dataclass(frozen=True, eq=False)
class AffineRun:
    """All arguments of the kernels for laws affine in their state.

    Attributes
    ----------
    arguments
        Kind, rule, parameters, times, input, counts and initial state.
    tangent
        Derivative of the state at the first sample, shape (2, 9).
    """

    arguments: tuple[int, int, Array, Array, Array, npt.NDArray[np.int16], Array]
    tangent: Array


def affine_run(
    form: AffineForm, plan: Division, start: Array | None, *, relative: bool
) -> AffineRun:
    """Arguments for a run by a plan; form, start and relative as in `simulate_law`."""
    state, tangent = begun(form, float(plan.u[0]), start, relative=relative)
    rule = RK4 if plan.rule == "rk4" else RADAU
    return AffineRun(
        (form.kind, rule, form.theta, plan.time_s, plan.u, plan.counts, state), tangent
    )


def begun(
    form: AffineForm, u: float, start: Array | None, *, relative: bool
) -> tuple[Array, Array]:
    """(x, v) at the first sample, and its derivatives by inner parameters, x₀ and v₀.

    Of shapes (2,) and (2, 9).

    Parameters
    ----------
    form
        The law.
    u
        Input there.
    start, relative
        As in `simulate_law`.
    """
    state, tangent = np.empty(N_STATES), np.empty((N_STATES, N_PARAMETERS + N_STATES))
    moved = np.zeros(N_STATES) if start is None else start
    begin(form.kind, form.theta, u, moved, start is None or relative, state, tangent)
    return state, tangent


def _simulate_affine(form: AffineForm, run: AffineRun, *, derivatives: bool) -> Motion:
    n = run.arguments[3].size
    x, v = np.empty(n), np.empty(n)
    if not derivatives:
        move(*run.arguments, x, v)
        return Motion(x, v, None, None)
    by = np.empty((N_PARAMETERS + N_STATES, n))
    move_with_derivatives(*run.arguments, run.tangent, x, v, by)
    return Motion(x, v, by[:N_PARAMETERS].T @ form.by_theta, by[N_PARAMETERS:].T)


def _simulate_any(
    law: Law, plan: Division, state: Array, *, from_rest: bool, derivatives: bool
) -> Motion:
    steps_s, stage_u, ends = plan.step_s, plan.stage_input, plan.ends
    n, n_parameters = plan.time_s.size, law.mass_by.size
    x, v = np.empty(n), np.empty(n)
    x[0], v[0] = state
    tangent = np.zeros((2, n_parameters + 2))
    by = np.empty((n, n_parameters + 2)) if derivatives else None
    if by is not None:
        tangent[0, n_parameters] = tangent[1, n_parameters + 1] = 1.0
        if from_rest:
            tangent[0, :n_parameters] = law.equilibrium_by(float(plan.u[0]))
        by[0] = tangent[0]
    sample = 1
    for first in range(0, steps_s.size, _BLOCK):
        block = slice(first, first + _BLOCK)
        states, tangents = _run_block(law, steps_s[block], stage_u[block], state, tangent, by)
        reached = np.flatnonzero(ends[block])
        stop = sample + reached.size
        x[sample:stop], v[sample:stop] = states[reached].T
        if by is not None and tangents is not None:
            by[sample:stop] = tangents[reached]
        sample = stop
    if by is None:
        return Motion(x, v, None, None)
    return Motion(x, v, by[:, :n_parameters], by[:, n_parameters:])


def _run_block(
    law: Law, steps_s: Array, stage_u: Array, state: Array, tangent: Array, by: Array | None
) -> tuple[Array, Array | None]:
    shape = stage_u.shape
    flat = stage_u.ravel()
    damping, stiffness, force = (c.reshape(shape) for c in law.coefficients(flat))
    states = np.empty((steps_s.size, 2))
    if by is None:
        propagate(steps_s, law.mass, damping, stiffness, force, state, states)
        return states, None
    damping_by, stiffness_by, force_by = (d.reshape(*shape, -1) for d in law.derivatives(flat))
    tangents = np.empty((steps_s.size, by.shape[1]))
    propagate_with_sensitivities(
        steps_s,
        law.mass,
        damping,
        stiffness,
        force,
        law.mass_by,
        damping_by,
        stiffness_by,
        force_by,
        state,
        tangent,
        states,
        tangents,
    )
    return states, tangents
