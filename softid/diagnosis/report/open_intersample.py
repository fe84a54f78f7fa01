"""Parameters that hang on what a command does between its samples, where the logs do not tell."""

from __future__ import annotations

from dataclasses import replace

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.base.intersample_selection import (
    explained_alike,
    is_measured,
)
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.parameter_doubts import less_sure, other_values, outside_intervals
from softid.diagnosis_results import Diagnosis
from softid.errors import Issue
from softid.identification.intersample_choice import BEHAVIOUR_WORDS, choices_of

OPEN_INTERSAMPLE = "open-reading"
"""Code of the remark that parameters hang on what a command does between its samples."""


def with_open_intersample(found: Diagnosis, final: Candidate, base: BaseFit) -> Diagnosis:
    """The diagnosis with what another intersample behaviour would make of its parameters.

    A command that is held at every sample is half an interval later than one that goes straight,
    and inertia and damping make up for that. Where the logs do not tell, an interval holds for the
    behaviour that was taken only: what leaves it with another one is known less well than it says.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    final
        Its model.
    base
        What that extends.
    """
    logs = final.problem.logs
    if not base.is_intersample_open or is_measured(logs):
        return found
    told = (found.extended or found.base).parameters
    now = logs[0].effective_intersample
    others = [other for other in choices_of(logs) if other in BEHAVIOUR_WORDS and other != now]
    for intersample in others:
        refitted = explained_alike(final, base.sigma, intersample)
        if refitted is None:
            continue
        moved = outside_intervals(told, refitted.parameters)
        if not moved:
            continue
        way = f"{logs[0].input} {BEHAVIOUR_WORDS[intersample]}"
        found = less_sure(
            found,
            moved,
            f"it is another one with {way}, which explains these logs as well",
            f"declare it with --intersample {intersample}, or as it is",
        )
        issue = Issue(
            OPEN_INTERSAMPLE,
            "warning",
            f"{way} explains these logs as well, and makes {other_values(told, moved)}",
            f"declare it with --intersample {intersample}, or as it is",
        )
        found = replace(found, issues=(*found.issues, issue))
    return found
