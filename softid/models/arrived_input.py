"""Motion of a law whose input is not straight between the samples, but known at the stages."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.kernels.affine_blocks import N_PARAMETERS, N_STATES
from softid.kernels.affine_simulation import move_through
from softid.models.base import Model, Response
from softid.models.division import Division, held
from softid.models.second_order import Law, Motion, begun

Array = npt.NDArray[np.float64]


def simulate_law_through(
    law: Law,
    plan: Division,
    first_input: float,
    stage_input: Array,
    start: Array | None,
    *,
    derivatives: bool,
    relative: bool,
) -> Motion | None:
    """Integrate a law whose input is given at the stages of every Radau step.

    None for a law that the fast kernels do not know.

    Parameters
    ----------
    law, start, derivatives, relative
        As in `simulate_law`.
    plan
        Its steps.
    first_input, stage_input
        Input at the first sample, and at the stages of every step, shape (L, 3).
    """
    form = law.affine()
    if form is None:
        return None
    state, tangent = begun(form, first_input, start, relative=relative)
    n = plan.time_s.size
    x, v = np.empty(n), np.empty(n)
    by = np.empty((N_PARAMETERS + N_STATES, n if derivatives else 0))
    u = held(stage_input)
    move_through(form.kind, form.theta, plan.time_s, u, plan.counts, state, tangent, x, v, by)
    if not derivatives:
        return Motion(x, v, None, None)
    return Motion(x, v, by[:N_PARAMETERS].T @ form.by_theta, by[N_PARAMETERS:].T)


def observed(model: Model, outputs: Sequence[str], motion: Motion) -> Response:
    """Outputs and derivatives of a model that moves like this.

    Parameters
    ----------
    model
        The model.
    outputs
        Output channels wanted.
    motion
        Its motion.
    """
    values: dict[str, Array] = {}
    by_parameter: dict[str, Array] = {}
    by_state: dict[str, Array] = {}
    for name in outputs:
        values[name], slope = model.observed(motion.x, name)
        if motion.by_parameter is not None and motion.by_state is not None:
            by_parameter[name] = motion.by_parameter * slope[:, None]
            by_state[name] = (motion.by_state * slope[:, None])[:, : len(model.start_states)]
    begin = np.array([motion.x[0], motion.v[0]])
    if motion.by_parameter is None:
        return Response(values, None, None, begin, motion.x, motion.v)
    return Response(values, by_parameter, by_state, begin, motion.x, motion.v)
