"""That readings were not taken when their time stamps say, in words."""

from __future__ import annotations

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.motion import heard, residual_context
from softid.diagnosis.residual.uncertain_times import LEAST_SHARE, uncertain_times
from softid.diagnosis_results import Diagnosis, Verdict
from softid.errors import Issue

UNCERTAIN_TIMES = "uncertain-times"
"""Code of the remark that what is left grows with the speed, as readings at other times do."""


def timing_issues(answer: Diagnosis, final: Candidate) -> tuple[Issue, ...]:
    """How far readings seem to be off their time stamps; nothing where more than noise is left.

    Parameters
    ----------
    answer
        The diagnosis.
    final
        The model with all that is named.
    """
    left = answer.remainder
    if answer.verdict not in (Verdict.ADEQUATE, Verdict.NAMED) or left.leaves_something:
        return ()
    if left.open_jumps > 0:  # moments of jumps explain what is left where it is fast
        return ()
    problem = final.problem
    period_s = max(log.period_s for log in problem.logs)
    found = uncertain_times(heard(final, residual_context(final)), period_s)
    if found is None or found.share - left.input_noise < LEAST_SHARE:
        return ()  # what is not known of the input tells where the motion is fast, too
    first = problem.outputs[0]
    channel = problem.logs[0].channels[first]
    still, moving = (sd * channel.display_factor for sd in (found.still, found.moving))
    return (
        Issue(
            UNCERTAIN_TIMES,
            "warning",
            f"what is left of {first} grows with the speed, from {still:.2g} "
            f"{channel.display_unit} at rest to {moving:.2g} {channel.display_unit} in the fastest "
            f"tenth, as readings do that are {1e3 * found.sd_s:.2g} ms rms off their time stamps: "
            "the sensor may have a slower clock of its own, or the stamps be those of a busy "
            "computer",
            f"log the time at which the sensor took each reading of {first}, or let one timer "
            "trigger both channels",
        ),
    )
