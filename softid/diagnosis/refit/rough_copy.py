"""A fit over averages of a few samples, for early rounds that only choose who goes on.

Who leads after a few evaluations is seen on a fraction of the samples as well as on all of them,
and every evaluation costs that fraction only. What is chosen there is refitted to all samples, as
they were recorded: for the averages those that lie unevenly are read at even times. A
motion without a spring is left as it is: it adds up what a force is off for the whole log, so its
candidates part after a few evaluations where averages differ in the last digits.

A jump of the input stays where it was: beside one the nodes of an averaged input go beyond its
levels, and a play, a friction or a dead zone, which follow only a part of a move, would follow
that. Averages of a quick edge leave a residual of their own all the same, which a clock that runs
wrong or a lag by level would explain. Where it is large beside the misfit, the outputs are such
that the fit leaves over the averages what these are of what it leaves over the samples. That is
exact where the fit stands; where the misfit is larger, other laws stand too far away. What was read
at even times for the averages has no samples to go by.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.logs.decimation import AveragedLog, decimated, samples_to_average
from softid.diagnosis.logs.even_sampling import evenly_sampled
from softid.diagnosis.refit.candidates import Candidate, advance
from softid.diagnosis.refit.extension import extend_in_order, within_bounds_of
from softid.effects.scale import Scale
from softid.fitters.problem import Problem
from softid.log import Log

Array = npt.NDArray[np.float64]

COPY_SAMPLES = 1200
"""Up to so many samples nothing is averaged, and of many more about so many averages are left."""

SAMPLES_PER_MOTION = 3.0
"""Averages in a time constant of the motion at least."""

OWN_MISFIT = 1.25
"""Averages whose sum of squares is larger than so many times that of what they should leave have a
misfit of their own; a judgement."""


def rough_copy(
    whole: Candidate, scale: Scale, sigma: Mapping[str, float]
) -> tuple[Candidate, Mapping[str, float]]:
    """A fit over averages, where it stands; itself where averages do not do.

    Parameters
    ----------
    whole
        The fit over all samples.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.

    Returns
    -------
    candidate, sigma
        The fit over averages of k samples, and the scales divided by √k: so each average counts
        for the k samples in it, and a sum of squares that falls falls as much as over all samples.
    """
    even = [evenly_sampled(log) for log in whole.problem.logs]
    logs = [log for log in even if log is not None]
    if len(logs) < len(even) or not whole.has_spring:
        return whole, sigma
    count = samples_to_average(
        logs, scale.motion_s, enough=COPY_SAMPLES, per_motion=SAMPLES_PER_MOTION
    )
    if count == 1:
        return whole, sigma
    averaged = [_averaged(log, count) for log in logs]
    problem = _over(averaged, whole.problem)
    if problem is None:
        return whole, sigma
    weighted = {channel: size / np.sqrt(count) for channel, size in sigma.items()}
    rough = advance(replace(whole, problem=problem), weighted, 1)
    is_read_anew = any(log is not own for log, own in zip(logs, whole.problem.logs, strict=True))
    if is_read_anew:
        return rough, weighted
    corrected = _over(_as_left(whole, logs, averaged, problem, count), whole.problem)
    if corrected is None:
        return rough, weighted
    left = advance(replace(whole, problem=corrected), weighted, 1)
    return (left if rough.squares > OWN_MISFIT * left.squares else rough), weighted


def _averaged(log: Log, count: int) -> Log:
    """A log over averages, with jumps of its input where they were recorded."""
    if isinstance(log, AveragedLog):
        return decimated(log.at_samples(), count * log.count)
    return decimated(log, count)


def _over(logs: Sequence[Log], whole: Problem) -> Problem | None:
    """A problem over other logs with the same unknowns.

    None where a stall more or less, or a start that is no rest any more, has an initial state of
    its own.
    """
    problem = Problem(whole.model, whole.parameters, logs)
    is_alike = problem.size == whole.size and problem.at_rest == whole.at_rest
    return problem if is_alike else None


def _as_left(
    whole: Candidate, logs: Sequence[Log], averaged: Sequence[Log], problem: Problem, count: int
) -> list[Log]:
    """Averages whose outputs leave of the fit what averages of its residuals are."""
    point = whole.minimum.point
    left = [decimated(log, count) for log in _left_over(whole.problem, point, logs)]
    own = _left_over(problem, point, averaged)
    return [_with_more(*three) for three in zip(averaged, left, own, strict=True)]


def _left_over(problem: Problem, point: Array, logs: Sequence[Log]) -> list[Log]:
    """Logs whose outputs are what a fit leaves of them, 0 where a sample is not used."""
    left = [{name: np.zeros(len(log)) for name in problem.outputs} for log in logs]
    for block in problem.blocks(point, derivatives=False):
        segment = problem.segments[block.segment]
        values = left[problem.owner[block.segment]][block.channel][segment.start : segment.stop]
        values[segment.samples_of(segment.used[block.channel])] = block.residual
    return [_with_outputs(log, own) for log, own in zip(logs, left, strict=True)]


def _with_more(log: Log, left: Log, own: Log) -> Log:
    """A log whose outputs leave what the second leaves, where they leave the third."""
    outputs = {
        name: log.channels[name].values + left.channels[name].values - own.channels[name].values
        for name in log.outputs
    }
    return _with_outputs(log, outputs)


def _with_outputs(log: Log, outputs: Mapping[str, Array]) -> Log:
    channels = {n: replace(log.channels[n], values=values) for n, values in outputs.items()}
    return replace(log, channels={**log.channels, **channels})


def over_samples_of(candidate: Candidate, fitted: Candidate, scale: Scale) -> Candidate:
    """A candidate over all samples in place of averages, or the other way round, where it stands.

    Parameters
    ----------
    candidate
        The candidate.
    fitted
        What it extends, over the samples that it shall have.
    scale
        Sizes of the base fit.
    """
    extended = extend_in_order(fitted.problem, candidate.acting, scale)
    problem = within_bounds_of(extended, candidate.problem)
    begin = replace(candidate.minimum, damping=None)
    return replace(candidate, problem=problem, minimum=begin)
