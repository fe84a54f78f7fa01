"""The input between its samples once more, when causes are known.

A misfit of the base decides wrongly what an input does: a late motion asks for a late input, and
one that swings for an input that is cut short. So a measured input is smooth where it bends, and
straight else, until a cause is known that explains the logs better with another intersample
behaviour, while a command keeps that of the base.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from softid.channels import is_command
from softid.diagnosis.base.base_fit import Recordings
from softid.diagnosis.logs.decimation import with_other_intersample
from softid.diagnosis.refit.candidates import Candidate, advance, begun
from softid.diagnosis.refit.extension import extend, named_values, start_unknowns
from softid.diagnosis.refit.parts_of_logs import refitted_to_changed
from softid.diagnosis.residual.noise_model import moments_of
from softid.effects import ExtendedModel, effect_of, own_values
from softid.effects.scale import Scale
from softid.fitters.residual_whiteness import residuals_by_channel, squared_autocorrelation
from softid.identification.input_treatment import explained_best, other_ways
from softid.identification.intersample_choice import (
    BETTER_BY,
    HELD_INPUT,
    as_held,
    choice_unless_held,
    choices_of,
)
from softid.intersample import HELD, Intersample
from softid.log import Log, LogSet
from softid.parallel import in_parallel

TIE_DISTANCE = 1.0
"""Behaviours whose n·ln(mean square) differ by less explain alike, and the plainest is taken."""

LITTLE_OF_GAIN = 0.02
"""Share of what a cause that takes time gains, in n·ln(mean square), that is as much as nothing
beside a held input: lost samples and other causes blur the half of an interval."""

SINGLE_DELAYS = ("delay", "pneumatic_lag", "sensor_lag")
"""Causes that make the response late by a single number."""

REFIT_EVALUATIONS = 15
"""Evaluations from the optimum of one intersample behaviour to that of the other."""

REFITTING_FROM_AFAR = 60
"""Evaluations from the optimum of one intersample behaviour to that of another with a delay, from a
base that has made room for what the delay explains."""

LEAST_OF_REST = 0.25
"""Share of what causes leave above the noise that another intersample behaviour takes away."""

MOST_LAGS = 1000
"""Samples over which what is left may go on; beyond them its correlations hardly add."""


def is_open(logs: LogSet) -> bool:
    """Whether an input may do several things between its samples, and no log declares one.

    It may have been held where it jumps as recorded, and where it is a command; and where it bends
    it may go straight all the same.
    """
    return all(log.intersample is None for log in logs) and len(choices_of(logs)) > 1


def is_measured(logs: Iterable[Log]) -> bool:
    """Whether no input is a command."""
    return not any(is_command(log.input) for log in logs)


def better_intersample(
    candidate: Candidate, sigma: Mapping[str, float], *, least: float = 0.0
) -> Intersample | None:
    """Another intersample behaviour where it explains the logs better with the same effects.

    What it leaves may go on for long, as what no cause has explained yet does: the sums of its
    squares then differ by little for nothing. Where the input is not held the moments of its jumps
    may be open, each of which costs two numbers.

    Parameters
    ----------
    candidate
        A model with its first cause, at its optimum.
    sigma
        Output channel → scale that its residual is divided by.
    least
        Share of the sum of squares that another intersample behaviour has to take away.

    Returns
    -------
    str or None
        None where that of the candidate stays.
    """
    logs = candidate.problem.logs
    now = logs[0].effective_intersample
    others = [intersample for intersample in choices_of(logs) if intersample != now]
    if not others:
        return None

    needed = -candidate.problem.n_samples * float(np.log1p(-least))

    def fall(intersample: Intersample) -> float:
        refitted = refitted_as(candidate, sigma, intersample)
        if refitted is None:
            return -np.inf
        found = _fall_with_moments(candidate, refitted)
        return found * independent_share(refitted) if found >= needed else -np.inf

    falls = in_parallel(fall, others)
    if max(falls) <= BETTER_BY:
        return None
    alike = max(falls) - TIE_DISTANCE
    return next(one for one, found in zip(others, falls, strict=True) if found > alike)


def _fall_with_moments(candidate: Candidate, other: Candidate) -> float:
    """As `_fall`, with the moments of jumps open in either model."""
    return _fall(candidate, other) + _gained_by_moments(other) - _gained_by_moments(candidate)


def _gained_by_moments(candidate: Candidate) -> float:
    """By how much n ln(S) falls with the moments of jumps open, less the price of these; or 0."""
    moments = moments_of(candidate)
    return 0.0 if moments is None else moments.gain


def intersample_after_first_cause(
    base: Candidate, candidate: Candidate, scale: Scale, sigma: Mapping[str, float]
) -> Intersample | None:
    """As `better_intersample` with a first cause; a lateness does not make a measured input held.

    Holding it at every sample is a delay of half an interval. Where a cause that takes time stays
    in the model it would take that half from it, so the base alone must then explain as much; and
    without one, no other delay may explain more. Where with a held input the base explains as much
    as a cause that takes time, or a single delay as one of second order, that one is not needed.

    Parameters
    ----------
    base
        What the first cause extends.
    candidate
        The model with its first cause, at its optimum.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    """
    intersample, is_late = better_intersample(candidate, sigma), _is_late(candidate)
    if not is_measured(candidate.problem.logs):
        return intersample
    if intersample in (None, "zoh") and is_late:
        return _held_with_less(base, candidate, scale, sigma)
    if intersample != "zoh":
        return intersample
    held, other = refitted_as(candidate, sigma, intersample), _delayed(candidate, scale, sigma)
    if held is None or _fall(held, other) * independent_share(other) > BETTER_BY:
        return None
    return intersample


def _held_with_less(
    base: Candidate, candidate: Candidate, scale: Scale, sigma: Mapping[str, float]
) -> Intersample | None:
    """How the input may be held, so that the base or a single delay explains as much."""
    gained = max(_fall(base, candidate), 0.0)
    needed = max(BETTER_BY / independent_share(candidate), LITTLE_OF_GAIN * gained)
    delay_s = _delay_of_second_order(candidate)
    for intersample in (one for one in choices_of(candidate.problem.logs) if one in HELD):
        held = refitted_as(base, sigma, intersample)
        if held is None:
            continue
        if _fall(held, candidate) <= needed:
            return intersample
        late = [_delayed(held, scale, sigma, name, delay_s) for name in SINGLE_DELAYS if delay_s]
        if any(_fall(model, candidate) <= needed for model in late):
            return intersample
    return None


def _delayed(
    candidate: Candidate,
    scale: Scale,
    sigma: Mapping[str, float],
    name: str = "delay",
    delay_s: float = 0.0,
) -> Candidate:
    """The model refitted with a delay or a lag, from half a sampling interval on at least."""
    known, effect = candidate.problem, effect_of(name)
    problem = extend(known, (effect,), scale)
    values = named_values(effect, {"tau": max(delay_s, 0.5 * known.logs[0].period_s)})
    z = start_unknowns(problem, known, candidate.minimum.point, values)
    late = begun(candidate, (*candidate.effects, effect), problem, z)
    return advance(late, sigma, REFITTING_FROM_AFAR if delay_s > 0.0 else REFIT_EVALUATIONS)


def _delay_of_second_order(candidate: Candidate) -> float:
    """What a cause of second order makes late at low frequencies, 2 ζ/ω; 0 for another one."""
    *_, effect = candidate.effects
    values = own_values(effect, candidate.problem.values(candidate.minimum.point))
    return values["zeta"] * values["period"] / np.pi if "zeta" in values else 0.0


def _is_late(candidate: Candidate) -> bool:
    """Whether a cause that takes time is in the model."""
    model = candidate.problem.model
    if not isinstance(model, ExtendedModel):
        return False
    return any(effect.takes_time(model.scale) for effect in candidate.effects)


def intersample_after_all_causes(
    candidate: Candidate, sigma: Mapping[str, float], excess: float = 0.0
) -> Intersample | None:
    """As `better_intersample` with all causes known; a measured input is held if that is better.

    Nor is it held at every sample beside a cause that takes time, as after the first cause. Where
    more than noise is left another behaviour takes away a fair part of that, or it is not what is
    missing.

    Parameters
    ----------
    candidate, sigma
        As in `better_intersample`.
    excess
        What the candidate leaves above the noise, as a multiple of it.
    """
    logs = candidate.problem.logs
    if logs[0].intersample in HELD and is_measured(logs):
        plain = choice_unless_held(logs)
        refitted = refitted_as(candidate, sigma, plain)
        return plain if refitted and _fall(candidate, refitted) > -BETTER_BY else None
    above = max(excess, 0.0)
    intersample = better_intersample(candidate, sigma, least=LEAST_OF_REST * above / (1.0 + above))
    if intersample == "zoh" and is_measured(logs) and _is_late(candidate):
        return None
    return intersample


def independent_share(candidate: Candidate) -> float:
    """Share of the samples of the first output that count as independent for a mean square.

    It is 1/(1 + 2 Σ ρ²). White noise adds L/n to a sum of ρ̂² over L lags, which is subtracted.

    Parameters
    ----------
    candidate
        The model that leaves them.
    """
    (residuals, *_) = residuals_by_channel(candidate.problem, candidate.minimum.point)
    lags = min(MOST_LAGS, max(residual.size for residual in residuals) // 4)
    chance = lags / sum(residual.size for residual in residuals)
    return 1.0 / (1.0 + 2.0 * max(squared_autocorrelation(residuals, lags) - chance, 0.0))


def refitted_as(
    candidate: Candidate, sigma: Mapping[str, float], intersample: Intersample
) -> Candidate | None:
    """The model refitted with another intersample behaviour of the input.

    None where its unknowns differ with that, or the response is not finite.

    Parameters
    ----------
    candidate, sigma
        As in `better_intersample`.
    intersample
        What the input does between its samples.
    """
    logs = [with_other_intersample(log, intersample) for log in candidate.problem.logs]
    return refitted_to_changed(candidate, sigma, logs, REFIT_EVALUATIONS)


def explained_alike(
    candidate: Candidate, sigma: Mapping[str, float], intersample: Intersample
) -> Candidate | None:
    """The model refitted with an intersample behaviour that its logs do not tell from its own.

    Parameters
    ----------
    candidate, sigma, intersample
        As in `refitted_as`.

    Returns
    -------
    Candidate or None
        None where the logs tell, or the refit does not go.
    """
    refitted = refitted_as(candidate, sigma, intersample)
    if refitted is None:
        return None
    fall = _fall_with_moments(refitted, candidate) * independent_share(candidate)
    return refitted if fall <= BETTER_BY else None


def _fall(candidate: Candidate, other: Candidate) -> float:
    """By how much n ln(S) falls from one model to another."""
    return candidate.problem.n_samples * float(np.log(candidate.squares / other.squares))


def with_intersample(logs: Sequence[Log], intersample: Intersample) -> tuple[Log, ...]:
    """The logs with this intersample behaviour; a held one gets an issue that says so."""
    changed = tuple(_with_intersample(log, intersample) for log in logs)
    return as_held(changed, intersample) if intersample in HELD and changed else changed


def _with_intersample(log: Log, intersample: Intersample) -> Log:
    """The log with this intersample behaviour, without the issue that says so."""
    issues = tuple(issue for issue in log.issues if issue.code != HELD_INPUT)
    return replace(with_other_intersample(log, intersample), issues=issues)


def recordings_with_intersample(recordings: Recordings, intersample: Intersample) -> Recordings:
    """Fitted and held-out logs with this intersample behaviour; an issue is on the fitted alone.

    Parameters
    ----------
    recordings
        The logs.
    intersample
        What the input does between its samples.
    """
    return Recordings(
        LogSet(with_intersample(recordings.logs.logs, intersample)),
        tuple(_with_intersample(log, intersample) for log in recordings.hold_out),
    )


def hold_out_as_explained(
    candidate: Candidate,
    intersample: Intersample,
    sigma: Mapping[str, float],
    hold_out: Sequence[Log],
) -> tuple[Log, ...]:
    """The logs that judge, each with the intersample behaviour that the model explains best.

    A model that lacks a cause that takes time would hold them later than they were.

    Parameters
    ----------
    candidate
        A model with what is known of its causes, whatever the intersample behaviour of its logs.
    intersample
        What the input of the fitted logs does between its samples.
    sigma
        Output channel → scale that its residual is divided by.
    hold_out
        Logs with that intersample behaviour.
    """
    if intersample not in HELD and is_measured(hold_out):
        return tuple(hold_out)
    now = candidate.problem.logs[0].effective_intersample
    refitted = None if intersample == now else refitted_as(candidate, sigma, intersample)
    known = refitted or candidate
    model, values = known.problem.model, known.parameters
    return tuple(
        explained_best(
            (log, *(with_other_intersample(log, way) for way in other_ways(log, intersample))),
            model,
            values,
        )
        for log in hold_out
    )
