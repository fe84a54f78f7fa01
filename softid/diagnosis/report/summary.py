"""A diagnosis as the short paragraph that a colleague in the laboratory would write."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from softid.diagnosis.changes.zero_jumps import ZERO_JUMP
from softid.diagnosis.logs.permanent_set import RESIDUAL_SET
from softid.diagnosis.report.ambiguity import (
    is_linear,
    remedy_of_disturbance,
    what_next,
    with_reasons,
)
from softid.diagnosis.report.cause_texts import all_in_one, paragraphs_of
from softid.diagnosis.report.changes import HELD_OUT_CHANGE
from softid.diagnosis.report.clipped_input import CLIPPED_INPUT
from softid.diagnosis.report.descriptions import described, outdone
from softid.diagnosis.report.error_texts import ErrorTexts, judged_by_blocks
from softid.diagnosis.report.issues import NEGLIGIBLE_MISFIT, REFUSED, UNSURE
from softid.diagnosis.report.joint_causes import ONE_CAUSE
from softid.diagnosis.report.motion_shown import NEARLY_STATIC, ONE_FREQUENCY
from softid.diagnosis.report.no_response import NO_RESPONSE
from softid.diagnosis.report.open_intersample import OPEN_INTERSAMPLE
from softid.diagnosis.report.other_explanations import (
    EVENTS,
    LAW_BESIDE,
    LIKE_UNLISTED_LAW,
    OF_REST,
    ONE_STEP,
    UNLISTED_LAW,
    WHAT_IS_LEFT,
)
from softid.diagnosis.report.other_model import UNASKED_MODEL
from softid.diagnosis.report.phrases import (
    given_up,
    sentence,
)
from softid.diagnosis.report.rounding import OF_RECORDED_INPUT
from softid.diagnosis.report.several_elements import SEVERAL_ELEMENTS
from softid.diagnosis.report.what_is_left import WhatIsLeft
from softid.diagnosis.residual.disturbances import CODES, SPECTRAL_LINE
from softid.diagnosis.smoothed_record import SMOOTHED_RECORD
from softid.diagnosis_results import (
    Alternative,
    Cause,
    Diagnosis,
    Evidence,
    Gain,
    Remainder,
    Verdict,
    dropped_from,
)
from softid.quality.causality import LEADING_OUTPUT
from softid.results import FitResult

WHAT_IT_IS = (*EVENTS, UNLISTED_LAW, ONE_STEP, NO_RESPONSE, UNASKED_MODEL)
"""Codes of remarks that say what a misfit is for which no cause is named."""

ALWAYS_SEEN = (ZERO_JUMP, LEADING_OUTPUT, ONE_FREQUENCY, OPEN_INTERSAMPLE)
"""Codes of remarks on the logs that belong into every paragraph."""

MARKS = (*CODES, LIKE_UNLISTED_LAW, *OF_REST, CLIPPED_INPUT, *OF_RECORDED_INPUT)
"""Codes of remarks on what is left, which say what it is or may be."""

INSTEAD = (NEGLIGIBLE_MISFIT, SMOOTHED_RECORD)
"""Codes of remarks that stand for what is said of noise: a misfit is too small to be looked into,
or the record was smoothed."""

LEAVE_A_SET = ("creep", "relaxation", "hysteresis", "softening", "sensor_warmup")
"""Effects after which a motion does not return to where it began, or not soon."""


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
        or _to_see_elements(found)
        or what_next(
            found.verdict,
            alternatives=alternatives,
            remainder=found.remainder,
            laws=(*found.causes, *found.descriptive),
            linear=linear,
            in_blocks=judged_by_blocks(found.gains),
            held=held,
        )
    )
    beside = [i for i in found.issues if i.code == LAW_BESIDE and found.remainder.structured]
    is_unknown = found.verdict is Verdict.UNKNOWN
    laws = [i for i in found.issues if i.code == LIKE_UNLISTED_LAW and is_unknown]
    summary = summarise(
        found.verdict,
        base=found.base,
        causes=found.causes,
        descriptive=found.descriptive,
        alternatives=alternatives,
        remainder=found.remainder,
        gains=found.gains,
        evidence=found.evidence,
        next_experiment=following,
        gain_ci95=found.gain_ci95,
        marks=[i.message for i in found.issues if i.code in MARKS and i not in (*laws, *beside)],
        law_beside=beside[0].message.removeprefix(WHAT_IS_LEFT) if beside else "",
        laws=[i.message for i in laws],
        refused=[i.message for i in found.issues if i.code in (REFUSED, UNSURE)],
        changes=[i.message for i in found.issues if i.code in WHAT_IT_IS],
        seen=_seen_beside(found),
        held_out_changes=[i.message for i in found.issues if i.code == HELD_OUT_CHANGE],
        joined=[i.message for i in found.issues if i.code == ONE_CAUSE],
        elements=[i.message for i in found.issues if i.code == SEVERAL_ELEMENTS],
        dropped=dropped_from(found),
        has_line=any(i.code == SPECTRAL_LINE for i in found.issues),
        instead=next((i.message for i in found.issues if i.code in INSTEAD), ""),
    )
    return replace(found, summary=summary, alternatives=alternatives, next_experiment=following)


def _to_see_elements(found: Diagnosis) -> str | None:
    """What shows the elements of a cause, where it has several."""
    return next((i.remedy for i in found.issues if i.code == SEVERAL_ELEMENTS), None)


def _seen_beside(found: Diagnosis) -> list[str]:
    """The remarks on the logs that belong into the paragraph.

    That a first cycle leaves a set is told of one log, and not where a cause that does so is named.
    """
    named = {name for tie in found.alternatives for name in tie.effects}
    named |= {cause.effect for cause in found.causes}
    codes: tuple[str, ...] = ALWAYS_SEEN
    if found.verdict in (Verdict.UNKNOWN, Verdict.PARTIAL):
        codes = (*ALWAYS_SEEN, NEARLY_STATIC)
        if named.isdisjoint(LEAVE_A_SET):
            codes = (*codes, RESIDUAL_SET)
    seen = [issue for issue in found.issues if issue.code in codes]
    sets = [issue for issue in seen if issue.code == RESIDUAL_SET]
    return [issue.message for issue in seen if issue not in sets[1:]]


def summarise(
    verdict: Verdict,
    *,
    base: FitResult,
    causes: Sequence[Cause],
    descriptive: Sequence[Cause] = (),
    alternatives: Sequence[Alternative] = (),
    remainder: Remainder,
    gains: Sequence[Gain],
    evidence: Sequence[Evidence] = (),
    next_experiment: str | None = None,
    gain_ci95: tuple[float, float] | None = None,
    marks: Sequence[str] = (),
    refused: Sequence[str] = (),
    changes: Sequence[str] = (),
    laws: Sequence[str] = (),
    law_beside: str = "",
    held_out_changes: Sequence[str] = (),
    seen: Sequence[str] = (),
    joined: Sequence[str] = (),
    elements: Sequence[str] = (),
    dropped: Sequence[str] = (),
    has_line: bool = False,
    instead: str = "",
) -> str:
    """What is wrong, by how much, why we think so, what it could be confused with, what to do next.

    Parameters
    ----------
    verdict
        The answer.
    base
        The fit without effects, which tells model, outputs and units.
    causes, descriptive, alternatives, remainder, gains, evidence, next_experiment, gain_ci95
        As in `Diagnosis`.
    marks, refused
        The other remarks of `MARKS`, and what `refusal_issues` or `unsure_issues` found.
    changes
        What changed within the fitted logs or between them, or a law in no catalogue, which is the
        misfit then.
    laws
        A law in no catalogue that accounts for most of a misfit without a name.
    law_beside
        What is done by what is left, in words, where a law in no catalogue takes it away.
    held_out_changes
        How what is held out differs from them.
    seen
        What the logs show by themselves, without a model.
    joined
        That two causes may be one.
    elements
        That one has several elements, which explain more than the descriptions do.
    dropped
        Parameters of the base that the extended model does without.
    has_line
        Whether one of the marks is a steady line.
    instead
        The remark of `INSTEAD`; empty where there is none.

    Returns
    -------
    str
        A few plain sentences, numbers in the units of the logs. Of several causes the first
        paragraph tells the whole, one each follows, and the last says what to do.
    """
    teller = ErrorTexts(base, gains, gain_ci95, dropped, differs=bool(held_out_changes))
    opening = teller.misfit(is_extended=bool(causes or descriptive))
    told = [opening, given_up(dropped), *(sentence(remark) for remark in seen)]
    each: list[str] = []
    is_told = bool(marks or elements or law_beside)
    left = WhatIsLeft(teller, remainder, alternatives, is_told, has_line, law_beside)
    if verdict is Verdict.ADEQUATE:
        told += [sentence(instead)] if instead else left.by_adequate(refused)
    elif verdict is Verdict.UNKNOWN:
        told += map(sentence, changes)
        told += [] if changes else left.by_unknown(descriptive or causes, laws)
        told += map(sentence, held_out_changes)
    else:
        each = paragraphs_of(teller, causes, alternatives, evidence, descriptive, remainder)
        told += [all_in_one(causes, alternatives)] if len(causes) > 1 else each
        told += map(sentence, joined)
        if descriptive:
            told.append(outdone(descriptive) if elements else described(descriptive, causes))
        told.append(teller.mended((*causes, *descriptive)))
        is_partial = verdict is Verdict.PARTIAL or remainder.structured
        told += left.by_partial() if is_partial else left.by_named()
        told += map(sentence, elements)  # of which nothing is in the errors that were told
        told += map(sentence, held_out_changes)
    told += [sentence(mark) for mark in (*marks, *(() if changes else refused))]
    if verdict is Verdict.ADEQUATE and not next_experiment and not marks:
        told.append(teller.nothing_to_mend(remainder))
    looks_at_plots = verdict is Verdict.UNKNOWN and remainder.structured and not laws
    advice = " ".join(_next(verdict, causes, alternatives, next_experiment, looks_at_plots))
    whole = " ".join(filter(None, told))
    return "\n\n".join((whole, *each, advice)) if len(each) > 1 else f"{whole} {advice}".rstrip()


def _next(
    verdict: Verdict,
    causes: Sequence[Cause],
    alternatives: Sequence[Alternative],
    next_experiment: str | None,
    looks_at_plots: bool,
) -> list[str]:
    told = [f"Next: {next_experiment.rstrip('.')}."] if next_experiment else []
    tied = {name for a in alternatives for name in a.effects}
    sure = [cause for cause in causes if cause.effect not in tied and cause.remedy]
    remedies = [cause.remedy for cause in sure if not cause.remedy.startswith("none")]
    if remedies and verdict is not Verdict.UNKNOWN:
        told.append(f"In hardware: {'; '.join(dict.fromkeys(remedies))}.")
    if looks_at_plots:
        told.append("Look at the plots of what is left against position, speed, input and time.")
    return told
