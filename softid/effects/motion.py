"""Motion of a model's law with state effects in it, on a segment's own times."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from softid.effects.base import StateEffect
from softid.effects.scale import Scale
from softid.kernels.small_matrix import LANES
from softid.models.arrived_input import observed, simulate_law_through
from softid.models.base import Model, MotionTerm, Response
from softid.models.division import Division
from softid.segment import Segment

if TYPE_CHECKING:
    from softid.kernels.equation import Equation

Array = npt.NDArray[np.float64]

BLOCK = 1024
"""Steps whose coefficients are held at once, which stay in the processor's cache."""

DIFFERENCE = 1e-7
"""Relative step by which parameters and states are moved to differentiate the terms within a step:
their values are exact to rounding, so a smaller one does than for whole responses."""

REST_ITERATIONS = 50
"""Newton's steps to a rest at most."""

REST_TOLERANCE = 1e-12
"""The rest is found when a step is so small, in the scale of the states."""


@dataclass(frozen=True, eq=False)
class _Terms:
    """Addresses, parameters and states of the effects, as the kernel wants them."""

    addresses: npt.NDArray[np.int64]
    eta: Array
    eta_from: npt.NDArray[np.int64]
    own: npt.NDArray[np.int64]
    follows: tuple[bool, ...]
    scale: Array
    moves: Array
    columns: npt.NDArray[np.int64]
    """Which entries of ``eta`` are parameters, not constants."""

    @property
    def n_own(self) -> int:
        return len(self.follows)

    @property
    def followers(self) -> npt.NDArray[np.intp]:
        """Which of the own states rest at the position."""
        return np.flatnonzero(self.follows)

    def equation(self, theta: Array, term: MotionTerm | None) -> Equation:
        """What the kernel integrates; it moves and restores the arrays, so they are its own."""
        from softid.kernels.equation import Equation

        law, slopes = (0, 0) if term is None else (term.address, term.slopes_address)
        own = theta.copy() if term is None else term.parameters.copy()[: theta.size]
        eta = self.eta.copy()
        return Equation(law, slopes, own, self.addresses, eta, self.eta_from, self.own)


def simulate_motion(
    model: Model,
    effects: Sequence[StateEffect],
    scale: Scale,
    theta: Array,
    eta: Array,
    segment: Segment,
    outputs: Sequence[str],
    *,
    first_input: float,
    stage_input: Array,
    plan: Division,
    start: Array | None,
    relative: bool,
    derivatives: bool,
) -> Response:
    """Simulate one segment with state effects and an input that is given at the stages.

    Parameters
    ----------
    model
        The model without effects, with a law of motion.
    effects
        Effects in the equation of motion.
    scale
        Sizes that their constants go by.
    theta, eta
        Parameters of the model, shape (K,), and of the effects one after the other, shape (H,).
    segment
        Times.
    outputs
        Output channels wanted.
    first_input, stage_input
        Input that arrives at the first sample, and at the stages of every step, shape (L, 3).
    plan
        Division of the sampling intervals.
    start
        Position and velocity as in `Model.response`; behind them, by how much each own state that
        rests at the position lies off it, which is nothing where that is left out.
    relative, derivatives
        As in `Model.response`.

    Returns
    -------
    Response
        Its derivatives are by (θ, η).
    """
    term = model.motion_term(theta)
    law = model.motion_law(theta)
    if term is None and law is None:
        raise TypeError(f"{model.name} has no law of motion")
    if law is not None and not effects:
        motion = simulate_law_through(
            law,
            plan,
            first_input,
            stage_input,
            start,
            derivatives=derivatives,
            relative=relative,
        )
        if motion is not None:
            return observed(model, outputs, motion)
    return _integrated(
        model,
        _gather(effects, scale, eta),
        theta,
        segment,
        outputs,
        first_input,
        stage_input,
        plan,
        start,
        relative=relative,
        derivatives=derivatives,
    )


