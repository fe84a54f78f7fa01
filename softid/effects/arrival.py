"""The input that arrives at the stages of every integration step.

A delayed step bends inside an integration step, and a line can ring faster than the stages sample.
So input effects act on times several times finer than the stages, and each step then receives the
parabola that is nearest to what arrives within it (least squares with Simpson's weights): it keeps
the mean and the first moment of the input, on which the motion at the end of the step depends.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
import numpy.typing as npt

from softid.effects.base import InputEffect, Scale
from softid.log import Segment
from softid.models.division import Division

Array = npt.NDArray[np.float64]

NODES_PER_STEP = 16


def arriving_input(
    effects: Sequence[tuple[InputEffect, Array]], segment: Segment, plan: Division, scale: Scale
) -> tuple[float, Array]:
    """Pass the recorded input through input effects.

    Parameters
    ----------
    effects
        Effects in the order in which they act, each with its parameters.
    segment
        Times and recorded input.
    plan
        Division of the sampling intervals into steps.
    scale
        Sizes of the logs and of the base model.

    Returns
    -------
    float, array of shape (L, 3)
        What arrives at the first sample and at the stages of every step.
    """
    if not effects:
        return float(segment.input[0]), plan.stage_input
    ends = np.cumsum(plan.step_s)
    begins_s = segment.time_s[0] + ends - plan.step_s
    fractions = np.arange(1, NODES_PER_STEP + 1) / NODES_PER_STEP
    inner_s = begins_s[:, None] + plan.step_s[:, None] * fractions
    time_s = np.concatenate((segment.time_s[:1], inner_s.ravel()))
    u = np.interp(time_s, segment.time_s, segment.input)
    for effect, eta in effects:
        u = effect.apply(eta, time_s, u, scale)
    nodes = np.column_stack((u[:-1:NODES_PER_STEP], u[1:].reshape(-1, NODES_PER_STEP)))
    at_stages: Array = nodes @ _to_stages().T
    return float(u[0]), at_stages


@cache
def _to_stages() -> Array:
    """Matrix from the values at the nodes of a step to those of the nearest parabola, (3, m)."""
    from softid.kernels.radau import STAGES

    nodes = np.linspace(0.0, 1.0, NODES_PER_STEP + 1)
    weights = np.ones(nodes.size)
    weights[1:-1:2] = 4.0
    weights[2:-1:2] = 2.0
    at_nodes = np.vander(nodes, 3)
    weighted = at_nodes.T * weights
    matrix: Array = np.vander(STAGES, 3) @ np.linalg.solve(weighted @ at_nodes, weighted)
    return matrix
