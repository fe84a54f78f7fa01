"""What a fit has to find, in words for messages: parameters, sensor zeros and initial states."""

from __future__ import annotations

from softid.fitters.problem import Problem

_START_WORDS = {"x": "the initial position", "v": "the initial velocity"}
"""States of a motion at its start, in words; others are an effect's, which they are called by."""


def unknown_names(problem: Problem) -> list[str]:
    """A name for every unknown, shape (U,), that a message can show."""
    names = [*problem.free, *[""] * (problem.size - len(problem.free))]
    if problem.zeros:
        for k, log in enumerate(problem.logs):
            for channel in problem.outputs:
                names[problem.zero_position(k, channel)] = f"the zero of {channel} in {log.name}"
    for k, segment in enumerate(problem.segments):
        alone = problem.owner.count(problem.owner[k]) == 1
        place = segment.log_name if alone else f"segment {segment.index + 1} of {segment.log_name}"
        states = problem.model.start_states
        for state, at in zip(states, problem.state_positions(k), strict=False):
            names[at] = f"{_START_WORDS.get(state, f'the initial state of {state}')} in {place}"
    return names
