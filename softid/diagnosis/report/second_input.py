"""A misfit that goes with another channel, in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from softid.diagnosis.report.phrases import percent
from softid.diagnosis_results import Diagnosis
from softid.errors import Issue
from softid.quality.wording import NAMED
from softid.sentences import listed

FOLLOWS_SECOND_INPUT = "follows-second-input"
"""Code of the remark that a misfit goes with another channel."""


def with_second_input(answer: Diagnosis, told: Mapping[str, float], driving: str) -> Diagnosis:
    """The diagnosis that says of what the base leaves that it goes with another input.

    Parameters
    ----------
    answer
        The diagnosis.
    told
        Names of the channels → share of the misfit that follows each; one at least.
    driving
        The input.
    """
    issue = _issue(told, driving)
    return replace(
        answer,
        alternatives=(),  # a tie of descriptions says nothing
        issues=(*answer.issues, issue),
        next_experiment=issue.remedy,
    )


def _issue(told: Mapping[str, float], driving: str) -> Issue:
    """That the misfit follows some channels, the one that predicts most of it first."""
    names = sorted(told, key=lambda name: -told[name])
    few = listed(names[:NAMED])
    moves, is_held = ("moves", "is held") if len(names) == 1 else ("move", "are held")
    return Issue(
        FOLLOWS_SECOND_INPUT,
        "warning",
        f"what is missing follows {few}, which {moves} as an input does and not with {driving}: "
        f"through lags {names[0]} alone accounts for {percent(told[names[0]])} of what the model "
        "leaves, so that a second input may be all that is missing",
        f"record logs in which {few} {is_held}, or {moves} with {driving}",
    )
