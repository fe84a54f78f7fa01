"""A diagnosis as the short paragraph that a colleague in the laboratory would write."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from softid.diagnosis.changes.zero_jumps import ZERO_JUMP
from softid.diagnosis.logs.permanent_set import RESIDUAL_SET
from softid.diagnosis.report.ambiguity import (
    WORTH_DOUBTS,
    are_alike,
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
from softid.diagnosis.report.other_explanations import EVENTS, OF_REST, ONE_STEP, UNLISTED_LAW
from softid.diagnosis.report.other_model import UNASKED_MODEL
from softid.diagnosis.report.phrases import (
    VARIABLE_WORDS,
    doubt_about,
    given_up,
    listed,
    lowered,
    percent,
    percent_below,
    sentence,
    taken_by,
    title_of,
    titles_of,
)
from softid.diagnosis.report.rest_phrases import (
    BUT_A_LINE,
    PREDICTORS,
    known_noise,
    nature_of_rest,
    structure_of_rest,
    variables_left,
    what_is_unknown,
    what_it_may_be,
    with_open_moments,
)
from softid.diagnosis.report.rounding import OF_RECORDED_INPUT
from softid.diagnosis.report.several_elements import SEVERAL_ELEMENTS
from softid.diagnosis.residual.disturbances import CODES, SPECTRAL_LINE
from softid.diagnosis.smoothed_record import SMOOTHED_RECORD
from softid.diagnosis_results import (
    NOTABLE,
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

MARKS = (*CODES, *OF_REST, CLIPPED_INPUT, *OF_RECORDED_INPUT)
"""Codes of remarks on what is left, which say what it is or may be."""

INSTEAD = (NEGLIGIBLE_MISFIT, SMOOTHED_RECORD)
"""Codes of remarks that stand for what is said of noise: a misfit is too small to be looked into,
or the record was smoothed."""

NEXT_TO_NOTHING = 0.1
"""A description that takes away less of the misfit is not worth its name."""


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
        marks=[i.message for i in found.issues if i.code in MARKS],
        refused=[i.message for i in found.issues if i.code in (REFUSED, UNSURE)],
        changes=[i.message for i in found.issues if i.code in WHAT_IT_IS],
        seen=[i.message for i in found.issues if i.code in _seen_beside(found.verdict)],
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


def _seen_beside(verdict: Verdict) -> tuple[str, ...]:
    """Codes of the remarks on the logs that belong into the paragraph: a cause explains a set."""
    if verdict in (Verdict.UNKNOWN, Verdict.PARTIAL):
        return *ALWAYS_SEEN, NEARLY_STATIC, RESIDUAL_SET
    return ALWAYS_SEEN


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
        The remarks of `MARKS`, and what `refusal_issues` or `unsure_issues` found.
    changes
        What changed within the fitted logs or between them, or a law in no catalogue, which is the
        misfit then.
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
    teller = ErrorTexts(base, gains, gain_ci95, dropped)
    opening = teller.misfit(is_extended=bool(causes or descriptive))
    told = [opening, given_up(dropped), *(sentence(remark) for remark in seen)]
    each: list[str] = []
    if verdict is Verdict.ADEQUATE:
        told += (
            [sentence(instead)]
            if instead
            else _adequate(teller, remainder, refused, has_line=has_line)
        )
    elif verdict is Verdict.UNKNOWN:
        if changes:
            told += [sentence(change) for change in changes]
        else:
            told.append(what_is_unknown(remainder))
            tried = descriptive or causes
            told += _unknown(
                teller, tried, alternatives, remainder, is_told=bool(marks), has_line=has_line
            )
        told += [sentence(change) for change in held_out_changes]
    else:
        each = paragraphs_of(teller, causes, alternatives, evidence, descriptive, remainder)
        told += [all_in_one(causes, alternatives)] if len(causes) > 1 else each
        told += [sentence(remark) for remark in joined]
        if descriptive:
            told.append(outdone(descriptive) if elements else described(descriptive, causes))
        told += [sentence(remark) for remark in elements]
        told.append(teller.mended((*causes, *descriptive)))
        if verdict is Verdict.PARTIAL or remainder.structured:
            told += _partial(
                teller,
                remainder,
                is_tied=bool(alternatives),
                is_told=bool(marks or elements),
                has_line=has_line,
            )
        else:
            looks = "does not follow from the motion" if marks else nature_of_rest(remainder)
            told.append(f"What the fit leaves, {teller.size(remainder.rms)} rms, {looks}.")
            told.append(teller.more_held_out(remainder, is_tied=bool(alternatives)))
        told += [sentence(change) for change in held_out_changes]
    told += [sentence(mark) for mark in (*marks, *(() if changes else refused))]
    if verdict is Verdict.ADEQUATE and not next_experiment and not marks:
        told.append(teller.nothing_to_mend(remainder))
    advice = " ".join(_next(verdict, causes, alternatives, next_experiment, remainder))
    whole = " ".join(filter(None, told))
    return "\n\n".join((whole, *each, advice)) if len(each) > 1 else f"{whole} {advice}".rstrip()


def _adequate(
    teller: ErrorTexts, remainder: Remainder, refused: Sequence[str], *, has_line: bool
) -> list[str]:
    left = teller.size(remainder.rms)
    chance = "None of the effects tried explains more of it than chance would."
    if refused:
        chance = "None of the effects tried can be claimed."
    if remainder.colour_s is not None:
        return [
            chance,
            f"What is left, {left} rms on the fitted samples, "
            f"{nature_of_rest(remainder, has_line=has_line)}.",
        ]
    noise = (known_noise(remainder) or "noise") + (BUT_A_LINE if has_line else "")
    why = "it is no larger" if remainder.predictable else structure_of_rest(remainder)
    told = [
        chance,
        f"What is left, {left} rms on the fitted samples, looks like {noise}"
        f"{with_open_moments(remainder.open_jumps)}: {why}.",
    ]
    if not remainder.noise_is_known:
        told.append("No long rest shows the noise alone, so a slow misfit could hide in it.")
    return told


def _unknown(
    teller: ErrorTexts,
    tried: Sequence[Cause],
    alternatives: Sequence[Alternative],
    remainder: Remainder,
    *,
    is_told: bool,
    has_line: bool,
) -> list[str]:
    told = []
    if tried and remainder.explained_share < NEXT_TO_NOTHING:
        share = percent(remainder.explained_share)
        told.append(f"No effect takes away more than {share} of the misfit of the fitted samples.")
    elif tried:
        names = listed([lowered(cause.title) for cause in tried])
        takes = "takes" if len(tried) == 1 else "take"
        told.append(f"The best description, {names}, {takes} away {taken_by(remainder)}.")
        if remainder.explained_share >= WORTH_DOUBTS:
            told += map(doubt_about, tried)
            told += [_not_told_apart(tie) for tie in alternatives]
    if not remainder.structured:
        left = teller.size(remainder.rms)
        looks = nature_of_rest(remainder, has_line=has_line)
        told.append(f"What is left on the fitted samples, {left} rms, {looks}.")
        return [*told, teller.more_held_out(remainder)]
    return [*told, _left(teller, remainder, is_told=is_told)]


def _not_told_apart(tie: Alternative) -> str:
    first, *others = tie.keys
    rest = titles_of(others, last=" or ")
    if are_alike(tie):
        return f"These logs do not tell {title_of(first)} from {rest}."
    return (
        f"The lead of {title_of(first)} over {rest} is smaller than what all of them leave "
        "unexplained, so it does not say which."
    )


def _partial(
    teller: ErrorTexts, remainder: Remainder, *, is_tied: bool, is_told: bool, has_line: bool
) -> list[str]:
    """The share that is explained, and what is left where that is more than noise."""
    share = percent_below(remainder.explained_share, 1.0)
    explained = f"That is {share} of the misfit above the noise"
    if remainder.misses_held_out:
        explained += (
            f" on the fitted samples and {percent(remainder.held_out_share)} on those held out"
        )
    more = teller.more_held_out(remainder, is_tied=is_tied)
    if remainder.structured:
        if remainder.misses_held_out:
            return [f"{explained}.", _left(teller, remainder, is_told=is_told), more]
        if remainder.explained_share >= 1.0 and remainder.predictable:
            return [_left(teller, remainder, but="has no more power than the noise, yet ")]
        return [f"{explained}.", _left(teller, remainder, is_told=is_told)]
    left = teller.size(remainder.rms)
    nature = nature_of_rest(remainder, has_line=has_line)
    return [f"{explained}.", f"What is left on the fitted samples, {left} rms, {nature}.", more]


def _left(teller: ErrorTexts, remainder: Remainder, *, but: str = "", is_told: bool = False) -> str:
    """What is left, where that is more than noise, and what it may be unless that is told."""
    named = [VARIABLE_WORDS.get(name, name) for name in variables_left(remainder)]
    told = f"What is left, {teller.size(remainder.rms)} rms on the fitted samples, {but}"
    if remainder.predictable:
        told += f"is not noise: {structure_of_rest(remainder)}"
    elif remainder.is_a_line:
        told += nature_of_rest(remainder)
    elif remainder.structure_share > NOTABLE:
        share = percent(remainder.structure_share)
        told += (
            f"is larger than the noise; {share} of it follows from {PREDICTORS}, no more than "
            "chance would make of slow noise"
        )
    elif remainder.noise_is_known:
        told += "is larger than the noise"
        told += "" if is_told else ", but follows from no variable that was looked at"
    else:
        told += "is more than the noise between neighbouring samples"
        guess = f", and follows from no variable that was looked at: {what_it_may_be(remainder)}"
        told += "" if is_told else guess
    return f"{told}; most of it from {' and '.join(named)}." if named else f"{told}."


def _next(
    verdict: Verdict,
    causes: Sequence[Cause],
    alternatives: Sequence[Alternative],
    next_experiment: str | None,
    remainder: Remainder,
) -> list[str]:
    told = [f"Next: {next_experiment.rstrip('.')}."] if next_experiment else []
    tied = {name for a in alternatives for name in a.effects}
    sure = [cause for cause in causes if cause.effect not in tied and cause.remedy]
    remedies = [cause.remedy for cause in sure if not cause.remedy.startswith("none")]
    if remedies and verdict is not Verdict.UNKNOWN:
        told.append(f"In hardware: {'; '.join(dict.fromkeys(remedies))}.")
    if verdict is Verdict.UNKNOWN and remainder.structured:
        told.append("Look at the plots of what is left against position, speed, input and time.")
    return told
