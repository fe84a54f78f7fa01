"""Whether logs hold a single step, from which few laws are told apart."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.fitters.problem import Problem
from softid.segment import Segment

Array = npt.NDArray[np.float64]

AT_ONCE = 0.1
"""A change of the input that takes this share of a log, or less, is a step; a slow ramp is a
staircase of all levels."""

NEAR_AN_END = 0.1
"""A level is reached within this share of the input's span: a measured pressure has noise and
overshoots."""


def is_one_step(problem: Problem) -> bool:
    """Whether every log holds one step of the input, and all of them the same one.

    Parameters
    ----------
    problem
        The logs; the input of an unused segment counts as well.
    """
    steps = [_step_of(segment) for segment in problem.segments]
    if any(step is None for step in steps):
        return False
    levels = np.array(steps, np.float64)
    span = float(np.max(np.abs(levels[:, 1] - levels[:, 0])))
    return bool(np.all(np.ptp(levels, axis=0) <= NEAR_AN_END * span))


def _step_of(segment: Segment) -> tuple[float, float] | None:
    """Levels before and after the only step; None where the input moves otherwise."""
    u, time_s = segment.input, segment.time_s
    low, high = float(np.min(u)), float(np.max(u))
    if not abs(u[-1] - u[0]) > (1.0 - 2.0 * NEAR_AN_END) * (high - low):
        return None  # it stays, or comes back
    rises = u[-1] > u[0]
    share = (u - low) / (high - low) if rises else (high - u) / (high - low)
    leaves = int(np.argmax(share > NEAR_AN_END))
    arrives = int(np.flatnonzero(share < 1.0 - NEAR_AN_END)[-1])
    takes_s = float(time_s[arrives] - time_s[leaves])
    if takes_s > AT_ONCE * float(time_s[-1] - time_s[0]):
        return None
    return float(u[0]), float(u[-1])
