"""What becomes of a verdict and of names when more is known than the search knew.

The only place that sets a verdict anew: what is told of it is in `report`.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from softid.diagnosis_results import Alternative, Cause, Diagnosis, Doubt, Verdict
from softid.effects.base import Effect


def as_unknown(answer: Diagnosis) -> Diagnosis:
    """The diagnosis of a misfit that no cause accounts for.

    Parameters
    ----------
    answer
        The diagnosis; its causes, if it has any, keep their names.
    """
    return replace(answer, verdict=Verdict.UNKNOWN)


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
