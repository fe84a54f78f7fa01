"""What the rounding of the first output leaves of a true model, where no noise blurs it.

A reading between two steps of a converter is off by as much as half a step, by the same as long as
the actuator stands still. That is no noise between neighbouring samples, but no misfit either.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.noise_floor import NoiseFloor
from softid.excitation import find_quantisation, run_starts

Array = npt.NDArray[np.float64]

UNIFORM_SQUARE_VARIANCE = 0.8
"""Variance of the square of a number that lies anywhere in an interval about zero, over the square
of its mean."""


def rounding_floor(model: Candidate) -> NoiseFloor | None:
    """Mean square of the rounding of the first output, q²/12; None where it lies on no grid.

    Every run of equal readings is one draw of what was rounded, and counts by its length.

    Parameters
    ----------
    model
        A fit; its samples are as they were recorded.
    """
    problem = model.problem
    first = problem.outputs[0]
    runs = [
        segment.outputs[first][segment.used[first]]
        for segment in problem.segments
        if first in segment.outputs
    ]
    runs = [run for run in runs if run.size]
    grid = find_quantisation(np.concatenate(runs)) if runs else None
    if grid is None:
        return None
    lengths = np.concatenate([np.diff(run_starts(run), append=run.size) for run in runs])
    draws = float(lengths.sum()) ** 2 / float(lengths @ lengths)
    relative_sd = float(np.sqrt(UNIFORM_SQUARE_VARIANCE / draws))
    return NoiseFloor(grid.step**2 / 12.0, relative_sd, from_rest=False, from_rounding=True)
