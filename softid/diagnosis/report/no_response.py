"""An output that does not answer to the input: a dead sensor, or a column that is another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.error_texts import spread_of
from softid.diagnosis.report.phrases import listed, variables_left
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
    is_still = not set(variables_left(answer.remainder)) - {"t"} and is_as_good_as_constant(final)
    still = still_logs(answer.gains, first)
    if is_still:
        moves = np.ptp(np.concatenate([segment.input for segment in problem.segments]))
        told = (
            f"{first} does not visibly answer to {driving.name}, though that moves over "
            f"{moves * driving.display_factor:.3g} {driving.display_unit}: a constant explains "
            f"{first} as well as the model does"
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


def is_as_good_as_constant(model: Candidate) -> bool:
    """Whether a constant for every log has no larger BIC than a model, each with its own noise.

    Parameters
    ----------
    model
        The model where it stands.
    """
    problem = model.problem
    first = problem.outputs[0]
    left = [part.residual for part in residual_context(model)]
    recorded = [
        np.where(np.isfinite(residual), segment.samples_of(segment.outputs[first]), np.nan)
        for segment, residual in zip(problem.segments, left, strict=True)
    ]
    about_constant = _less_means(recorded, problem.owner)
    if _squares(left) < (1.0 - MOST_EXPLAINED) * _squares(about_constant):
        return False
    of_model, of_constant = fit_ar(left), fit_ar(about_constant)
    return of_constant.bic <= of_model.bic + len(problem.free) * math.log(of_model.n)


def _less_means(recorded: Sequence[Array], owner: Sequence[int]) -> list[Array]:
    """The readings of every segment less the mean of its log."""
    pairs = list(zip(recorded, owner, strict=True))
    whole = {log: np.concatenate([y for y, k in pairs if k == log]) for log in owner}
    return [y - np.nanmean(whole[log]) for y, log in pairs]


def _squares(parts: Sequence[Array]) -> float:
    return sum(float(np.nansum(part**2)) for part in parts)
