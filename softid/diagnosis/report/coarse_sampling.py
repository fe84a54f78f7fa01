"""What the input did between its samples, beside what is left.

A measured input that rises within two or three samples, as behind a quick regulator that is logged
at 20 Hz, is known at these samples only. Whatever course is drawn between them, the actuator has
followed another one, and no law explains the difference.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.phrases import percent
from softid.diagnosis.residual.input_course import moved_by_courses
from softid.diagnosis.residual.motion import mean_square, residual_context
from softid.diagnosis_results import Diagnosis, Verdict
from softid.errors import Issue

TOLD_SHARE = 0.25
"""Share of the power of what is left from which on the coarse sampling of the input is told."""

COARSE_SAMPLING = "coarse-sampling"
"""Code of the remark that the input moves faster than it is sampled."""


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

    What opened the moments of its jumps has taken those out already.

    Parameters
    ----------
    final
        A model that leaves something.
    open_jumps
        How many jumps have open moments already.
    """
    problem = final.problem
    (parts,) = moved_by_courses(final, (0,), without_jumps=open_jumps > 0)
    moved = np.concatenate(parts)
    power = float(np.mean(moved**2))
    left = mean_square(residual_context(final))
    share = power / left if left > 0.0 else 0.0
    if not share >= TOLD_SHARE:
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
