"""An output that does not answer to the input, in words."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.verdict.no_response import NoResponse
from softid.diagnosis_results import Diagnosis
from softid.errors import Issue
from softid.sentences import listed

NO_RESPONSE = "no-response"
"""Code of the remark that an output does not answer to the input."""

COURSES = ("a constant", "a straight line in time")
"""What an output may follow that answers to no input, by the order of its polynomial."""


def with_no_response(answer: Diagnosis, found: NoResponse, final: Candidate) -> Diagnosis:
    """The diagnosis that first of all says why it is unknown.

    Parameters
    ----------
    answer
        The diagnosis.
    found
        How it is seen that the output does not answer.
    final
        The model with all that is named or described.
    """
    problem = final.problem
    first, driving = problem.outputs[0], problem.logs[0].channels[problem.logs[0].input]
    if found.order is not None:
        moves = np.ptp(np.concatenate([segment.input for segment in problem.segments]))
        told = (
            f"{first} does not visibly answer to {driving.name}, though that moves over "
            f"{moves * driving.display_factor:.3g} {driving.display_unit}: {COURSES[found.order]} "
            f"explains {first} as well as the model does"
        )
    else:
        are = "is" if len(found.still) == 1 else "are"
        told = (
            f"in {listed(found.still)}, which {are} held out, {first} "
            f"stays still where the model moves: it does not visibly answer to {driving.name} there"
        )
    remedy = f"check that the sensor of {first} works, and that the right columns are read"
    issue = Issue(NO_RESPONSE, "warning", told, remedy)
    return replace(answer, next_experiment=issue.remedy, issues=(issue, *answer.issues))
