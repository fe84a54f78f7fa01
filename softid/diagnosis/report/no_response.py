"""An output that does not answer to the input: a dead sensor, or a column that is another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.error_texts import spread_of
from softid.diagnosis.report.phrases import listed
from softid.diagnosis.report.rest_phrases import variables_left
from softid.diagnosis.residual.motion import residual_context
from softid.diagnosis.verdict.held_out_error import ASTRAY
from softid.diagnosis_results import Diagnosis, Gain, Verdict
from softid.errors import Issue
from softid.uncertainty.autoregression import fit_ar

Array = npt.NDArray[np.float64]

NO_RESPONSE = "no-response"
"""Code of the remark that an output does not answer to the input."""

MOST_EXPLAINED = 0.7
"""A model that explains a larger share of the output's variance is no constant, whatever the noise
model says: one of high order can follow a slow motion by itself."""

COURSES = ("a constant", "a straight line in time")
"""What an output may follow that answers to no input, by the order of its polynomial."""

LEAST_MOVED = 0.5
"""Share of the input's variance that such a course leaves at least: what follows a slow ramp of the
input is a straight line, too."""


def with_no_response(answer: Diagnosis, final: Candidate) -> Diagnosis:
    """The diagnosis; unknown, with the reason, where the output does not answer to the input.

    Parameters
    ----------
    answer
        The diagnosis.
    final
        Its model, with all that is named or described.
    """
    if answer.verdict not in (Verdict.ADEQUATE, Verdict.UNKNOWN):
        return answer
    problem = final.problem
    first, driving = problem.outputs[0], problem.logs[0].channels[problem.logs[0].input]
    follows = set(variables_left(answer.remainder)) - {"t"}
    course = None if follows else course_without_input(final)
    still = still_logs(answer.gains, first)
    if course is not None:
        moves = np.ptp(np.concatenate([segment.input for segment in problem.segments]))
        told = (
            f"{first} does not visibly answer to {driving.name}, though that moves over "
            f"{moves * driving.display_factor:.3g} {driving.display_unit}: {course} "
            f"explains {first} as well as the model does"
        )
    elif still:
        told = (
            f"in {listed(still)}, which {'is' if len(still) == 1 else 'are'} held out, {first} "
            f"stays still where the model moves: it does not visibly answer to {driving.name} there"
        )
    else:
        return answer
    remedy = f"check that the sensor of {first} works, and that the right columns are read"
    issue = Issue(NO_RESPONSE, "warning", told, remedy)
    return replace(
        answer,
        verdict=Verdict.UNKNOWN,
        next_experiment=issue.remedy,
        issues=(issue, *answer.issues),
    )


def still_logs(gains: Sequence[Gain], channel: str) -> tuple[str, ...]:
    """Logs held out in which less moves than the model usually misses, and the model moves.

    Parameters
    ----------
    gains
        Errors of the base in all logs.
    channel
        The output.
    """
    mine = [gain for gain in gains if gain.channel == channel]
    usual = max((gain.rmse_before for gain in mine if not gain.held_out), default=math.nan)
    return tuple(
        gain.log
        for gain in mine
        if gain.held_out and spread_of(gain) < usual and gain.rmse_before > ASTRAY * usual
    )


def course_without_input(model: Candidate) -> str | None:
    """What explains the output as well as a model and knows no input; None where nothing does.

    That is a constant for every log, or a straight line where the input is none: its BIC is no
    larger, each with its own noise.

    Parameters
    ----------
    model
        The model where it stands.
    """
    problem, parts = model.problem, residual_context(model)
    first = problem.outputs[0]
    left = [part.residual for part in parts]
    of_model = fit_ar(left)
    least = of_model.bic + len(problem.free) * math.log(of_model.n)
    readings = [segment.samples_of(segment.outputs[first]) for segment in problem.segments]
    recorded = [np.where(np.isfinite(r), y, np.nan) for r, y in zip(left, readings, strict=True)]
    driven, times = [part.u for part in parts], [part.time_s for part in parts]
    moved = _squares(_less_course(driven, times, problem.owner, 0))
    for order, course in enumerate(COURSES):
        if _squares(_less_course(driven, times, problem.owner, order)) < LEAST_MOVED * moved:
            continue
        about = _less_course(recorded, times, problem.owner, order)
        is_followed = _squares(left) < (1.0 - MOST_EXPLAINED) * _squares(about)
        slopes = order * len(set(problem.owner))
        if not is_followed and fit_ar(about).bic + slopes * math.log(of_model.n) <= least:
            return course
    return None


def _less_course(
    rows: Sequence[Array], times: Sequence[Array], owner: Sequence[int], order: int
) -> list[Array]:
    """The rows of every segment less the polynomial of an order through those of its log."""
    found = []
    for row, time_s, log in zip(rows, times, owner, strict=True):
        mine = [k for k, other in enumerate(owner) if other == log]
        t, y = (np.concatenate([part[k] for k in mine]) for part in (times, rows))
        used = np.isfinite(y)
        found.append(row - np.polyval(np.polyfit(t[used], y[used], order), time_s))
    return found


def _squares(parts: Sequence[Array]) -> float:
    return sum(float(np.nansum(part**2)) for part in parts)
