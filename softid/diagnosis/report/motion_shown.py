"""How much of a motion the logs show: a single frequency, or next to nothing."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.logs.one_frequency import sine_lag
from softid.diagnosis.report.held_excitation import held_experiments, moves_quickly
from softid.diagnosis.report.phrases import percent
from softid.diagnosis_results import Diagnosis
from softid.errors import Issue
from softid.fitters.problem import Problem
from softid.sentences import lowered

Array = npt.NDArray[np.float64]

ONE_FREQUENCY = "one-frequency"
"""Code of the remark that the input is a sine of one frequency, with the lag behind it."""

NEARLY_STATIC = "nearly-static"
"""Code of the remark that a static curve explains nearly as much as the model."""

NOTABLE_DEG = 5.0
"""Least lag of phase that is told, in degrees."""

NEARLY_ALL = 0.98
"""From this share of what the model explains on, a static curve explains nearly as much."""

NEXT_TO_NOTHING = 0.1
"""A model that explains less of the output is not judged by what a static curve does of that."""

CURVE_ORDER = 4
"""Order of the polynomial that stands for the static curve."""

LAG_EFFECTS = (
    "delay",
    "pneumatic_lag",
    "valve_flow",
    "line_resonance",
    "sensor_lag",
    "sensor_resonance",
)
"""Effects that are a lag behind one frequency, and little else."""


def motion_shown_issues(base: BaseFit, answer: Diagnosis) -> tuple[Issue, ...]:
    """What the logs leave open of the motion, whatever the model.

    Parameters
    ----------
    base
        The base fit; a model without a spring has no static curve, and no rest to lag behind.
    answer
        The diagnosis; one with a tie of lags tells of them.
    """
    if not base.candidate.has_spring:
        return ()
    return (*_one_frequency(base, answer), *_nearly_static(base))


def static_share(problem: Problem, squares: float) -> float:
    """What a static curve explains of the first output, as a share of what a model explains.

    1 − SS over the sum of squares about the mean of every log, for the polynomial of order 4 with a
    zero for every log and for the model; 0 where the model explains next to nothing.

    Parameters
    ----------
    problem
        The model's problem.
    squares
        Sum of squares that the model leaves.
    """
    first = problem.outputs[0]
    used = [segment.used[first] for segment in problem.segments]
    parts = list(zip(problem.segments, used, strict=True))
    u = np.concatenate([segment.input[own] for segment, own in parts])
    y = np.concatenate([segment.outputs[first][own] for segment, own in parts])
    owner = np.repeat(problem.owner, [int(own.sum()) for own in used])
    zeros = (owner[:, None] == np.unique(owner)).astype(float)
    scaled = (u - u.mean()) / max(float(np.std(u)), np.finfo(float).tiny)
    curve = np.column_stack([zeros, *(scaled**k for k in range(1, CURVE_ORDER + 1))])
    left = [y - columns @ np.linalg.lstsq(columns, y)[0] for columns in (zeros, curve)]
    whole, static = (float(r @ r) for r in left)
    explained = whole - squares
    return (whole - static) / explained if explained > NEXT_TO_NOTHING * whole else 0.0


def _one_frequency(base: BaseFit, answer: Diagnosis) -> tuple[Issue, ...]:
    problem = base.candidate.problem
    first, driving = problem.outputs[0], problem.logs[0].input
    named = [cause for cause in answer.causes if cause.effect in LAG_EFFECTS]
    tied = {name for tie in answer.alternatives for name in tie.effects}
    found = sine_lag(problem.logs, first, falls=_falls(base))
    if found is None or any(cause.effect in tied for cause in named):
        return ()
    hz, lag_s = found
    degrees = 360.0 * hz * lag_s
    if degrees < NOTABLE_DEG:
        return ()
    if named:
        open_is = (
            f"that {lowered(named[0].title)} is a part of it, and not another lag or the damping "
            "of the model, rests on little"
        )
    else:
        open_is = (
            "one frequency does not tell whether that is a delay, a lag before the actuator, or "
            "the damping and inertia of the model"
        )
    told = (
        f"{first} lags {lag_s:.2g} s ({degrees:.0f} degrees) behind {driving}, which is a sine of "
        f"{hz:.3g} Hz and nothing else: {open_is}"
    )
    more = bool(base.judges) and sine_lag((*problem.logs, *base.judges), first) is None
    remedy = "fit what is held out, too, which holds more" if more else "record steps or a chirp"
    return (Issue(ONE_FREQUENCY, "info", told, remedy),)


def _falls(base: BaseFit) -> bool:
    """Whether the model's output falls as the input rises slowly."""
    problem = base.candidate.problem
    theta = problem.theta(base.candidate.minimum.point)
    u = np.concatenate([segment.input for segment in problem.segments])
    ends = problem.model.static_output(theta, np.array([u.min(), u.max()]), problem.outputs[0])
    return bool(ends[1] < ends[0])


def _nearly_static(base: BaseFit) -> tuple[Issue, ...]:
    """That a curve is nearly all; of a log that moves quickly it is most, for it rests more."""
    problem = base.candidate.problem
    if len(problem.outputs) > 1 or moves_quickly(held_experiments(problem.logs)):
        return ()
    first = problem.outputs[0]
    share = static_share(problem, base.candidate.squares * base.sigma[first] ** 2)
    if share < NEARLY_ALL:
        return ()
    told = percent(share) if share < 0.995 else "nearly all"
    return (
        Issue(
            NEARLY_STATIC,
            "info",
            f"{first} is nearly static here: {problem.logs[0].input} changes slowly, and a curve "
            f"of it alone explains {told} of what the model explains, so these logs show little of "
            "the motion",
            "record faster changes of the input, sampled faster, to see the motion",
        ),
    )
