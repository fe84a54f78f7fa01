"""A reduced base, for logs over which a term of the one that was asked for does not carry over.

A free term goes where the misfit is: a damping that may grow with the pressure follows what
hysteresis and creep do to the log of the highest pressure, and is wrong for the next. Such a term
fits the logs that it knows better, and predicts a log that was left out worse.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softid.diagnosis.base.base_fit import BaseFit, Recordings, Request
from softid.diagnosis.residual.assessment import assess
from softid.errors import Issue
from softid.log import LogSet
from softid.models.base import Model
from softid.sentences import listed

FEWEST_LOGS = 3
"""With two logs one that is left out is predicted from one alone."""

PLAINER_SHARE = 0.95
"""The plainer model must leave less than this share on the logs left out, in the geometric mean."""


def reduced_if_better(
    recordings: Recordings, request: Request, base: BaseFit
) -> tuple[Request, BaseFit]:
    """The base as asked for, or a reduced one that predicts logs left out better.

    Parameters
    ----------
    recordings
        The logs.
    request
        What the user asked for; a base with bounds or fixed values of the user's stays.
    base
        Its fit; one that leaves noise stays.

    Returns
    -------
    request, base
        The base remembers the one that it takes the place of.
    """
    model = base.candidate.problem.model
    other = model.plainer()
    if other is None or request.parameters is not None or len(recordings.logs) < FEWEST_LOGS:
        return request, base
    rng = np.random.default_rng(request.seed)
    candidate, gauges = base.candidate, base.gauges
    if not assess(candidate, candidate, base.scale, rng=rng, gauges=gauges).structured:
        return request, base
    if share_left(recordings, request, other, model) > PLAINER_SHARE:
        return request, base
    changed = replace(request, model=other, instead_of=base)
    return changed, changed.fit_base(recordings.logs, recordings.hold_out, thorough=False)


def share_left(recordings: Recordings, request: Request, one: Model, other: Model) -> float:
    """Error of one model over that of another on logs left out in turn, in the geometric mean.

    Parameters
    ----------
    recordings
        The logs, of which those to explain are left out one at a time.
    request
        What else the user asked for.
    one, other
        The models.
    """
    logs = recordings.logs.logs
    ratios = []
    for k, left_out in enumerate(logs):
        rest = LogSet((*logs[:k], *logs[k + 1 :]))
        errors = []
        for model in (one, other):
            begun = replace(request, model=model).fit_base(rest, (left_out,), thorough=False)
            errors.append(begun.held_out.rms(begun.candidate))
        ratios.append(errors[0] / errors[1])
    return float(np.exp(np.mean(np.log(ratios))))


def reduced_base_issues(base: BaseFit, *, unit: str, factor: float) -> tuple[Issue, ...]:
    """That a reduced base is extended, with what it gains alone; nothing for the one asked for.

    Parameters
    ----------
    base
        What is extended.
    unit, factor
        In which unit people know the first output, and the factor to it.
    """
    if base.instead_of is None:
        return ()
    asked_for, reduced = base.instead_of.candidate, base.candidate
    before, after = (factor * base.held_out.rms(model) for model in (asked_for, reduced))
    dropped = set(asked_for.problem.free) - set(reduced.problem.free)
    names = listed(sorted(dropped))
    return (
        Issue(
            "plainer-base",
            "info",
            f"{names} of the {reduced.problem.model.name} model did not carry over to logs that "
            f"were left out one at a time, and what is found extends the model without them: the "
            f"held-out error is {after:.3g} {unit} without and {before:.3g} {unit} with them",
            "start from a params.json with --params to keep them",
        ),
    )
