"""Motion of a model's law with state effects in it, on a segment's own times."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.effects.base import StateEffect
from softid.effects.extension.rest import rest_by, rest_position
from softid.effects.extension.terms import Terms, terms_of
from softid.effects.scale import Scale
from softid.kernels.small_matrix import LANES
from softid.models.arrived_input import observed, simulate_law_through
from softid.models.base import Model, Response
from softid.models.division import Division
from softid.segment import Segment

Array = npt.NDArray[np.float64]

BLOCK = 1024
"""Steps whose coefficients are held at once, which stay in the processor's cache."""


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
        terms_of(tuple(effects), scale, eta),
        theta,
        segment,
        outputs,
        first_input=first_input,
        stage_input=stage_input,
        plan=plan,
        start=start,
        relative=relative,
        derivatives=derivatives,
    )


def _integrated(
    model: Model,
    terms: Terms,
    theta: Array,
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
    terms: Terms,
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
        state[0] = rest_position(model, terms, theta, u, t)
        if derivatives:
            by_rest = rest_by(model, terms, theta, float(state[0]), u, t)
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
    terms: Terms,
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


def _packed(model: Model, theta: Array, u: Array, derivatives: bool) -> tuple[Array, Array]:
    """m, n, q and f at inputs of shape (L, 3), and their derivatives."""
    law = model.motion_law(theta)
    if law is None:  # the kernel calls the law itself
        return np.zeros((*u.shape, 4)), np.zeros((len(u) if derivatives else 0, 3, 4, 0, LANES))
    return law.packed(u, derivatives=derivatives)
