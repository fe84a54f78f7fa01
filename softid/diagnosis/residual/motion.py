"""The residual beside the motion that it belongs to."""

from __future__ import annotations

import numpy as np

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.structure import ResidualContext


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
