"""The residual beside the motion that it belongs to."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import FINE, Candidate, limited_plan
from softid.diagnosis.residual.structure import ResidualContext
from softid.segment import Segment

Array = npt.NDArray[np.float64]


def residual_context(candidate: Candidate) -> list[ResidualContext]:
    """Residual of the first output and the motion around it, for every segment."""
    problem, z = candidate.problem, candidate.minimum.point
    first = problem.outputs[0]
    blocks = {b.segment: b for b in problem.blocks(z, derivatives=False) if b.channel == first}
    found = []
    for k, segment in enumerate(problem.segments):
        response = problem.response(z, k)
        x = response.outputs[first] if response.x is None else response.x
        v = np.gradient(x, segment.time_s) if response.v is None else response.v
        residual = np.full(segment.time_s.size, np.nan)
        residual[segment.used[first]] = blocks[k].residual
        rows = (segment.time_s, x, v, segment.input, residual)
        found.append(ResidualContext(*(segment.samples_of(row) for row in rows)))
    return found


def simulated(candidate: Candidate, k: int, segment: Segment) -> Array:
    """The first output of a model at the samples of a segment whose input may be another.

    Parameters
    ----------
    candidate
        The model where it stands.
    k
        Index of the segment.
    segment
        That segment, or the same with a changed input.
    """
    problem, z = candidate.problem, candidate.minimum.point
    theta = problem.theta(z)
    law = problem.model.motion_law(theta)
    plan = limited_plan(problem.model.plan(theta, segment), segment, law, FINE)
    found: Array = problem.response(z, k, segment, plan).outputs[problem.outputs[0]]
    return segment.samples_of(found)
