"""The residual beside the motion that it belongs to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import FINE_STEPS, Candidate, limited_plan
from softid.diagnosis.residual.structure import ResidualContext
from softid.effects import own_values
from softid.identification.interpolated_output import INTERPOLATED
from softid.segment import Segment

Array = npt.NDArray[np.float64]

STANDS = 3
"""A simulated reading that is at its largest in so many samples stands at a limit."""

SAME_VALUE = 1e-9
"""Values that differ by less, as a share of the range, differ by rounding."""

TURNS = 0.05
"""A motion turns round where it goes back by this share of its way, or more; a step that overshoots
by a twentieth goes back less."""

CLIPPED_WITHIN = 3.0
"""Noise is clipped within so many deviations of a limit."""


def residual_context(candidate: Candidate) -> list[ResidualContext]:
    """Residual of the first output and the motion around it, for every segment."""
    problem, z = candidate.problem, candidate.minimum.point
    first = problem.outputs[0]
    found = []
    for k, segment in enumerate(problem.segments):
        response = problem.response(z, k)
        y, used = response.outputs[first], segment.used[first]
        x = y if response.x is None else response.x
        v = np.gradient(x, segment.time_s) if response.v is None else response.v
        zero = z[problem.zero_position(problem.owner[k], first)] if problem.zeros else 0.0
        residual = np.where(used, segment.outputs[first] - y - zero, np.nan)
        t, x, v, u, residual = (
            segment.samples_of(row) for row in (segment.time_s, x, v, segment.input, residual)
        )
        at_rest = problem.at_rest[k] or problem.stuck[k]
        found.append(ResidualContext(t, x, v, u, residual, at_rest))
    return found


def turns_round(candidate: Candidate) -> bool:
    """Whether a model moves both ways.

    Parameters
    ----------
    candidate
        The model where it stands.
    """
    courses = [part.x for part in residual_context(candidate)]
    way = sum(float(np.sum(np.abs(np.diff(x)))) for x in courses)
    back = 0.5 * (way - sum(abs(float(x[-1] - x[0])) for x in courses))
    return back >= TURNS * way


def mean_square(parts: Sequence[ResidualContext]) -> float:
    """Mean square of what is left in all parts.

    Parameters
    ----------
    parts
        The parts.
    """
    residual = np.concatenate([p.residual for p in parts])
    return float(np.nanmean(residual**2))


def samples_alike(candidate: Candidate) -> int:
    """Distance in samples from which on the noise of two readings is independent.

    An effect may make neighbours alike, and those that were interpolated share a reading.

    Parameters
    ----------
    candidate
        The model where it stands.
    """
    values, logs = candidate.parameters, candidate.problem.logs
    within_s = [effect.alike_within(own_values(effect, values)) for effect in candidate.effects]
    period_s = min(log.period_s for log in logs)
    shared = any(issue.code == INTERPOLATED for log in logs for issue in log.issues)
    return max(round(max(within_s, default=0.0) / period_s), 2 if shared else 1)


def muted_samples(
    candidate: Candidate, parts: Sequence[ResidualContext]
) -> list[npt.NDArray[np.bool_]]:
    """Samples of each segment at which the reading may stand still at an end of a sensor's range.

    A sensor that clips its own noise with the reading shows none there, and half of it where the
    reading is about to be clipped. A rest at an end of the range looks the same and is left out,
    too. Without an effect that `mutes` it there are no such samples.

    Parameters
    ----------
    candidate
        The model where it stands.
    parts
        Its residual in every segment.
    """
    first = candidate.problem.outputs[0]
    is_muted = any(effect.mutes for effect in candidate.effects)
    found = []
    for part, segment in zip(parts, candidate.problem.segments, strict=True):
        muted = np.zeros(part.residual.size, np.bool_)
        if is_muted and np.isfinite(part.residual).any():
            told = segment.samples_of(segment.outputs[first]) - part.residual
            near = CLIPPED_WITHIN * float(np.sqrt(np.nanmean(part.residual**2)))
            for sign in (1.0, -1.0):
                below = np.nanmax(sign * told) - sign * told
                if np.sum(below <= SAME_VALUE * np.nanmax(below)) >= STANDS:
                    muted |= below <= near
        found.append(muted)
    return found


def heard(candidate: Candidate, parts: Sequence[ResidualContext]) -> list[ResidualContext]:
    """The residual where a sensor shows its noise, NaN at its `muted_samples`.

    Parameters
    ----------
    candidate
        The model where it stands.
    parts
        Its residual in every segment.
    """
    return [
        replace(part, residual=np.where(muted, np.nan, part.residual))
        for part, muted in zip(parts, muted_samples(candidate, parts), strict=True)
    ]


def simulated(candidate: Candidate, k: int, segment: Segment) -> Array:
    """The first output of a model at the samples of a segment whose input may be another.

    Parameters
    ----------
    candidate
        The model where it stands.
    k
        Index of the segment.
    segment
        That segment, or the same with a changed input.
    """
    problem, z = candidate.problem, candidate.minimum.point
    theta = problem.theta(z)
    law = problem.model.motion_law(theta)
    plan = limited_plan(problem.model.plan(theta, segment), segment, law, FINE_STEPS)
    found: Array = problem.response(z, k, segment, plan).outputs[problem.outputs[0]]
    return segment.samples_of(found)
