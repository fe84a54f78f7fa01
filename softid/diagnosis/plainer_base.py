"""A plainer base, for logs over which a term of the asked one does not carry over.

A free term goes where the misfit is: a damping that may grow with the pressure follows what
hysteresis and creep do to the log of the highest pressure, and is wrong for the next. Such a term
fits the logs that it knows better, and predicts a log that was left out worse.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softid.diagnosis.assessment import assess
from softid.diagnosis.beginning import Asked, Beginning, Given
from softid.errors import Issue
from softid.log import LogSet
from softid.models.base import Model

FEWEST_LOGS = 3
"""With two logs one that is left out is predicted from one alone."""

BETTER = 0.95
"""The plainer model must leave less than this share on the logs left out, in the geometric mean."""


def plainer(given: Given, asked: Asked, start: Beginning) -> tuple[Asked, Beginning]:
    """What to begin with: as asked, or with a plainer base that predicts logs left out better.

    Parameters
    ----------
    given
        The logs.
    asked
        What the user asked for; a base with bounds or fixed values of the user's stays.
    start
        The base as asked for; one that leaves noise stays.

    Returns
    -------
    asked, start
        The beginning remembers the one that it takes the place of.
    """
    model = start.base.problem.model
    other = model.plainer()
    if other is None or asked.parameters is not None or len(given.logs) < FEWEST_LOGS:
        return asked, start
    rng = np.random.default_rng(asked.seed)
    if not assess(start.base, start.base, start.scale, rng=rng).structured:
        return asked, start
    if share_left(given, asked, other, model) > BETTER:
        return asked, start
    changed = replace(asked, model=other, instead_of=start)
    return changed, changed.begin(given.logs, given.hold_out, thorough=False)


def share_left(given: Given, asked: Asked, one: Model, other: Model) -> float:
    """Error of one model over that of another on logs left out in turn, in the geometric mean.

    Parameters
    ----------
    given
        The logs, of which those to explain are left out one at a time.
    asked
        What else the user asked for.
    one, other
        The models.
    """
    logs = given.logs.logs
    ratios = []
    for k, left_out in enumerate(logs):
        rest = LogSet((*logs[:k], *logs[k + 1 :]))
        errors = []
        for model in (one, other):
            begun = replace(asked, model=model).begin(rest, (left_out,), thorough=False)
            errors.append(begun.held.rms(begun.base))
        ratios.append(errors[0] / errors[1])
    return float(np.exp(np.mean(np.log(ratios))))


def remark_on(start: Beginning, *, unit: str, factor: float) -> tuple[Issue, ...]:
    """The remark that a plainer base is extended, with what it gains alone; nothing for the asked.

    Parameters
    ----------
    start
        What was begun with.
    unit, factor
        In which unit people know the first output, and the factor to it.
    """
    if start.instead_of is None:
        return ()
    before, after = (factor * start.held.rms(base) for base in (start.instead_of.base, start.base))
    dropped = set(start.instead_of.base.problem.free) - set(start.base.problem.free)
    names = " and ".join(sorted(dropped))
    return (
        Issue(
            "plainer-base",
            "info",
            f"{names} of the {start.base.problem.model.name} model did not carry over to logs that "
            f"were left out one at a time, and what is found extends the model without them: the "
            f"held-out error is {after:.3g} {unit} without and {before:.3g} {unit} with them",
            "start from a params.json with --params to keep them",
        ),
    )
