"""What a measured input did between its samples, as far as they do not tell it.

Where it bends by another amount at the end of an interval than at the beginning, as beside a corner
behind a quick valve, it is drawn over a middle that is higher or lower by as much as is usual; a
simulation tells what that does to the first output. A held input has no such intervals.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.jump_timing import untimed_jumps
from softid.diagnosis.residual.motion import simulated
from softid.intersample import HELD
from softid.parallel import in_parallel
from softid.segment import Segment, with_added

Array = npt.NDArray[np.float64]

OF_BEND = 12.0**-0.5
"""Height of the middle of an interval above a straight line, as a share of the change of the second
difference over it: a step anywhere in an interval, which changes it by twice its height, moves the
mean over that interval by a standard deviation of 1/√12 of the height."""

ABOVE_NOISE = 8.0
"""An input bends where the change of its second difference is so many times the median size of such
a change."""

LEAST_READINGS = 4
"""Fewest readings of an input that tell a bend."""

SEED = 0
"""Seed of the draws of what the input did between its samples, which nobody knows."""


def moved_by_courses(
    model: Candidate, draws: Sequence[int], *, without_jumps: bool
) -> list[list[Array]]:
    """What draws of another course do to the first output, each at the samples of each segment.

    Parameters
    ----------
    model
        The model where it stands.
    draws
        Numbers of the draws.
    without_jumps
        Whether a jump from one sample to the next stays as it is drawn.
    """
    problem = model.problem
    still = [
        None
        if problem.logs[problem.owner[k]].effective_intersample in HELD
        else simulated(model, k, segment)
        for k, segment in enumerate(problem.segments)
    ]

    def moved(draw: int) -> list[Array]:
        found = []
        for k, (segment, before) in enumerate(zip(problem.segments, still, strict=True)):
            if before is None:
                found.append(np.zeros(segment.samples_of(segment.time_s).size))
                continue
            rng = np.random.default_rng((SEED, k, draw))
            course = _another_course(segment, rng, without_jumps=without_jumps)
            found.append(simulated(model, k, course) - before)
        return found

    return in_parallel(moved, draws)


def _another_course(segment: Segment, rng: np.random.Generator, *, without_jumps: bool) -> Segment:
    """The segment with a draw of what its input did where it bends."""
    time_s, u = segment.readings
    if u.size < LEAST_READINGS:
        return segment
    bends = np.abs(np.diff(u, 3, prepend=u[:1], append=u[-1:]))
    is_open = bends > ABOVE_NOISE * float(np.median(bends))
    bends = np.minimum(bends, 2.0 * np.abs(np.diff(u)))  # beside a jump it is flat
    if without_jumps:
        is_open &= ~np.isin(time_s[:-1], untimed_jumps(segment)[:, 0])
    at = np.flatnonzero(is_open)
    lost = rng.choice((-1.0, 1.0), at.size)
    middle_s = 0.5 * (time_s[at] + time_s[at + 1])
    nothing = np.zeros(at.size)
    return with_added(
        segment,
        np.column_stack((time_s[at], middle_s, time_s[at + 1])),
        np.column_stack((nothing, OF_BEND * bends[at] * lost, nothing)),
    )
