"""The input between its samples, where the fitted logs do not tell and those that judge do.

A command that moves slowly is nearly the same whether it is held at every sample or goes straight
to the next one: half a sampling interval later, which the inertia of a model makes up for. Steps
and fast moves tell the two apart, and the model whose inertia made up for it errs there.
"""

from __future__ import annotations

from dataclasses import replace

from softid.diagnosis.base.base_fit import BaseFit, Recordings, Request
from softid.diagnosis.base.intersample_selection import (
    is_measured,
    recordings_with_intersample,
)
from softid.errors import Issue
from softid.identification.intersample_choice import (
    BEHAVIOUR_WORDS,
    BETTER_BY,
    HELD_INPUT,
    choices_of,
    misfit_of,
)
from softid.intersample import Intersample
from softid.log import LogSet

DOUBTFUL_RATIO = 1.25
"""What is held out is looked at where its error is so many times that of the fitted samples."""

TELLS = 0.5
"""Largest share of the mean square of what is held out that another intersample behaviour leaves:
errors of the parameters, which are others with every one, make less of a difference."""


def with_judged_intersample(
    recordings: Recordings, request: Request, base: BaseFit
) -> tuple[Recordings, BaseFit]:
    """The logs and their fit with the intersample behaviour that what is held out asks for.

    The fitted logs must not tell it from the one that the base has.

    Parameters
    ----------
    recordings
        The logs, of which none declares what its input does.
    request
        What the user asked for.
    base
        Its fit.
    """
    if not recordings.hold_out or is_measured(recordings.logs):
        return recordings, base
    before = base.held_out.rms(base.candidate)
    if not before > DOUBTFUL_RATIO * base.rms:
        return recordings, base
    misfit = misfit_of(base.candidate.problem, base.candidate.minimum.point)
    now = recordings.logs.logs[0].effective_intersample
    best, least = (recordings, base), TELLS**0.5 * before
    for intersample in choices_of(recordings.logs):
        if intersample == now or intersample == "smooth":
            continue
        changed = _told(recordings_with_intersample(recordings, intersample), intersample)
        other = request.fit_base(changed.logs, changed.hold_out, thorough=False)
        model = other.candidate
        rms = other.held_out.rms(model)
        if rms < least and misfit_of(model.problem, model.minimum.point) < misfit + BETTER_BY:
            best, least = (changed, other), rms
    return best


def _told(recordings: Recordings, intersample: Intersample) -> Recordings:
    """The logs with the remark that what is held out tells the intersample behaviour."""
    first, *others = recordings.logs
    issue = Issue(
        HELD_INPUT,
        "info",
        f"{first.input} {BEHAVIOUR_WORDS[intersample]} explains what is held out far better, while "
        "the fitted logs do not tell what it does between its samples, and is taken so",
        f"declare it with --intersample {intersample}",
    )
    kept = (known for known in first.issues if known.code != HELD_INPUT)
    told = replace(first, issues=(*kept, issue))
    return replace(recordings, logs=LogSet((told, *others)))
