"""A log as a finished fit takes it: what is left out of it, and what its input does in between."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from softid.channels import is_command
from softid.errors import Issue
from softid.fitters.output_error import refit_nuisance
from softid.fitters.problem import Problem
from softid.identification.input_denoising import without_input_noise
from softid.identification.intersample_choice import (
    BEHAVIOUR_WORDS,
    BETTER_BY,
    choice_unless_held,
    misfit_of,
)
from softid.identification.preparation import without_dropouts
from softid.identification.repeated_input import without_repeats
from softid.identification.slow_outputs import at_readings
from softid.intersample import AVERAGED, HELD, InputNoise, Intersample
from softid.log import Log
from softid.models.base import Model
from softid.records import SavedModel
from softid.results import FitResult

HELD_OTHERWISE = "held-otherwise"
"""Code of the remark that the input of a log is taken in another way than in the fitted ones."""


@dataclass(frozen=True)
class InputTreatment:
    """How a finished fit took the input of its logs, as its record says.

    Attributes
    ----------
    intersample
        What the input does between its samples.
    noise
        `AVERAGED` where the noise of the input was averaged, else None.
    """

    intersample: Intersample | None = None
    noise: InputNoise | None = None

    @classmethod
    def of(cls, record: FitResult | SavedModel) -> InputTreatment:
        """That of a fit, or of one that was read back."""
        return cls(record.intersample, record.input_noise)


def prepared(log: Log, treatment: InputTreatment) -> Log:
    """A log with what a fit leaves out of its residuals, and with its input as a fit takes it.

    Parameters
    ----------
    log, treatment
        As in `input_as_fitted`.
    """
    return at_readings(input_as_fitted(without_dropouts(log), treatment))


def input_as_fitted(log: Log, treatment: InputTreatment) -> Log:
    """The log with an input that goes on between the readings of a gauge that repeats its values.

    And without the noise of its input, where it was averaged in the fitted logs.

    Parameters
    ----------
    log
        As it was recorded.
    treatment
        How the fitted logs' input was taken; a held input is not bridged between readings.
    """
    whole = log if treatment.intersample in HELD else without_repeats(log)
    return without_input_noise(whole) if treatment.noise == AVERAGED else whole


def taken_as_fitted(
    logs: Sequence[Log], intersample: Intersample | None, model: Model, values: Mapping[str, float]
) -> tuple[Log, ...]:
    """New logs with the intersample behaviour of the fitted ones, or that which explains them.

    Parameters
    ----------
    logs
        Logs; the input of those that say what it does between samples stays as it is.
    intersample
        As the record of a fit may say.
    model, values
        The fit.
    """
    found = []
    for log in logs:
        others = other_ways(log, intersample) if log.intersample is None else ()
        versions = (log.with_intersample(each) for each in (intersample, *others))
        found.append(explained_best(tuple(versions), model, values))
    return tuple(found)


def other_ways(log: Log, intersample: Intersample | None) -> tuple[Intersample, ...]:
    """What else the input of a log may do between its samples than that of fitted ones.

    A recorder that runs in step with the controller sees a command change as it does, another one
    at the sample that follows: what is held in one log need not be held, nor held alike, in the
    next. A measured input that is not held in the fitted ones is in none.

    Parameters
    ----------
    log
        A log.
    intersample
        What the input of the fitted logs does.
    """
    if intersample is None or not (intersample in HELD or is_command(log.input)):
        return ()
    return tuple(way for way in (*HELD, choice_unless_held([log])) if way != intersample)


def explained_best(versions: Sequence[Log], model: Model, values: Mapping[str, float]) -> Log:
    """The first version of a log, or another that is explained better, with an issue saying so.

    Steps do not tell whether an input is held at every sample or jumps within one; a sine that is
    not fitted does, by half a sampling interval. Its zero and initial state are found alongside.

    Parameters
    ----------
    versions
        The same log with several intersample behaviours, that of the fitted logs first.
    model, values
        The fit.
    """
    first, *others = versions
    differing = [other for other in others if not _same_course(first, other)]
    if not differing:
        return first
    held = model.parameters().with_fixed(values)
    misfits = []
    for log in (first, *differing):
        problem = Problem(model, held, [log])
        misfits.append(misfit_of(problem, refit_nuisance(problem).unknowns))
    best = int(np.argmin(misfits))
    if not misfits[best] < misfits[0] - BETTER_BY:
        return first
    return _told(differing[best - 1])


def _same_course(one: Log, other: Log) -> bool:
    pairs = zip(one.segments(), other.segments(), strict=True)
    return all(np.array_equal(a.input, b.input) for a, b in pairs)


def _told(log: Log) -> Log:
    issue = Issue(
        HELD_OTHERWISE,
        "info",
        f"{log.name}: {log.input} {BEHAVIOUR_WORDS[log.effective_intersample]} explains it better "
        "than taken as in the fitted logs, and is taken so",
        "declare it with --intersample (with_intersample of the log in Python)",
    )
    return replace(log, issues=(*log.issues, issue))