def _integrated(
    model: Model,
    terms: _Terms,
    theta: Array,
    segment: Segment,
    outputs: Sequence[str],
    first_input: float,
    stage_input: Array,
    plan: Division,
    start: Array | None,
    *,
    relative: bool,
    derivatives: bool,
) -> Response:
    """The motion stage by stage, by Newton's method, as a law with terms needs it."""
    from softid.kernels.term_integrator import Course, integrate

    term = model.motion_term(theta)
    n, n_theta = segment.time_s.size, theta.size
    since_s = segment.time_s[0] - segment.log_start_s
    state, tangent, off_rest = _begun(
        model, terms, theta, first_input, since_s, start, relative=relative, derivatives=derivatives
    )
    motion, by = np.empty((n, 2)), np.empty((n, tangent.shape[1]))
    motion[0], by[0] = state[:2], tangent[0]
    places = np.empty((len(stage_input), 2, 3))
    np.subtract(plan.stage_s, segment.log_start_s, out=places[:, 0])
    places[:, 1] = stage_input
    with_room = np.concatenate((stage_input, stage_input[-1:]))  # see `Course.coefficients_by`
    equation = terms.equation(theta, term)
    sample = 1
    for first in range(0, plan.step_s.size, BLOCK):
        length = min(BLOCK, plan.step_s.size - first)
        block = slice(first, first + length)
        inputs = with_room[first : first + length + 1]
        coefficients, coefficients_by = _packed(model, theta, inputs, derivatives)
        reached = np.flatnonzero(plan.ends[block])
        stop = sample + reached.size
        undivided = reached.size == length  # then what is found needs no copy
        states = motion[sample:stop] if undivided else np.empty((length, 2))
        tangents = by[sample:stop] if undivided else np.empty((length, tangent.shape[1]))
        course = Course(
            plan.step_s[block],
            places[block],
            coefficients[:length],
            coefficients_by,
            terms.scale,
            terms.moves,
        )
        wanted = tangents if derivatives else tangents[:0]
        solved = integrate(equation, course, state, tangent, states, wanted)
        if not solved:
            motion[sample:], by[sample:] = np.nan, 0.0
            break
        if not undivided:
            motion[sample:stop] = states[reached]
            if derivatives:
                by[sample:stop] = tangents[reached]
        sample = stop
    begun = np.concatenate((motion[0], off_rest))
    found = _response(model, outputs, motion, by, begun, terms, n_theta, derivatives=derivatives)
    return found if term is None else term.with_drift(found, theta, segment.time_s)


def _begun(
    model: Model,
    terms: _Terms,
    theta: Array,
    u: float,
    t: float,
    start: Array | None,
    *,
    relative: bool,
    derivatives: bool,
) -> tuple[Array, Array, Array]:
    """States at the first sample, their derivatives, and how far own states lie off their rest."""
    from_rest = start is None or relative
    state = np.zeros(2 + terms.n_own)
    by_start = theta.size + terms.eta.size
    tangent = np.zeros((state.size, by_start + 2 + terms.followers.size))
    if from_rest:
        state[0] = _rest_position(model, terms, theta, u, t)
        if derivatives:
            by_rest = _rest_by(model, terms, theta, float(state[0]), u, t)
            tangent[0, :by_start] = by_rest
    begun = np.zeros(2 + terms.followers.size)
    if start is not None:
        begun[: start.size] = start
    state[:2] += begun[:2]
    tangent[[0, 1], [by_start, by_start + 1]] = 1.0
    for j, k in enumerate(terms.followers):
        state[2 + k] = state[0] + begun[2 + j]
        tangent[2 + k] = tangent[0]
        tangent[2 + k, by_start + 2 + j] = 1.0
    return state, tangent, begun[2:]


def _response(
    model: Model,
    outputs: Sequence[str],
    motion: Array,
    by: Array,
    start: Array,
    terms: _Terms,
    n_theta: int,
    *,
    derivatives: bool,
) -> Response:
    values, by_parameter, by_state = {}, {}, {}
    x, v = motion.T
    kept = _span(np.concatenate((np.arange(n_theta), n_theta + terms.columns)))
    first = n_theta + terms.eta.size
    own = first + 2 + np.arange(terms.followers.size)
    starts = _span(np.concatenate((first + np.arange(len(model.start_states)), own)))
    for name in outputs:
        values[name], slope = model.observed(x, name)
        if derivatives:
            by_parameter[name] = by[:, kept] * slope[:, None]
            by_state[name] = by[:, starts] * slope[:, None]
    if not derivatives:
        return Response(values, None, None, start, x, v)
    return Response(values, by_parameter, by_state, start, x, v)


def _span(columns: npt.NDArray[np.int64]) -> slice | npt.NDArray[np.int64]:
    """Columns as a slice where they follow each other, which spares a copy."""
    first = int(columns[0]) if columns.size else 0
    whole = slice(first, first + int(columns.size))
    return whole if np.array_equal(columns, np.arange(whole.start, whole.stop)) else columns


