"""The input between its samples once more, when a first cause is known.

A misfit of the base decides wrongly whether a jump was held: a late motion asks for a late input.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from softid.diagnosis.candidates import Candidate, advance
from softid.fitters.problem import Problem
from softid.identification.held_input import BETTER_BY, held
from softid.intersample import Intersample, jumps
from softid.log import Log, LogSet

LAP = 15
"""Evaluations from the optimum of one reading to that of the other."""


def is_open(logs: LogSet) -> bool:
    """Whether an input jumps, and none of the logs says what it does between samples."""
    return all(log.intersample is None for log in logs) and any(
        jumps(log.channels[log.input].values).size for log in logs
    )


def better_reading(candidate: Candidate, sigma: Mapping[str, float]) -> Intersample | None:
    """The other reading of the input where it explains the logs better with the same effects.

    Parameters
    ----------
    candidate
        A model with its first cause, at its optimum.
    sigma
        Weight of each output channel.

    Returns
    -------
    str or None
        ``"held"`` or ``"straight"``; None where the reading of the candidate stays.
    """
    problem = candidate.problem
    other: Intersample = "straight" if problem.logs[0].intersample == "held" else "held"
    logs = [replace(log, intersample=other) for log in problem.logs]
    changed = Problem(problem.model, problem.parameters, logs)
    if changed.size != problem.size:
        return None
    begin = replace(candidate.minimum, damping=None)
    refitted = advance(replace(candidate, problem=changed, minimum=begin), sigma, LAP)
    fall = problem.n_samples * float(np.log(candidate.squares / refitted.squares))
    return other if fall > BETTER_BY else None


def read_as(logs: Sequence[Log], reading: Intersample) -> tuple[Log, ...]:
    """The logs with a declared reading of the input; a held one is told."""
    if reading == "held" and logs:
        return held(logs)
    return tuple(replace(log, intersample=reading) for log in logs)
