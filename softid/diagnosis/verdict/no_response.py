"""Whether an output does not answer to the input: a dead sensor, or a column that is another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.motion import residual_context
from softid.diagnosis.verdict.held_out_error import ASTRAY, spread_of
from softid.diagnosis_results import NOTABLE, Diagnosis, Gain, Verdict
from softid.uncertainty.autoregression import fit_ar

Array = npt.NDArray[np.float64]

MOST_EXPLAINED = 0.7
"""A model that explains a larger share of the output's variance is no constant, whatever the noise
model says: one of high order can follow a slow motion by itself."""

ORDERS = (0, 1)
"""Orders of the polynomials in time that an output may follow which answers to no input."""

LEAST_MOVED = 0.5
"""Share of the input's variance that such a course leaves at least: what follows a slow ramp of the
input is a straight line, too."""


@dataclass(frozen=True)
class NoResponse:
    """How it is seen that an output does not answer to the input.

    Attributes
    ----------
    order
        Of the polynomial in time that explains it as well as the model does; None where none does.
    still
        Logs held out in which it stays still where the model moves.
    """

    order: int | None
    still: tuple[str, ...]


def no_response(answer: Diagnosis, final: Candidate) -> NoResponse | None:
    """That the output does not answer to the input; None where it does, or causes have names.

    Parameters
    ----------
    answer
        The diagnosis.
    final
        Its model, with all that is named or described.
    """
    if answer.verdict not in (Verdict.ADEQUATE, Verdict.UNKNOWN):
        return None
    left = answer.remainder
    follows = left.predictable and any(k != "t" and s > NOTABLE for k, s in left.by.items())
    order = None if follows else course_without_input(final)
    still = still_logs(answer.gains, final.problem.outputs[0])
    return NoResponse(order, still) if order is not None or still else None


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


def course_without_input(model: Candidate) -> int | None:
    """Order of what explains the output as well as a model and knows no input; None for nothing.

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
    for order in ORDERS:
        if _squares(_less_course(driven, times, problem.owner, order)) < LEAST_MOVED * moved:
            continue
        about = _less_course(recorded, times, problem.owner, order)
        is_followed = _squares(left) < (1.0 - MOST_EXPLAINED) * _squares(about)
        slopes = order * len(set(problem.owner))
        if not is_followed and fit_ar(about).bic + slopes * math.log(of_model.n) <= least:
            return order
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
