"""The same problem over block averages of its samples: a cheap way to the right basin.

A log of ten thousand samples tells where the optimum is no better than two thousand averages do,
as long as the motion is slow against a block. The optimum itself is always taken over all samples.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.fitters.problem import Problem
from softid.segment import Segment

Array = npt.NDArray[np.float64]

SAMPLES = 2000
"""Residuals that are left, about, or more where the blocks would become too long."""

LONGEST = 8
"""Most samples in a block. A log of 100,000 samples in blocks of 50, longer than its motion takes,
led beside the basin, and the fit took twice as long as without."""

LEAST_BLOCKS = 20
"""Fewest blocks of a segment; the averages of shorter ones would lose their transients."""


class ThinnedProblem(Problem):
    """A problem over means of so many consecutive samples each, with the same unknowns.

    Parameters
    ----------
    whole
        The problem to be thinned.
    length
        Samples in a block.
    """

    def __init__(self, whole: Problem, length: int) -> None:
        super().__init__(whole.model, whole.parameters, whole.logs, zeros=whole.zeros)
        self.segments = [_averaged(s.without_knots(), length) for s in whole.segments]
        self.owner, self.at_rest = whole.owner, whole.at_rest
        self._layout()


def thinning(problem: Problem) -> int:
    """Samples in a block of averages; 1 where the problem is small or its segments are short."""
    shortest = min((s.time_s.size for s in problem.segments), default=0)
    return max(1, min(problem.n_samples // SAMPLES, shortest // LEAST_BLOCKS, LONGEST))


def _averaged(segment: Segment, length: int) -> Segment:
    """Block means; a block counts when all of its samples do."""
    count = segment.time_s.size // length

    def means(values: Array) -> Array:
        averages: Array = values[: count * length].reshape(count, length).mean(axis=1)
        return averages

    def whole(used: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
        every = np.all(used[: count * length].reshape(count, length), axis=1)
        return np.asarray(every, np.bool_)

    return replace(
        segment,
        time_s=means(segment.time_s),
        input=means(segment.input),
        outputs={name: means(y) for name, y in segment.outputs.items()},
        used={name: whole(used) for name, used in segment.used.items()},
    )
