"""Simulation of any law M·ẍ + N(u)·ẋ + Q(u)·x = F(u) on a log's own times.

Between samples the input is taken as straight. A sampling interval is divided where the input
changes so much that the coefficients bend within it, or where the motion is fast for the interval.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.kernels.radau import STAGES, propagate, propagate_with_sensitivities

Array = npt.NDArray[np.float64]

MAX_PHASE_PER_STEP = 0.8
"""Largest product of step and rate of motion; Radau IIA then errs by less than 1e-5 a step."""

MAX_EXPONENT_PER_STEP = 0.8
"""Largest change of an exponent of the coefficients within one step."""

STIFF_RATIO = 2000.0
STIFF_EXPONENT = 0.28
"""An overdamped fast mode is resolved with a step of 0.8·(fast/slow)^0.28 of its time constant up
to fast/slow = 2000: from the error of the rule's R(z) against exp(z), the fast mode's share of the
error then stays below 1e-4 of the motion."""

MAX_SUBSTEPS = 64
UNSEEN_PERIODS = 0.1
"""A mode that dies out within a tenth of the sampling interval cannot be seen in the samples."""

Order = Literal["second", "first", "static"]
ORDERS: tuple[Order, ...] = ("static", "first", "second")
_BLOCK = 4096


@dataclass(frozen=True, eq=False)
class Division:
    """Sampling intervals divided into steps.

    Attributes
    ----------
    counts
        Steps per sampling interval, shape (n − 1,).
    step_s
        Length of every step, shape (L,).
    stage_input
        Input at the stages of every step, shape (L, 3).
    ends
        Which steps end on a sample, shape (L,).
    """

    counts: npt.NDArray[np.intp]
    step_s: Array
    stage_input: Array
    ends: npt.NDArray[np.bool_]

    def same_as(self, other: Division) -> bool:
        """Whether both divide every interval alike."""
        return bool(np.array_equal(self.counts, other.counts))


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

    @abstractmethod
    def exponent_rate(self) -> float:
        """Largest |d log coefficient/du|: how fast the coefficients bend with the input."""

    def equilibrium(self, u: float) -> float:
        """Position x = F/Q at constant input."""
        _, stiffness, force = self.coefficients(np.array([u]))
        return float(force[0] / stiffness[0])

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
    steps_s, stage_u, ends = plan.step_s, plan.stage_input, plan.ends
    n, n_parameters = time_s.size, law.mass_by.size
    from_rest = start is None or relative
    x0 = law.equilibrium(float(u[0])) if from_rest else 0.0
    v0 = 0.0
    if start is not None:
        x0, v0 = x0 + float(start[0]), float(start[1])
    state = np.array([x0, v0])
    x, v = np.empty(n), np.empty(n)
    x[0], v[0] = x0, v0
    tangent = np.zeros((2, n_parameters + 2))
    by = np.empty((n, n_parameters + 2)) if derivatives else None
    if by is not None:
        tangent[0, n_parameters] = tangent[1, n_parameters + 1] = 1.0
        if from_rest:
            tangent[0, :n_parameters] = law.equilibrium_by(float(u[0]))
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


def divide(law: Law, time_s: Array, u: Array) -> Division:
    """Divide the sampling intervals so that the error stays below 1e-4 of the motion.

    Parameters
    ----------
    law
        The coefficients, whose rates decide.
    time_s, u
        Sample times and input, each of shape (n,).
    """
    damping, stiffness, _ = law.coefficients(u)
    rate = _rate(law.mass, damping, stiffness)
    duration_s, rise = np.diff(time_s), np.diff(u)
    with np.errstate(invalid="ignore", over="ignore"):
        wanted = np.maximum(
            duration_s * np.maximum(rate[:-1], rate[1:]) / MAX_PHASE_PER_STEP,
            np.abs(rise) * law.exponent_rate() / MAX_EXPONENT_PER_STEP,
        )
    finite = np.where(np.isfinite(wanted), wanted, 1.0)
    counts = np.clip(np.ceil(finite), 1, MAX_SUBSTEPS).astype(np.intp)
    return divided(time_s, u, counts, STAGES)


def divided(time_s: Array, u: Array, counts: npt.NDArray[np.intp], stages: Array) -> Division:
    """Divide every sampling interval into a given number of steps, the input straight within it.

    Parameters
    ----------
    time_s, u
        Sample times and input, each of shape (n,).
    counts
        Steps per interval, shape (n − 1,).
    stages
        Positions within a step at which the rule needs the input, shape (3,).
    """
    duration_s, rise = np.diff(time_s), np.diff(u)
    if counts.max(initial=1) == 1:
        whole = u[:-1, None] + rise[:, None] * stages
        return Division(counts, duration_s, whole, np.ones(counts.size, bool))
    owner = np.repeat(np.arange(counts.size), counts)
    last = np.cumsum(counts) - 1
    within = np.arange(owner.size) - np.repeat(last - counts + 1, counts)
    fraction = (within[:, None] + stages[None, :]) / counts[owner][:, None]
    ends = np.zeros(owner.size, bool)
    ends[last] = True
    return Division(
        counts,
        (duration_s / counts)[owner],
        u[:-1][owner][:, None] + rise[owner][:, None] * fraction,
        ends,
    )


def _rate(mass: float, damping: Array, stiffness: Array) -> Array:
    """Speed of the motion that a step must resolve.

    |λ| when the law oscillates. When it is overdamped a jump of the force excites the fast mode to
    slow/fast of the whole motion only, so a stiff mode may be stepped over the more boldly the
    stiffer it is, and beyond `STIFF_RATIO` entirely: the rule damps it as nature does.
    """
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        discriminant = damping**2 - 4.0 * mass * stiffness
        slow = 2.0 * stiffness / (damping + np.sqrt(np.maximum(discriminant, 0.0)))
        oscillating = np.sqrt(stiffness / mass) if mass > 0 else np.zeros_like(stiffness)
        stiff = oscillating**2 / slow**2
        bold = np.where(stiff < STIFF_RATIO, slow * stiff ** (1.0 - STIFF_EXPONENT), slow)
        rate: Array = np.where(discriminant < 0, oscillating, bold)
    return np.where(np.isfinite(rate), rate, 0.0)


def speeds(law: Law, u: float, u_unit: str | None = None) -> dict[str, tuple[float, str]]:
    """Time constant N/Q, natural frequency √(Q/M)/2π and damping ratio N/2√(QM) at one input.

    Parameters
    ----------
    law
        The coefficients.
    u
        The input.
    u_unit
        Its unit, to name the place; None when the coefficients are the same everywhere.
    """
    damping, stiffness, _ = (float(c[0]) for c in law.coefficients(np.array([u])))
    at = f"_at_{u:.0f}_{u_unit}" if u_unit else ""
    found: dict[str, tuple[float, str]] = {}
    if damping > 0:
        found[f"time_constant{at}"] = (damping / stiffness, "s")
    if law.mass > 0:
        found[f"natural_frequency{at}"] = (float(np.sqrt(stiffness / law.mass)) / (2 * np.pi), "Hz")
        found[f"damping_ratio{at}"] = (damping / (2.0 * float(np.sqrt(stiffness * law.mass))), "1")
    return found


def faded(law: Law, order: Order, period_s: float, inputs: Array) -> tuple[Order, str] | None:
    """The lower order to continue with when the fast mode cannot be seen, and why.

    Parameters
    ----------
    law
        The coefficients.
    order
        Its order now.
    period_s
        Sampling interval.
    inputs
        Inputs over the fitted range, shape (m,).
    """
    damping, stiffness, _ = law.coefficients(inputs)
    with np.errstate(divide="ignore", invalid="ignore"):
        inertia_s = float(np.max(law.mass / damping))
        settling_s = float(np.max(damping / stiffness))
    if order == "second" and inertia_s < UNSEEN_PERIODS * period_s:
        return "first", _reason("the inertia dies out", inertia_s, period_s)
    if order == "first" and settling_s < UNSEEN_PERIODS * period_s:
        return "static", _reason("the motion settles", settling_s, period_s)
    return None


def _reason(what: str, duration_s: float, period_s: float) -> str:
    limit_s = UNSEEN_PERIODS * period_s
    how = f"within {duration_s:.2g} s" if duration_s > 1e-3 * period_s else "at once"
    return f"{what} {how}, and less than {limit_s:.2g} s cannot be seen at this sampling interval"
