"""Whether an input that jumps was held until the next sample, decided by what fits better."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.errors import Issue
from softid.fitters.output_error import output_error
from softid.fitters.problem import Problem
from softid.intersample import jumps
from softid.log import Log, LogSet

Array = npt.NDArray[np.float64]

BETTER_BY = 10.0
"""n·ln(mean square) must fall by this much: both readings have the same number of unknowns."""


def with_held_input(logs: LogSet) -> LogSet | None:
    """The logs with an input that is held where it jumps; None where that is settled or no matter.

    Parameters
    ----------
    logs
        Logs to fit; the input of those that say what it does between samples stays as it is.
    """
    open_ones = [log for log in logs if log.intersample is None]
    if not any(jumps(log.channels[log.input].values).size for log in open_ones):
        return None
    return LogSet(held(logs.logs))


def held(logs: Sequence[Log]) -> tuple[Log, ...]:
    """The logs with an input that is held where it jumps, and the remark that says so.

    Parameters
    ----------
    logs
        Logs to fit; the input of those that say what it does between samples stays as it is.
    """
    first = logs[0]
    issue = Issue(
        "held-input",
        "info",
        f"{first.input} jumps within single samples; held until the next sample it explains the "
        "output better than as straight lines between samples, and is taken so",
        "if it is not a command, record it faster, or declare it with --intersample straight",
    )
    changed = [log.with_intersample("held") for log in logs]
    return (replace(changed[0], issues=(*changed[0].issues, issue)), *changed[1:])


def explains_better(problem: Problem, unknowns: Array, other: LogSet) -> bool:
    """Whether a model explains other logs better than its own, of as many samples.

    Parameters
    ----------
    problem, unknowns
        A fit and its optimum; the search for the other one begins there.
    other
        The logs with another input.
    """
    values = dict(zip(problem.parameters.names, problem.theta(unknowns).tolist(), strict=True))
    changed = Problem(problem.model, problem.parameters, other.logs)
    draft = output_error(changed, [values], rng=np.random.default_rng(0), rounds=0)
    if not np.isfinite(draft.cost):
        return False
    return _misfit(problem, unknowns) - _misfit(changed, draft.unknowns) > BETTER_BY


def _misfit(problem: Problem, unknowns: Array) -> float:
    """n·ln(mean square) over all channels."""
    total = 0.0
    blocks = list(problem.blocks(unknowns, derivatives=False))
    for name in problem.outputs:
        residual = np.concatenate([b.residual for b in blocks if b.channel == name])
        total += residual.size * float(np.log(np.mean(residual**2) + np.finfo(float).tiny))
    return total
