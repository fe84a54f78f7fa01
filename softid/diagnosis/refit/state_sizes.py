"""How far zeros and initial states may plausibly move, as far as the motion itself goes.

A log that begins in motion has initial states of its own, which may be forgotten before the first
sample that counts. Nothing holds them there, and a step of theirs that goes hundreds of spans away
breaks what remembers the motion, such as a rubber that softens. A reach far beyond the motion would
also make the first damping of a search, which is a share of the largest curvature, too strong for
parameters that the logs show faintly, such as the speed below which dry friction is smooth.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.fitters.problem import Problem
from softid.fitters.reach import motion_of, sizes_of_states
from softid.segment import Segment

Array = npt.NDArray[np.float64]

FARTHEST = 2.0
"""No log begins further from rest than so many spans of its motion, nor faster than so many times
its largest speed: from beyond that a start only draws a slow change of the reading."""


def reach_of(problem: Problem) -> Array:
    """How far each unknown may move, shape (U,): parameters by `Problem.reach`, others by size.

    Parameters
    ----------
    problem
        A problem.
    """
    far = problem.reach()
    for k, segment in enumerate(problem.segments):
        places = problem.state_positions(k)
        far[places] = state_sizes(segment, problem.outputs[0], len(places))
    for log in range(len(problem.logs)) if problem.zeros else ():
        mine = [s for s, owner in zip(problem.segments, problem.owner, strict=True) if owner == log]
        for name in problem.outputs:
            spans = [state_sizes(segment, name, 1)[0] for segment in mine]
            far[problem.zero_position(log, name)] = max(spans, default=1.0)
    return far


def bounds_of(problem: Problem) -> tuple[Array, Array]:
    """Bounds of the unknowns, each of shape (U,): those of `Problem.bounds`, and of initial states.

    Without a spring there is no rest that a position could be far from.

    Parameters
    ----------
    problem
        A problem.
    """
    lower, upper = problem.bounds()
    if not problem.has_equilibrium:
        return lower, upper
    for k, segment in enumerate(problem.segments):
        places = problem.state_positions(k)
        far = FARTHEST * state_sizes(segment, problem.outputs[0], len(places))
        lower[places], upper[places] = -far, far
    return lower, upper


def state_sizes(segment: Segment, output: str, count: int) -> Array:
    """Span and largest speed of what an output shows, for its position, velocity and own states.

    Parameters
    ----------
    segment
        A stretch of a log.
    output
        The output channel.
    count
        Number of states: a position, a velocity, and then positions that follow it.

    Returns
    -------
    Array
        Positive, shape (count,).

    Examples
    --------
    >>> time_s, y = np.array([0.0, 1.0, 2.0]), np.array([0.0, 3.0, 4.0])
    >>> used = {"angle": np.ones(3, bool)}
    >>> segment = Segment("log", 0, 0, 3, time_s, y, {"angle": y}, used)
    >>> state_sizes(segment, "angle", 3).tolist()
    [4.0, 3.0, 4.0]
    """
    span, speed = (size or 1.0 for size in motion_of(segment, output))  # 0 where nothing moves
    return sizes_of_states(span, speed, count)
