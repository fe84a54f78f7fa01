"""What the descriptions beside some causes are, and why they are no more."""

from __future__ import annotations

import math
from collections.abc import Sequence

from softid.diagnosis.report.phrases import doubts_about
from softid.diagnosis_results import Cause, Doubt
from softid.sentences import listed, lowered

LARGE_PART = 0.85
"""What leaves less than this share of the error on what is held out is no small part of it."""

LEAST_EVIDENCE = 0.3
"""A description is no small part of the misfit where the evidence for it is more than this share of
that for any cause."""


def described(descriptive: Sequence[Cause], causes: Sequence[Cause]) -> str:
    """What the descriptions beside some causes are, and why they are no more.

    Parameters
    ----------
    descriptive, causes
        As in `Diagnosis`.
    """
    names = listed([lowered(cause.title) for cause in descriptive])
    verb = "describes" if len(descriptive) == 1 else "describe"
    fewest = min((cause.delta_bic for cause in causes), default=math.inf)
    least = min((_held_out_fall(cause) for cause in causes), default=math.inf)
    occur = all(c.doubt is not Doubt.DOES_NOT_OCCUR for c in descriptive)
    small = all(c.holdout_rmse_after > LARGE_PART * c.holdout_rmse_before for c in descriptive)
    less = all(
        c.delta_bic < LEAST_EVIDENCE * fewest and _held_out_fall(c) < least for c in descriptive
    )
    if occur and small and less:
        return f"Besides, {names} {verb} a part of the rest, too small to be named as a cause."
    told = f"Besides, {names} {verb} a part of the misfit, with a law that is not sure enough"
    return " ".join((f"{told} for a name.", *doubts_about(descriptive)))


def outdone(descriptive: Sequence[Cause]) -> str:
    """That descriptions are no more, where a second element of a cause explains more.

    Parameters
    ----------
    descriptive
        As in `Diagnosis`.
    """
    names = listed([lowered(cause.title) for cause in descriptive])
    verb = "describes" if len(descriptive) == 1 else "describe"
    better = "a second element of the cause does so better"
    return f"Besides, {names} {verb} a part of the rest, but {better}."


def _held_out_fall(cause: Cause) -> float:
    """By how much the mean square error on what is held out falls."""
    return cause.holdout_rmse_before**2 - cause.holdout_rmse_after**2
