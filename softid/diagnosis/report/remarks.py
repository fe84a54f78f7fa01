"""Remarks of a diagnosis that belong into its paragraph, by what the paragraph makes of them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from softid.diagnosis.changes.zero_jumps import ZERO_JUMP
from softid.diagnosis.logs.permanent_set import RESIDUAL_SET
from softid.diagnosis.report.changes import CHANGE_POINT, HELD_OUT_CHANGE
from softid.diagnosis.report.clipped_input import CLIPPED_INPUT
from softid.diagnosis.report.issues import BEGUN_ANEW, NEGLIGIBLE_MISFIT, REFUSED, UNSURE
from softid.diagnosis.report.joint_causes import ONE_CAUSE
from softid.diagnosis.report.motion_shown import NEARLY_STATIC, ONE_FREQUENCY
from softid.diagnosis.report.no_response import NO_RESPONSE
from softid.diagnosis.report.open_intersample import OPEN_INTERSAMPLE
from softid.diagnosis.report.other_explanations import EVENTS, OF_REST, ONE_STEP
from softid.diagnosis.report.other_model import UNASKED_MODEL
from softid.diagnosis.report.rounding import OF_RECORDED_INPUT
from softid.diagnosis.report.several_elements import SEVERAL_ELEMENTS
from softid.diagnosis.report.timing import UNCERTAIN_TIMES
from softid.diagnosis.report.unlisted_texts import (
    LAW_BESIDE,
    LIKE_UNLISTED_LAW,
    UNLISTED_LAW,
    WHAT_IS_LEFT,
)
from softid.diagnosis.residual.disturbances import CODES, SPECTRAL_LINE
from softid.diagnosis.searches.fitted_together import NOT_TOGETHER, TOLD_TOGETHER
from softid.diagnosis.searches.smoothed_record import SMOOTHED_RECORD
from softid.diagnosis_results import Diagnosis, Verdict
from softid.quality.causality import LEADING_OUTPUT

WHAT_IT_IS = (*EVENTS, UNLISTED_LAW, ONE_STEP, NO_RESPONSE, UNASKED_MODEL, NOT_TOGETHER)
"""Codes of remarks that say what a misfit is for which no cause is named."""

ALWAYS_SEEN = (ZERO_JUMP, LEADING_OUTPUT, ONE_FREQUENCY)
"""Codes of remarks on the logs that belong into every paragraph."""

MARKS = (
    *CODES,
    LIKE_UNLISTED_LAW,
    *OF_REST,
    CLIPPED_INPUT,
    *OF_RECORDED_INPUT,
    UNCERTAIN_TIMES,
)
"""Codes of remarks on what is left, which say what it is or may be."""

INSTEAD = (NEGLIGIBLE_MISFIT, SMOOTHED_RECORD, TOLD_TOGETHER)
"""Codes of remarks that stand for what is said of noise: a misfit is too small to be looked into,
the record was smoothed, or only what is held out tells the parameters."""

LEAVE_A_SET = ("creep", "relaxation", "hysteresis", "softening", "sensor_warmup")
"""Effects after which a motion does not return to where it began, or not soon."""


@dataclass(frozen=True)
class Remarks:
    """Messages of a diagnosis, sorted; all empty where there are none.

    Attributes
    ----------
    seen
        What the logs show by themselves, without a model.
    assumed
        What the input is taken to do between its samples, where another assumption does as well.
    changes
        What changed within the fitted logs or between them, or a law in no catalogue, which is the
        misfit then.
    laws
        A law in no catalogue that accounts for most of a misfit without a name.
    law_beside
        What is done by what is left, in words, where a law in no catalogue takes it away.
    marks
        The other remarks of `MARKS`.
    refused
        What `refusal_issues` or `unsure_issues` found.
    held_out_changes
        How what is held out differs from the fitted logs.
    joined
        That two causes may be one.
    elements
        That one has several elements, which explain more than the descriptions do.
    has_line
        Whether one of the marks is a steady line.
    instead
        The remark of `INSTEAD`.
    """

    seen: tuple[str, ...] = ()
    assumed: tuple[str, ...] = ()
    changes: tuple[str, ...] = ()
    laws: tuple[str, ...] = ()
    law_beside: str = ""
    marks: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()
    held_out_changes: tuple[str, ...] = ()
    joined: tuple[str, ...] = ()
    elements: tuple[str, ...] = ()
    has_line: bool = False
    instead: str = ""

    @classmethod
    def of(cls, found: Diagnosis) -> Remarks:
        """The remarks of a diagnosis.

        Parameters
        ----------
        found
            The diagnosis, in which they are issues.
        """
        in_place = (LIKE_UNLISTED_LAW,) if found.verdict is Verdict.UNKNOWN else ()
        beside = (LAW_BESIDE,) if found.remainder.structured else ()
        law_beside = next(iter(_messages(found, beside)), "")
        return cls(
            seen=_seen(found),
            assumed=_messages(found, (OPEN_INTERSAMPLE,)),
            changes=_messages(found, WHAT_IT_IS),
            laws=_messages(found, in_place),
            law_beside=law_beside.removeprefix(WHAT_IS_LEFT),
            marks=_messages(found, {*MARKS} - {*in_place, *beside}),
            refused=_messages(found, (REFUSED, BEGUN_ANEW, UNSURE)),
            held_out_changes=_messages(found, (HELD_OUT_CHANGE,)),
            joined=_messages(found, (ONE_CAUSE,)),
            elements=_messages(found, (SEVERAL_ELEMENTS,)),
            has_line=bool(_messages(found, (SPECTRAL_LINE,))),
            instead=next(iter(_messages(found, INSTEAD)), ""),
        )

    @property
    def say_what_is_left(self) -> bool:
        """Whether one of them says what is left."""
        return bool(self.marks or self.elements or self.law_beside)


def _messages(found: Diagnosis, codes: Collection[str]) -> tuple[str, ...]:
    return tuple(issue.message for issue in found.issues if issue.code in codes)


def _seen(found: Diagnosis) -> tuple[str, ...]:
    """The remarks on the logs that belong into the paragraph.

    That a first cycle leaves a set is told of one log, and not where a cause that does so is named,
    or tied with what is, nor where something changed at a moment, which leaves one, too.
    """
    named = {cause.effect for cause in found.causes}
    if named:
        named |= {name for tie in found.alternatives for name in tie.effects}
    codes: tuple[str, ...] = ALWAYS_SEEN
    if found.verdict in (Verdict.UNKNOWN, Verdict.PARTIAL):
        codes = (*ALWAYS_SEEN, NEARLY_STATIC)
        changed = any(issue.code == CHANGE_POINT for issue in found.issues)
        if named.isdisjoint(LEAVE_A_SET) and not changed:
            codes = (*codes, RESIDUAL_SET)
    seen = [issue for issue in found.issues if issue.code in codes]
    sets = [issue for issue in seen if issue.code == RESIDUAL_SET]
    return tuple(issue.message for issue in seen if issue not in sets[1:])
