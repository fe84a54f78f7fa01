"""Whether the error on what is held out is one that noise and unsure parameters make."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.logs.decimation import with_other_intersample
from softid.diagnosis.refit.candidates import Candidate, prior_sd
from softid.diagnosis.refit.held_out import HeldOut, HeldOutLogs, fitted_range, mean_power
from softid.diagnosis.refit.optimum import optimum_of
from softid.diagnosis.residual.assessment import held_out_share
from softid.diagnosis.residual.input_noise import errors_in_fit, input_noise
from softid.diagnosis.residual.jump_timing import JumpResponses, OpenJumps
from softid.diagnosis.residual.motion import mean_square
from softid.diagnosis.residual.noise_floor import EXCESS_SDS, fastest_part
from softid.diagnosis.residual.projection import rows_of
from softid.diagnosis_results import Gain, Remainder
from softid.identification.errors_in_variables import with_input_errors
from softid.identification.intersample_choice import choice_unless_held
from softid.identification.parameter_covariance import errors_of

Array = npt.NDArray[np.float64]

OTHER_LOG = 1.5
"""Noise is so many times larger in another log without a word: hands, drafts and cables differ."""

UNLIKELY = 6.63
"""Errors of the parameters make hardly more than so many times the mean square that is expected of
them: 99 % of χ² with one degree of freedom, for one unsure parameter may make all of it."""

ASTRAY = 3.0
"""A model does not carry over to what is held out when it errs there by so many times as much.

