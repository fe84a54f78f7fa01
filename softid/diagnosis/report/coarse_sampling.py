"""What the input did between its samples, beside what is left.

A measured input that rises within two or three samples, as behind a quick regulator that is logged
at 20 Hz, is known at these samples only. Whatever course is drawn between them, the actuator has
followed another one, and no law explains the difference.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.phrases import percent
from softid.diagnosis.residual.jump_timing import untimed_jumps
from softid.diagnosis.residual.motion import mean_square, residual_context, simulated
from softid.diagnosis_results import Diagnosis, Verdict
from softid.errors import Issue
from softid.intersample import HELD
from softid.segment import Segment, with_added

Array = npt.NDArray[np.float64]

COARSE = 0.25
"""Share of the power of what is left from which on it is told."""

OF_BEND = 12.0**-0.5
"""Height of the middle of an interval above a straight line, as a share of the change of the second
difference over it: a step anywhere in an interval, which changes it by twice its height, moves the
mean over that interval by a standard deviation of 1/√12 of the height."""

ABOVE_NOISE = 8.0
"""An input bends where that change is so many times its median size."""

LEAST_READINGS = 4
"""So few tell no bend."""

COARSE_SAMPLING = "coarse-sampling"
"""Code of the remark that the input moves faster than it is sampled."""

SEED = 0
"""Of what it did meanwhile, which nobody knows."""


def with_coarse_sampling(answer: Diagnosis, base: Candidate) -> Diagnosis:
    """A diagnosis without a name, with a remark on an input that moves between its samples.

    That comes before any other advice.

    Parameters
    ----------
    answer
        The diagnosis.
    base
        The base fit to the logs.
    """
    if answer.verdict is not Verdict.UNKNOWN:
        return answer
    told = coarse_sampling_issues(base, open_jumps=answer.remainder.open_jumps)
    first = told[0].remedy if told else answer.next_experiment
    return replace(answer, issues=(*answer.issues, *told), next_experiment=first)


def coarse_sampling_issues(final: Candidate, *, open_jumps: int = 0) -> tuple[Issue, ...]:
    """A remark where what the input did between its samples may make a fair part of what is left.

    In every interval over which it bends by another amount at the end than at the beginning it is
    drawn over a middle that is higher or lower by as much as is usual; a simulation tells what that
    does to the first output. A held input has no such intervals, and what opened the moments of its
    jumps has taken those out already.

    Parameters
    ----------
    final
        A model that leaves something.
    open_jumps
        How many jumps have open moments already.
    """
    problem = final.problem
    moved = []
    for k, segment in enumerate(problem.segments):
        log = problem.logs[problem.owner[k]]
        if log.between_samples not in HELD:
            course = _another_course(segment, k, without_jumps=open_jumps > 0)
            moved.append(simulated(final, k, course) - simulated(final, k, segment))
    power = float(np.mean(np.concatenate(moved) ** 2)) if moved else 0.0
    left = mean_square(residual_context(final))
    share = power / left if left > 0.0 else 0.0
    if not share >= COARSE:
        return ()
    name, first = problem.logs[0].input, problem.outputs[0]
    output = problem.logs[0].channels[first]
    read_s, _ = problem.segments[0].readings
    period_s = float(np.median(np.diff(read_s)))
    return (
        Issue(
            COARSE_SAMPLING,
            "warning",
            f"{name} moves faster than it is sampled, every {period_s:.3g} s: what it did in "
            f"between by itself may move the simulated {first} by "
            f"{power**0.5 * output.display_factor:.3g} {output.display_unit} rms, "
            f"{percent(min(share, 1.0))} of the power of what is left",
            f"sample {name} several times as fast before looking for a cause",
        ),
    )


def _another_course(segment: Segment, k: int, *, without_jumps: bool) -> Segment:
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
    lost = np.random.default_rng((SEED, k)).choice((-1.0, 1.0), at.size)
    middle_s = 0.5 * (time_s[at] + time_s[at + 1])
    nothing = np.zeros(at.size)
    return with_added(
        segment,
        np.column_stack((time_s[at], middle_s, time_s[at + 1])),
        np.column_stack((nothing, OF_BEND * bends[at] * lost, nothing)),
    )
