"""Residual and Jacobian of an output-error problem, a segment and channel at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.segment import Segment

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


def undefined_blocks(
    segments: Sequence[Segment], outputs: Sequence[str], size: int | None, *, only: int | None
) -> Iterator[Block]:
    """Blocks of NaN, where the parameters are such that nothing can be simulated.

    Parameters
    ----------
    segments, outputs
        Segments and output channels of the problem.
    size
        Number U of unknowns; None without Jacobians.
    only
        Index of the only segment wanted; None for all.
    """
    for k, segment in enumerate(segments):
        for name in outputs if only in (None, k) else ():
            count = int(segment.used[name].sum())
            jacobian = None if size is None else np.full((count, size), np.nan)
            yield Block(name, k, np.full(count, np.nan), jacobian)
