"""Residual and Jacobian of an output-error problem, a segment and channel at a time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Block:
    """Residual and Jacobian of one output channel over one segment.

    Attributes
    ----------
    channel
        Output channel.
    segment
        Index in `Problem.segments`.
    residual
        Measured minus simulated at the used samples, in the channel's unit, shape (m,).
    jacobian
        ∂(simulated)/∂(unknowns), shape (m, U); None if not asked.
    """

    channel: str
    segment: int
    residual: Array
    jacobian: Array | None