def _gather(effects: Sequence[StateEffect], scale: Scale, eta: Array) -> _Terms:
    values: list[float] = []
    begins, own = [0], []
    columns: list[int] = []
    follows: list[bool] = []
    sizes: list[float] = []
    at = 0
    for effect in effects:
        declared = effect.parameters(scale)
        count = len(declared)
        columns.extend(range(len(values), len(values) + count))
        constants = effect.constants(scale)
        values.extend((*eta[at : at + count].tolist(), *constants))
        sizes.extend(parameter.usual_size for parameter in declared.values())
        sizes.extend(0.0 for _ in constants)  # nobody asks how the motion goes with them
        at += count
        begins.append(len(values))
        own.append(len(follows) if effect.has_state else -1)
        if effect.has_state:
            follows.append(effect.follows_position)
    ranges = [scale.x_span, scale.v_max, *(scale.x_span if does else 1.0 for does in follows)]
    return _Terms(
        np.array([effect.address() for effect in effects], np.int64),
        np.array(values, np.float64),
        np.array(begins, np.int64),
        np.array(own, np.int64),
        tuple(follows),
        np.array(ranges, np.float64),
        DIFFERENCE * np.array(sizes),
        np.array(columns, np.int64),
    )


def _packed(model: Model, theta: Array, u: Array, derivatives: bool) -> tuple[Array, Array]:
    """m, n, q and f at inputs of shape (L, 3), and their derivatives."""
    law = model.motion_law(theta)
    if law is None:  # the kernel calls the law itself
        return np.zeros((*u.shape, 4)), np.zeros((len(u) if derivatives else 0, 3, 4, 0, LANES))
    return law.packed(u, derivatives=derivatives)


def _unbalanced(
    model: Model, terms: _Terms, theta: Array, u: float, t: float
) -> Callable[[float], float]:
    """Position → force that is left at rest there."""
    from softid.kernels.term_integrator import unbalanced_at_rest

    packed, _ = _packed(model, theta, np.array([[u]]), False)
    equation = terms.equation(theta, model.motion_term(theta))
    return unbalanced_at_rest(equation, packed[0, 0], terms.follows, u, t)


def _rest_position(model: Model, terms: _Terms, theta: Array, u: float, t: float) -> float:
    """Position at which nothing moves, by Newton's method from the model's own; NaN if none."""
    still = model.motion_law(theta) or model.motion_term(theta)
    assert still is not None
    x = still.equilibrium(u)
    if not terms.addresses.size:
        return x
    h = DIFFERENCE * terms.scale[0]
    balance = _unbalanced(model, terms, theta, u, t)
    for _ in range(REST_ITERATIONS):
        left = balance(x)
        slope = (balance(x + h) - left) / h
        move = left / slope if slope != 0.0 else np.nan
        x -= float(np.clip(move, -terms.scale[0], terms.scale[0]))
        if not np.isfinite(x) or abs(move) < REST_TOLERANCE * terms.scale[0]:
            return x
    return x


def _rest_by(model: Model, terms: _Terms, theta: Array, x: float, u: float, t: float) -> Array:
    """Derivatives of the position at rest by (θ, η), from the balance of forces."""
    balance = _unbalanced(model, terms, theta, u, t)
    left = balance(x)
    h = DIFFERENCE * terms.scale[0]
    slope = (balance(x + h) - left) / h
    by = np.zeros(theta.size + terms.eta.size)
    law = model.motion_law(theta)
    if law is not None and not terms.addresses.size:
        by[: theta.size] = law.equilibrium_by(u)
        return by
    least = [p.usual_size for p in model.parameters().values()]  # where some θ is zero or nearly
    for k, step in enumerate(DIFFERENCE * np.maximum(np.abs(theta), least)):
        there = _unbalanced(model, terms, _moved(theta, k, step), u, t)(x)
        by[k] = -(there - left) / step / slope
    for k in np.flatnonzero(terms.moves).tolist():
        step = terms.moves[k]
        elsewhere = replace(terms, eta=_moved(terms.eta, k, step))
        there = _unbalanced(model, elsewhere, theta, u, t)(x)
        by[theta.size + k] = -(there - left) / step / slope
    return by


def _moved(values: Array, k: int, step: float) -> Array:
    moved = values.copy()
    moved[k] += step
    return moved


def rest(
    model: Model,
    effects: Sequence[StateEffect],
    scale: Scale,
    theta: Array,
    eta: Array,
    u: float,
) -> float:
    """Position at rest under a constant input; NaN when there is none.

    Parameters
    ----------
    model, effects, scale, theta, eta
        As in `simulate_motion`.
    u
        The input.
    """
    terms = _gather(effects, scale, eta)
    return _rest_position(model, terms, theta, u, 0.0)
