"""A problem with other measured outputs, such as a response with noise that is drawn again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.fitters.problem import Problem

Array = npt.NDArray[np.float64]


def redrawn(whole: Problem, outputs: Mapping[str, Sequence[Array]]) -> Problem:
    """A problem whose segments have measured other outputs.

    Parameters
    ----------
    whole
        The problem.
    outputs
        Output channel → values of every segment, of the same shapes.
    """
    segments = (
        replace(segment, outputs={name: values[k] for name, values in outputs.items()})
        for k, segment in enumerate(whole.segments)
    )
    return Problem.with_segments(whole, list(segments))
