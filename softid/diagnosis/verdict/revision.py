"""What becomes of a verdict and of names when more is known than the search knew.

The only place that sets a verdict anew: what is told of it is in `report`.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from softid.diagnosis.verdict.naming import DOUBTS_OF_BEING
from softid.diagnosis_results import Alternative, Cause, Diagnosis, Doubt, Remainder, Verdict
from softid.effects.base import Effect

CLEAR_PART = 0.05
"""Share of all that a chain takes away of the held-out squares from which on a description in it
takes away a clear part; a judgement."""


def as_unknown(answer: Diagnosis) -> Diagnosis:
    """The diagnosis of a misfit that no cause accounts for.

    Parameters
    ----------
    answer
        The diagnosis; its causes, if it has any, keep their names.
    """
    return replace(answer, verdict=Verdict.UNKNOWN)


def as_named_whole(answer: Diagnosis, left: Remainder) -> Diagnosis:
    """The diagnosis whose causes are all that is missing.

    Parameters
    ----------
    answer
        The diagnosis, of causes in part.
    left
        What they leave where what they miss on what is held out is explained otherwise.
    """
    return replace(answer, verdict=Verdict.NAMED, remainder=left)


def with_names_withdrawn(answer: Diagnosis) -> Diagnosis:
    """The diagnosis whose causes are no more than descriptions.

    Parameters
    ----------
    answer
        The diagnosis.
    """
    described = (*answer.causes, *answer.descriptive)
    return replace(as_unknown(answer), causes=(), descriptive=described)


def is_outweighed_by_events(answer: Diagnosis) -> bool:
    """Whether something that begins at a moment would take the names of the causes away.

    It is no cause that goes on throughout, so that causes which leave more than noise stand for it;
    but what is slow behind a single step would begin at a moment, too.

    Parameters
    ----------
    answer
        The diagnosis.
    """
    is_open = bool(answer.causes) and answer.remainder.structured
    return is_open and not any(cause.doubt is Doubt.ONE_STEP for cause in answer.descriptive)


def with_described_part(answer: Diagnosis) -> Diagnosis:
    """The diagnosis; one in part, where a description takes away a clear part beside the names.

    Something acts there of which its numbers leave open what it is. Where they leave open whether
    it is there at all, the names stand for everything.

    Parameters
    ----------
    answer
        The diagnosis.
    """
    if answer.verdict is not Verdict.NAMED:
        return answer
    whole = sum(_taken_by(cause) for cause in (*answer.causes, *answer.descriptive))
    acting = [cause for cause in answer.descriptive if cause.doubt not in DOUBTS_OF_BEING]
    if any(_taken_by(cause) > CLEAR_PART * whole for cause in acting):
        return replace(answer, verdict=Verdict.PARTIAL)
    return answer


def _taken_by(cause: Cause) -> float:
    """Mean square of the held-out error that a cause takes away where it stands in the chain."""
    return cause.holdout_rmse_before**2 - cause.holdout_rmse_after**2


def exchanged_causes(
    answer: Diagnosis, theirs: Sequence[Effect]
) -> tuple[list[Cause], list[Effect]]:
    """The causes that another model does without, and those that it has in their place.

    No name is sure that another model does not need. Both are empty where one of them is, or where
    nothing is named without a rest.

    Parameters
    ----------
    answer
        The diagnosis, over the model that softid has chosen.
    theirs
        Causes of another model, with which it explains the logs as well.
    """
    if answer.verdict not in (Verdict.NAMED, Verdict.AMBIGUOUS):
        return [], []
    names, known = {e.name for e in theirs}, {cause.effect for cause in answer.causes}
    added = [effect for effect in theirs if effect.name not in known]
    lost = [cause for cause in answer.causes if cause.effect not in names]
    return (lost, added) if added and lost else ([], [])


def with_ties(answer: Diagnosis, ties: Sequence[Alternative], tied: Collection[Cause]) -> Diagnosis:
    """The diagnosis with causes in new ties, which take the place of those that they were in.

    Parameters
    ----------
    answer
        The diagnosis.
    ties
        The new ties; without any the diagnosis stays as it is.
    tied
        The causes in them.
    """
    if not ties:
        return answer
    names = {cause.effect for cause in tied}
    kept = tuple(tie for tie in answer.alternatives if names.isdisjoint(tie.effects))
    return replace(answer, verdict=Verdict.AMBIGUOUS, alternatives=(*kept, *ties))
