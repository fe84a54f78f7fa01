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

from softid.effects.base import InputEffect
from softid.effects.scale import Scale
from softid.models.division import SMOOTH_NODES, Division
from softid.segment import Segment

Array = npt.NDArray[np.float64]

JUMPING = 0.02
"""Neighbouring times that are so much closer than others hold a jump between them."""

TRAPEZOID = np.array([2.0])
"""Weights of equal intervals, for values that are means about their nodes: what a jump takes from
one mean it gives to the next, and counts as much there."""

SIMPSON = np.array([2.0, 4.0])
"""Weights of two intervals after two: corners are seen best by a rule that is over soon."""

BOOLE = np.array([14.0, 32.0, 12.0, 32.0])
"""Weights of four intervals, exact for a polynomial of degree five: a parabola's fit to a cubic is
then that to its whole course."""


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
    from softid.kernels.stage_projection import gather

    time_s, u = plan.nodes
    since_s = time_s - segment.log_start_s
    for effect, eta in effects:
        u = effect.apply(eta, since_s, u, scale)
    nodes = plan.nodes_per_step
    at_stages = np.empty(((time_s.size - 1) // nodes, 3))
    weights = _to_stages(nodes, are_means=holds_jumps(time_s))
    gather(np.ascontiguousarray(u, np.float64), weights, at_stages)
    return float(u[0]), at_stages


def holds_jumps(time_s: Array) -> bool:
    """Whether times lie so close to one another somewhere that the input jumps between them.

    Parameters
    ----------
    time_s
        Times at which an input is known, shape (n,).
    """
    steps = np.diff(time_s)
    return bool(steps.min(initial=np.inf) < JUMPING * steps.max(initial=0.0))


@cache
def _to_stages(count: int, *, are_means: bool) -> Array:
    """Matrix from the values at the nodes of a step to those of the nearest parabola, (m, 3)."""
    from softid.kernels.radau import STAGES

    nodes = np.linspace(0.0, 1.0, count + 1)
    rule = BOOLE if count == SMOOTH_NODES else SIMPSON
    rule = TRAPEZOID if are_means else rule
    weights = np.append(np.tile(rule, count // rule.size), 0.5 * rule[0])
    weights[0] = weights[-1]
    at_nodes = np.vander(nodes, 3)
    weighted = at_nodes.T * weights
    matrix = np.vander(STAGES, 3) @ np.linalg.solve(weighted @ at_nodes, weighted)
    return np.ascontiguousarray(matrix.T)
