"""How far initial states may plausibly move, as far as the motion itself goes.

A log that begins in motion has initial states of its own, which are forgotten before the first
sample that counts. Nothing holds them there, and a step of theirs that goes hundreds of spans away
breaks what remembers the motion, such as a rubber that softens.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.fitters.problem import Problem
from softid.segment import Segment

Array = npt.NDArray[np.float64]


def reach_of(problem: Problem) -> Array:
    """How far each unknown may move, shape (U,): `Problem.reach`, and unheld states by their sizes.

    Where the first samples count they hold the state.

    Parameters
    ----------
    problem
        A problem.
    """
    far, first = problem.reach(), problem.outputs[0]
    for k, segment in enumerate(problem.segments):
        places = problem.state_positions(k)
        if len(places) and not segment.samples_of(segment.used[first])[0]:
            far[places] = state_sizes(segment, first, len(places))
    return far


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
    used = segment.used[output]
    time_s, y = segment.time_s[used], segment.outputs[output][used]
    span = float(np.ptp(y)) if y.size else 0.0
    speed = float(np.max(np.abs(np.diff(y) / np.diff(time_s)), initial=0.0))
    span, speed = span or 1.0, speed or 1.0  # nothing moves
    return np.array((span, speed, *[span] * count))[:count]
