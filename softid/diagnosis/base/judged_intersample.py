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
    readings_of,
    recordings_read_as,
)
from softid.errors import Issue
from softid.identification.intersample_choice import BETTER_BY, HELD_INPUT, misfit_of
from softid.intersample import Intersample
from softid.log import LogSet

MORE = 1.25
"""What is held out is looked at where its error is so many times that of the fitted samples."""

TELLS = 0.5
"""Largest share of the mean square of what is held out that another reading leaves: errors of the
parameters, which are others with every reading, make less of a difference."""

WAYS: dict[Intersample, str] = {
    "straight": "going straight from sample to sample",
    "held": "held where it jumps",
    "zoh": "held at every sample",
}
"""What a command may do."""


def read_as_judged(
    recordings: Recordings, request: Request, base: BaseFit
) -> tuple[Recordings, BaseFit]:
    """The logs and their fit with the reading of a command that what is held out asks for.

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
    if not before > MORE * base.rms:
        return recordings, base
    misfit = misfit_of(base.candidate.problem, base.candidate.minimum.point)
    now = recordings.logs.logs[0].reading
    best, least = (recordings, base), TELLS**0.5 * before
    for reading in readings_of(recordings.logs):
        if reading == now or reading not in WAYS:
            continue
        changed = _told(recordings_read_as(recordings, reading), reading)
        other = request.fit_base(changed.logs, changed.hold_out, thorough=False)
        model = other.candidate
        rms = other.held_out.rms(model)
        if rms < least and misfit_of(model.problem, model.minimum.point) < misfit + BETTER_BY:
            best, least = (changed, other), rms
    return best


def _told(recordings: Recordings, reading: Intersample) -> Recordings:
    """The logs with the remark that what is held out tells their reading."""
    first, *others = recordings.logs
    issue = Issue(
        HELD_INPUT,
        "info",
        f"{first.input} {WAYS[reading]} explains what is held out far better, while the fitted "
        "logs do not tell what it does between its samples, and is taken so",
        f"declare it with --intersample {reading}",
    )
    kept = (known for known in first.issues if known.code != HELD_INPUT)
    told = replace(first, issues=(*kept, issue))
    return replace(recordings, logs=LogSet((told, *others)))
