"""What changed within a log or between logs, which is no cause that goes on throughout."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.changes.change_point import change_point
from softid.diagnosis.changes.changed_numbers import squares_of, standing_over
from softid.diagnosis.changes.events import Event, events_in
from softid.diagnosis.changes.held_out_difference import (
    gain_beside_difference,
    held_out_difference,
    shows_motion_of,
)
from softid.diagnosis.changes.input_levels import have_same_levels
from softid.diagnosis.changes.log_differences import log_differences
from softid.diagnosis.changes.pooling import own_parameters
from softid.diagnosis.changes.shifts import EITHER, LOAD, ZERO
from softid.diagnosis.changes.spells import Spells
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.parts_of_logs import REFIT_EVALUATIONS, refitted
from softid.diagnosis.report.difference_texts import APART, LOG_DIFFERENCES, DifferenceTexts
from softid.diagnosis.report.phrases import percent
from softid.diagnosis.residual.assessment import noise_variance
from softid.diagnosis_results import Remainder
from softid.effects.scale import Scale
from softid.errors import IdentificationError, InputError, Issue
from softid.log import Log
from softid.sentences import listed

Array = npt.NDArray[np.float64]

CHANGE_POINT = "change-point"
"""Code of the remark that a misfit begins at one moment."""

HELD_OUT_CHANGE = "held-out-change"
"""Code of the remark that what is held out differs, from a moment on or throughout."""

CHANGES = {
    ZERO: "its zero jumps there",
    LOAD: "a constant load changes there",
    EITHER: "its zero jumps there, or a constant load changes",
    "clock": "its clock jumps there against that of the input",
    "gain": "its gain changes there, or the stiffness of the actuator does",
    "": "there the model changes in more than one way",
}
"""Kinds of a change point in words."""

OUTSIDE_NOISE = ", outside of which no more than noise is left"
"""Said of spells in which no change in one known way is seen."""

BESIDE = "; with that in the model, what was found takes away "
"""Said of the gain where what is held out has its own of the number that differs."""

RECURS = (
    "; what is held out has such spells, too, so that a law may be missing that acts at few "
    "moments, such as a snap from one state into another"
)
"""Said of spells where an event would have had to happen again."""

LOOK_THEN = (
    "look at what happened then, such as a slipped mount, a touched cable, a part that gave way or "
    "lost samples, and diagnose what comes before and after it apart"
)
"""What to do about a moment or a spell."""

REFERENCES = 3
"""Logs that are tried as the one which the others are compared with."""


def held_out_change_issues(
    model: Candidate, remainder: Remainder, base: BaseFit, *, is_sure: bool
) -> tuple[Issue, ...]:
    """How what is held out differs, throughout or from a moment on; nothing where it does not.

    A moment is looked for where one change throughout does not do: it has one more unknown.

    Parameters
    ----------
    model
        The last model.
    remainder
        What it leaves.
    base
        The base fit, and what was held out.
    is_sure
        Whether nothing but what is held out speaks against a name, and nothing is in a tie: a law
        that is wrong asks for another size in every log.
    """
    held, scale = base.held_out, base.scale
    judged = held.standing(model) if remainder.misses_held_out else None
    if judged is None:
        return ()
    is_asked = is_sure or remainder.structured  # whether it is turned, whatever else is wrong
    found = held_out_difference(model, remainder, held, scale) if is_asked else None
    if found is not None:
        texts = DifferenceTexts.of(judged.problem)
        told = texts.issue(found, judged.problem.logs, "the fitted logs")
        gain = gain_beside_difference(found, model, base) if model.effects else None
        beside = f"{BESIDE}{percent(gain)} of the error there" if gain is not None else ""
        return (replace(told, code=HELD_OUT_CHANGE, message=f"{told.message}{beside}"),)
    errors = held.first_errors(model)
    excess = float(np.mean(errors**2)) / remainder.noise_power - 1.0
    moments = change_issues(judged, scale, excess)
    return tuple(replace(issue, code=HELD_OUT_CHANGE) for issue in moments)


def change_issues(
    model: Candidate, scale: Scale, excess: float, *, alone: bool = False
) -> tuple[Issue, ...]:
    """The moment at which the misfit of a model begins, if there is one.

    Parameters
    ----------
    model
        A model over its logs.
    scale
        Sizes of the base fit.
    excess
        Variance of what it leaves above that of the noise, as a share of the latter.
    alone
        Whether only what changes in one known way counts.
    """
    found = change_point(model, scale, excess)
    if found is None or (alone and not found.kind):
        return ()
    problem = model.problem
    log = problem.logs[found.log].name
    return (
        Issue(
            CHANGE_POINT,
            "warning",
            f"the misfit of {problem.outputs[0]} begins at {found.time_s:.1f} s of {log}: "
            f"{CHANGES[found.kind]}, which takes away {percent(min(found.share, 1.0))} of it",
            LOOK_THEN,
        ),
    )


def spell_issues(
    base: BaseFit, find: Callable[[BaseFit], Sequence[Event]] = events_in
) -> tuple[Issue, ...]:
    """The spells to which the misfit of a fitted log is confined; nothing where it is not.

    Parameters
    ----------
    base
        The base fit to the logs.
    find
        As in `is_parted`.
    """
    texts, first = DifferenceTexts.of(base.candidate.problem), base.candidate.problem.outputs[0]
    return tuple(
        Issue(
            CHANGE_POINT,
            "warning",
            f"the misfit of {first} is confined to {_when(event.spells, event.log)} of "
            f"{event.log.name}"
            f"{_what(event, texts)}{_throughout(event.lasts_in)}{RECURS if event.recurs else ''}",
            LOOK_THEN,
        )
        for event in find(base)
    )


def _what(event: Event, texts: DifferenceTexts) -> str:
    """What changes in an event, if it is known."""
    return OUTSIDE_NOISE if event.change is None else texts.in_spell(event.change, event.shift)


def _throughout(logs: Sequence[Log]) -> str:
    """That some logs are as another one is at its end."""
    names = listed([log.name for log in logs])
    return f"; {names} {'has' if len(logs) == 1 else 'have'} it throughout" if names else ""


def _when(spells: Spells, log: Log) -> str:
    """The spells in words."""
    last = float(log.time_s[-1])
    return listed(
        [
            f"{begin:.1f} s to the end" if end >= last else f"{begin:.1f} to {end:.1f} s"
            for begin, end in spells.spans_s
        ]
    )


def difference_issues(base: BaseFit, model: Candidate | None = None) -> tuple[Issue, ...]:
    """What differs from one fitted log to another; nothing where that is not the misfit.

    Parameters
    ----------
    base
        The base fit to the logs.
    model
        What it is extended to, whose misfit is asked about; None for its own.
    """
    candidate = model or base.candidate
    logs = base.whole_logs
    if len(logs) < 2 or not have_same_levels(logs[:1], logs[1:]):
        return ()
    problem, z = standing_over(logs, candidate)
    before = squares_of(problem, z)
    noise = problem.n_samples / len(problem.outputs) * noise_variance(candidate, base.scale)
    for k, reference in enumerate(logs[:REFERENCES]):
        others = (*logs[:k], *logs[k + 1 :])
        if not shows_motion_of((reference,), others):
            continue
        with suppress(IdentificationError, InputError):  # one log may be too short, or at rest
            alone = refitted(candidate, base.sigma, [reference], REFIT_EVALUATIONS)
            own = squares_of(alone.problem, alone.minimum.point)
            found = log_differences(alone, base.scale, others, before=before, noise=noise, own=own)
            if found is not None:
                return (DifferenceTexts.of(alone.problem).issue(found, others, reference.name),)
    return ()


def own_parameter_issues(base: BaseFit) -> tuple[Issue, ...]:
    """That the fitted logs ask for parameters of their own, however little one model leaves.

    Parameters
    ----------
    base
        The base fit to the logs, of which nothing else is told.
    """
    own = None if base.is_negligible else own_parameters(base)
    if own is None:
        return ()
    first, *others = base.whole_logs
    output = first.channels[first.outputs[0]]
    apart, together = (
        f"{left * output.display_factor:.3g} {output.display_unit}"
        for left in (own.apart, own.together)
    )
    pairs = zip(others, own.changes, strict=True) if own.name else ()
    rows = [f"{100.0 * change:+.0f} % in {log.name}" for log, change in pairs]
    texts = DifferenceTexts.of(base.candidate.problem)
    most = (
        f"; most of all {texts.title(own.name)} differs from that in {first.name}, by "
        f"{listed(rows)}{texts.payload(own.name)}"
    )
    return (
        Issue(
            LOG_DIFFERENCES,
            "warning",
            f"the logs differ: models of their own leave {apart} rms of {output.name}, and one for "
            f"all leaves {together}, which is more than chance allows{most if rows else ''}",
            APART,
        ),
    )
