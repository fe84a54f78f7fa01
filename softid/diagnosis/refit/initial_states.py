"""Initial states of a model with effects, where those of the base make up for what it lacks.

A base without friction or delay begins a motion somewhere else, and with another velocity, to miss
the first seconds by less. With the effect nothing leads back from there: dry friction stops such a
beginning at once, and what is left of it no longer depends on the state.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate, standing_at

Array = npt.NDArray[np.float64]


def with_settled_starts(candidate: Candidate, sigma: Mapping[str, float]) -> Candidate:
    """The candidate with segments that begin settled wherever that explains them better.

    Parameters
    ----------
    candidate
        A model at its optimum for white noise.
    sigma
        Output channel → scale that its residual is divided by.

    Returns
    -------
    Candidate
        The candidate itself where nothing is won.
    """
    problem, point = candidate.problem, candidate.minimum.point
    positions = [problem.state_positions(k) for k in range(len(problem.segments))]
    moved = [k for k, states in enumerate(positions) if np.any(point[states])]
    if not moved or not problem.has_equilibrium:
        return candidate
    z, won = point.copy(), 0.0
    for k in moved:
        settled = point.copy()
        settled[positions[k]] = 0.0
        gain = _squares(candidate, point, k, sigma) - _squares(candidate, settled, k, sigma)
        if gain > 0.0:
            z[positions[k]] = 0.0
            won += gain
    if won <= 0.0:
        return candidate
    placed = standing_at(z, candidate.minimum, candidate.prior, candidate.squares - won)
    return replace(candidate, minimum=placed)


def _squares(candidate: Candidate, z: Array, segment: int, sigma: Mapping[str, float]) -> float:
    """Weighted sum of squares of one segment; infinite where it cannot be simulated."""
    blocks = candidate.problem.blocks(z, derivatives=False, only=segment)
    scaled = [block.residual / sigma[block.channel] for block in blocks]
    squares = sum(float(r @ r) for r in scaled)
    return squares if np.isfinite(squares) else np.inf
