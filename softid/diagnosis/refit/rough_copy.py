"""A fit over averages of a few samples, for early rounds that only choose who goes on.

Who leads after a few evaluations is seen on a fraction of the samples as well as on all of them,
and every evaluation costs that fraction only. What is chosen there is refitted to all samples, as
they were recorded: for the averages those that lie unevenly are read at even times. A
motion without a spring is left as it is: it adds up what a force is off for the whole log, so its
candidates part after a few evaluations where averages differ in the last digits.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from softid.diagnosis.logs.decimation import decimated, samples_to_average
from softid.diagnosis.logs.even_sampling import evenly_sampled
from softid.diagnosis.refit.candidates import Candidate, advance
from softid.diagnosis.refit.extension import extend_in_order
from softid.effects.scale import Scale
from softid.fitters.problem import Problem

COPY_SAMPLES = 1200
"""Up to so many samples nothing is averaged, and of many more about so many averages are left."""

SAMPLES_PER_MOTION = 3.0
"""Averages in a time constant of the motion at least."""


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
    averaged = [decimated(log, count) for log in logs]
    problem = Problem(whole.problem.model, whole.problem.parameters, averaged)
    if problem.size != whole.problem.size:  # a stall more or less, with an initial state of its own
        return whole, sigma
    weighted = {channel: size / np.sqrt(count) for channel, size in sigma.items()}
    return advance(replace(whole, problem=problem), weighted, 1), weighted


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
    problem = extend_in_order(fitted.problem, candidate.acting, scale)
    begin = replace(candidate.minimum, damping=None)
    return replace(candidate, problem=problem, minimum=begin)
