"""What is said of causes: all of them in one sentence, and each in a paragraph."""

from __future__ import annotations

import math
from collections.abc import Sequence

from softid.diagnosis.report.ambiguity import is_linear, is_linear_beside, told_as_tied
from softid.diagnosis.report.error_texts import ErrorTexts
from softid.diagnosis.report.evidence_text import evidence_text
from softid.diagnosis.report.phrases import named_whole, title_of, told_apart, unsteady, values_of
from softid.diagnosis.verdict.equivalence import EquivalenceClass, classes_of
from softid.diagnosis.verdict.unlisted_names import UNLISTED
from softid.diagnosis_results import Alternative, Cause, Evidence, Remainder, cause_before
from softid.sentences import listed, lowered

COUNTS = {2: "Two", 3: "Three", 4: "Four", 5: "Five", 6: "Six"}
"""Numbers of causes as a sentence begins with them."""


def all_in_one(causes: Sequence[Cause], alternatives: Sequence[Alternative]) -> str:
    """Several causes in one sentence, those of a tie with what may stand in their place.

    Parameters
    ----------
    causes, alternatives
        As in `Diagnosis`.
    """
    count = COUNTS.get(len(causes), str(len(causes)))
    told = [f"{lowered(c.title)}{_in_its_place(c, alternatives)}" for c in causes]
    return f"{count} causes act together: {listed(told)}."


def _in_its_place(cause: Cause, alternatives: Sequence[Alternative]) -> str:
    tie = _tie_of(cause, alternatives)
    if tie is None:
        return ""
    others = [key for key in tie.keys if key.split(".")[0] != cause.effect]
    if len(others) == 1 and others[0] in UNLISTED:
        return " (or a law in no catalogue)"  # which its own paragraph describes
    if len(others) == 1:
        return f" (or {title_of(others[0])})"
    return f" (or one of {len(others)} others)"


def _tie_of(cause: Cause, alternatives: Sequence[Alternative]) -> Alternative | None:
    return next((tie for tie in alternatives if cause.effect in tie.effects), None)


def paragraphs_of(
    teller: ErrorTexts,
    causes: Sequence[Cause],
    alternatives: Sequence[Alternative],
    evidence: Sequence[Evidence],
    descriptive: Sequence[Cause],
    remainder: Remainder,
) -> list[str]:
    """What each cause is, its size, why it is believed and what it could be confused with.

    Parameters
    ----------
    teller
        Tells errors in the unit of the output.
    causes, alternatives, evidence, descriptive, remainder
        As in `Diagnosis`.

    Returns
    -------
    list of str
        One paragraph for every cause.
    """
    leaves_noise = not (remainder.structured or remainder.open_jumps)
    told, earlier = [], list[Alternative]()
    for number, cause in enumerate(causes, start=1):
        opening = "The cause:" if len(causes) == 1 else f"Cause {number}:"
        tie = _tie_of(cause, alternatives)
        own = tie.effects if tie else (cause.effect,)
        linear = is_linear_beside((*causes, *descriptive), own, linear=is_linear(teller.base))
        values = values_of(cause.parameters)
        if tie is None:
            named = named_whole(cause, linear=linear)
            what = f"{named} ({cause.key}) with {values}. {cause.meaning}"
            inseparable = classes_of([cause.effect], linear=linear)
        else:
            tied = told_as_tied(
                tie, cause.title, linear=linear, earlier=earlier, leaves_noise=leaves_noise
            )
            earlier.append(tie)
            what = f"{tied} would have {values}."
            inseparable = classes_of(tie.effects)
        apart = [_inseparable(known, what) for known in inseparable]
        alone = len(causes) == 1 and not (descriptive or teller.dropped) and bool(teller.rows)
        errors = "" if alone else _errors(teller, cause, descriptive)
        why = evidence_text(teller, cause, tie, evidence, errors)
        varies = "" if tie else unsteady(cause, "its size")  # that the law is in doubt is told
        told.append(" ".join(filter(None, (opening, what, *apart, why, varies))))
    return told


def _inseparable(known: EquivalenceClass, told: str) -> str:
    """That no log splits a class, and why, or its members where these are not named together."""
    no_log = "No log of pressure and motion tells"
    if listed(known.members, last=" or ") in told:
        return f"{no_log} which: {lowered(known.why)}"
    return f"{no_log} {told_apart(known.members)}."


def _errors(teller: ErrorTexts, cause: Cause, descriptive: Sequence[Cause]) -> str:
    """The error before and after, and which description brought it to where the cause begins."""
    errors = (cause.holdout_rmse_before, cause.holdout_rmse_after)
    if not all(map(math.isfinite, errors)):
        return ""
    before, after = map(teller.size, errors)
    earlier = cause_before(cause, descriptive)
    there = f", where {lowered(earlier.title)} has brought it," if earlier else ""
    how = "and" if errors[1] <= errors[0] else "though by itself"
    return f", {how} the held-out error goes from {before}{there} to {after}"
