"""A diagnosis as the short paragraph that a colleague in the laboratory would write."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from softid.diagnosis.report.ambiguity import (
    is_linear,
    remedy_of_disturbance,
    what_next,
    with_reasons,
)
from softid.diagnosis.report.cause_texts import all_in_one, paragraphs_of
from softid.diagnosis.report.descriptions import described, outdone
from softid.diagnosis.report.error_texts import ErrorTexts, judged_by_blocks
from softid.diagnosis.report.issues import BEGUN_ANEW
from softid.diagnosis.report.phrases import given_up
from softid.diagnosis.report.remarks import Remarks
from softid.diagnosis.report.several_elements import SEVERAL_ELEMENTS
from softid.diagnosis.report.timing import UNCERTAIN_TIMES
from softid.diagnosis.report.unlisted_texts import UNLISTED_LAW
from softid.diagnosis.report.what_is_left import WhatIsLeft
from softid.diagnosis.searches.fitted_together import NOT_TOGETHER, TOLD_TOGETHER
from softid.diagnosis_results import Diagnosis, Verdict, dropped_from
from softid.sentences import sentence


def write_summary(found: Diagnosis, held: frozenset[str] = frozenset()) -> Diagnosis:
    """The diagnosis with its paragraph, what to record next, and why ties are ties.

    Parameters
    ----------
    found
        A diagnosis in numbers; words that it has already stay, but for the paragraph.
    held
        Experiments that the fitted logs hold, which are not advised again; from `held_experiments`.
    """
    linear = is_linear(found.base)
    alternatives = with_reasons(found, held)
    following = (
        found.next_experiment
        or remedy_of_disturbance(found)
        or _remedy_of(found, SEVERAL_ELEMENTS)
        or _remedy_of(found, BEGUN_ANEW)
        or _remedy_of(found, TOLD_TOGETHER)
        or _remedy_of(found, NOT_TOGETHER)
        or what_next(
            found.verdict,
            alternatives=alternatives,
            remainder=found.remainder,
            laws=(*found.causes, *found.descriptive),
            linear=linear,
            in_blocks=judged_by_blocks(found.gains),
            held=held,
        )
        or _remedy_of(found, UNCERTAIN_TIMES)
    )
    told = replace(found, alternatives=alternatives, next_experiment=following)
    return replace(told, summary=summarise(told, Remarks.of(told)))


def _remedy_of(found: Diagnosis, code: str) -> str | None:
    """What to do about a remark, where it was made."""
    return next((issue.remedy for issue in found.issues if issue.code == code), None)


def summarise(found: Diagnosis, remarks: Remarks) -> str:
    """What is wrong, by how much, why we think so, what it could be confused with, what to do next.

    Parameters
    ----------
    found
        A diagnosis with the reasons of its ties and what to record next.
    remarks
        Those that belong into the paragraph.

    Returns
    -------
    str
        A few plain sentences, numbers in the units of the logs. Of several causes the first
        paragraph tells the whole, one each follows, and the last says what to do.
    """
    dropped = dropped_from(found)
    differs = bool(remarks.held_out_changes)
    teller = ErrorTexts(found.base, found.gains, found.gain_ci95, dropped, differs=differs)
    left = WhatIsLeft(
        teller,
        found.remainder,
        found.alternatives,
        is_told=remarks.say_what_is_left,
        has_line=remarks.has_line,
        law=remarks.law_beside,
    )
    opening = teller.misfit(
        is_extended=bool(found.causes or found.descriptive),
        is_adequate=found.verdict is Verdict.ADEQUATE,
    )
    told = [opening, given_up(dropped), *map(sentence, remarks.seen)]
    each: list[str] = []
    if found.verdict is Verdict.ADEQUATE:
        told += _without_misfit(left, remarks)
    elif found.verdict is Verdict.UNKNOWN:
        told += _without_name(found, left, remarks)
    else:
        each = paragraphs_of(
            teller,
            found.causes,
            found.alternatives,
            found.evidence,
            found.descriptive,
            found.remainder,
        )
        told += _with_names(found, each, left, remarks)
    told += map(sentence, (*remarks.assumed, *remarks.marks))
    told += [] if remarks.changes else map(sentence, remarks.refused)
    if found.verdict is Verdict.ADEQUATE and not found.next_experiment and not remarks.marks:
        told.append(teller.nothing_to_mend(found.remainder))
    whole, advice = " ".join(filter(None, told)), " ".join(_advice(found, remarks))
    return "\n\n".join((whole, *each, advice)) if len(each) > 1 else f"{whole} {advice}".rstrip()


def _without_misfit(left: WhatIsLeft, remarks: Remarks) -> list[str]:
    """What is said of an adequate model."""
    return [sentence(remarks.instead)] if remarks.instead else left.by_adequate(remarks.refused)


def _without_name(found: Diagnosis, left: WhatIsLeft, remarks: Remarks) -> list[str]:
    """What is said of a misfit that no cause is named for."""
    changes = [sentence(change) for change in remarks.changes]
    if found.descriptive and not found.remainder.structured and _has_law(found):
        changes += left.beside_laws(found.descriptive)
    if changes:
        changes += map(sentence, remarks.laws)
    told = changes or left.by_unknown(found.descriptive or found.causes, remarks.laws)
    return [*told, *map(sentence, remarks.held_out_changes)]


def _has_law(found: Diagnosis) -> bool:
    """Whether a law in no catalogue accounts for the misfit."""
    return any(issue.code == UNLISTED_LAW for issue in found.issues)


def _with_names(
    found: Diagnosis, each: Sequence[str], left: WhatIsLeft, remarks: Remarks
) -> list[str]:
    """What is said of causes, of which ``each`` has a paragraph, and of what they leave."""
    causes, descriptive = found.causes, found.descriptive
    told = [all_in_one(causes, found.alternatives)] if len(causes) > 1 else [*each]
    told += map(sentence, remarks.joined)
    if descriptive:
        told.append(outdone(descriptive) if remarks.elements else described(descriptive, causes))
    told.append(left.teller.mended((*causes, *descriptive)))
    is_partial = found.verdict is Verdict.PARTIAL and not descriptive
    is_partial = is_partial or found.remainder.leaves_something
    instead = sentence(remarks.instead) if remarks.instead else ""
    told += left.by_partial() if is_partial else left.by_named(instead)
    told += map(sentence, remarks.elements)  # of which nothing is in the errors that were told
    told += map(sentence, remarks.held_out_changes)
    return told


def _advice(found: Diagnosis, remarks: Remarks) -> list[str]:
    """What to record next, what to do to the hardware, and where to look."""
    told = [f"Next: {found.next_experiment.rstrip('.')}."] if found.next_experiment else []
    is_unknown = found.verdict is Verdict.UNKNOWN
    tied = {name for tie in found.alternatives for name in tie.effects}
    sure = [cause for cause in found.causes if cause.effect not in tied and cause.remedy]
    remedies = [cause.remedy for cause in sure if not cause.remedy.startswith("none")]
    if remedies and not is_unknown:
        told.append(f"In hardware: {'; '.join(dict.fromkeys(remedies))}.")
    if is_unknown and found.remainder.structured and not remarks.laws:
        told.append("Look at the plots of what is left against position, speed, input and time.")
    return told