Fast noise that is louder there is none of that. Where only slow noise that no rest shows could
explain it, it is wrong: unsure parameters and slow noise are one guess too many. Nor is a model
without causes adequate then, unsure as it may be."""


def with_held_out(
    remainder: Remainder,
    before: float,
    after: Candidate,
    held_out: HeldOut,
    sigma: Mapping[str, float],
) -> Remainder:
    """The remainder with what is left on what is held out.

    Noise of a held-out input may move the simulation more than that of the fitted ones did. Where
    what is left is more than noise, it is looked at again with the moments of jumps of other logs'
    inputs as unknowns; if that leaves noise, and they may all lie in their intervals, they stay so.

    Parameters
    ----------
    remainder
        What the last model leaves on the fitted samples.
    before
        Root mean square error of the first model on what is held out.
    after
        The last model.
    held_out
        What is held out.
    sigma
        Output channel → scale that its residual is divided by.
    """
    runs = held_out.runs(after)
    power = mean_power(runs)
    if np.isinf(power):
        return replace(remainder, held_out_share=0.0, misses_held_out=True)
    noise, unsure = remainder.noise_power, 0.0
    if power > noise:  # what more is asked for costs an evaluation of all logs
        noise = max(noise + _of_input(after, held_out, remainder), fastest_part(runs).variance)
        unsure = parametric_power(after, held_out, sigma)
    fitted = after.problem.n_samples / len(after.problem.outputs)
    longer = fitted / max(sum(run.size for run in runs), 1)
    spread = EXCESS_SDS * remainder.noise_sd * float(np.sqrt(1.0 + longer))
    most = OTHER_LOG * (1.0 + spread) * noise + UNLIKELY * unsure
    jumps = _open_jumps(after, held_out, noise) if power > most else None
    timed = mean_square(jumps.parts) if jumps is not None and jumps.lie_inside else np.inf
    if jumps is not None and timed <= most:
        power = timed
        remainder = replace(remainder, open_jumps_held_out=jumps.count)
    is_a_guess = remainder.colour_s is not None or not after.effects
    strays = is_a_guess and power > ASTRAY**2 * max(remainder.rms**2, noise)
    return replace(
        remainder,
        held_out_share=held_out_share(before, float(np.sqrt(power)), noise + unsure),
        misses_held_out=power > most or strays,
    )


def _of_input(model: Candidate, held_out: HeldOut, remainder: Remainder) -> float:
    """Mean square that the noise of the held-out input adds to that of the fitted one, or 0."""
    judged = held_out.standing(model)
    driven = None
    if judged is not None and any(gauge.are_there for gauge in held_out.gauges.values()):
        driven = input_noise(judged, held_out.gauges, remainder.noise_power, is_judged=True)
    known = remainder.input_noise * remainder.rms**2
    return max(driven.variance - known, 0.0) if driven is not None else 0.0


def _open_jumps(model: Candidate, held_out: HeldOut, noise: float) -> OpenJumps | None:
    """What a model leaves of other logs with the moments of their jumps left open.

    Jumps that are held as those of the fitted logs may come between samples all the same.
    """
    if isinstance(held_out, HeldOutLogs) and held_out.is_intersample_open:
        logs = held_out.logs
        moving = [with_other_intersample(log, choice_unless_held([log])) for log in logs]
        held_out = replace(held_out, logs=tuple(moving))
    judged = held_out.standing(model)
    responses = None if judged is None else held_out_responses(model, judged, noise)
    return None if responses is None else responses.opened(noise)


def held_out_responses(model: Candidate, judged: Candidate, noise: float) -> JumpResponses | None:
    """What moments of jumps do to what a model leaves of other logs; None where none jumps.

    Its parameters stay what they are; zeros and initial states of the logs move along.

    Parameters
    ----------
    model
        A model of the fitted logs.
    judged
        The same over the other logs, as `HeldOut.standing` has it.
    noise
        Variance of the noise, positive.
    """
    lowest, highest = fitted_range(model)
    free, first = len(judged.problem.free), judged.problem.outputs[0]
    parts, slopes = [], []
    for rows in rows_of(judged):
        if rows.channel == first:
            part = rows.motion
            is_inside = (part.u >= lowest) & (part.u <= highest)
            parts.append(replace(part, residual=np.where(is_inside, part.residual, np.nan)))
            slopes.append(rows.jacobian[is_inside[np.isfinite(part.residual)], free:])
    is_any = any(len(rows) for rows in slopes)
    return JumpResponses.of(judged, parts, noise, slopes) if is_any else None


def parametric_power(model: Candidate, held_out: HeldOut, sigma: Mapping[str, float]) -> float:
    """Mean square error on what is held out that comes from the errors of the parameters.

    tr(J C Jᵀ)/m with the derivatives J of m held-out samples by the free parameters and
    C = (V⁻¹ + P⁻¹)⁻¹ from their covariance V under coloured residuals and the P of a prior that
    knows each to a factor of 4.5: what the fitted logs do not hold has no limit else, and a line is
    no law so far away. V allows for noise of the fitted inputs. A parameter at its bound is known.

    Parameters
    ----------
    model
        A refit.
    held_out, sigma
        As in `with_held_out`.

    Returns
    -------
    float
        In the square of the first output's unit.
    """
    slopes = held_out.slopes(model)
    if not (slopes.size and slopes.any() and np.isfinite(slopes).all()):
        return 0.0
    problem, optimum = model.problem, optimum_of(model, sigma)
    errors = errors_of(problem, optimum)
    free = [(row, k) for row, k in enumerate(errors.determined) if k < len(problem.free)]
    if errors.covariance is None or not free:
        return 0.0
    of_input = errors_in_fit(model, held_out.gauges)
    covariance = with_input_errors(errors.covariance, problem, optimum, of_input)
    rows, places = np.array(free).T
    limits = np.array([prior_sd(model, int(k)) for k in places])
    scaled = covariance.matrix[np.ix_(rows, rows)] / np.outer(limits, limits)
    held = np.flatnonzero(np.isfinite(np.diag(scaled)))
    variances, axes = np.linalg.eigh(scaled[np.ix_(held, held)])
    variances = np.maximum(variances, 0.0)
    shrunk = np.eye(len(limits))
    shrunk[np.ix_(held, held)] = axes * (variances / (1.0 + variances)) @ axes.T
    columns = slopes[:, places] * limits
    return float(np.einsum("mi,ij,mj->", columns, shrunk, columns)) / len(columns)


def spread_of(gain: Gain) -> float:
    """Root mean square of what moves in a log, about its mean: error over its share of that.

    Parameters
    ----------
    gain
        The errors in the log.
    """
    missed = 1.0 - gain.fit_percent_before / 100.0
    return gain.rmse_before / missed if missed > 0.0 else math.inf
