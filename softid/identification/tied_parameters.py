"""Ties that the search cannot follow: told before it, or where it ended against one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, UsageError
from softid.fitters.levenberg_marquardt import Minimum, next_point
from softid.fitters.output_error import Optimum
from softid.fitters.problem import Problem
from softid.fitters.scouting import keeps_ties
from softid.parameters import Parameter
from softid.sentences import listed
from softid.tie_expressions import names_in_tie

Array = npt.NDArray[np.float64]

NEAR = 0.05
"""Share of a bound, or of the way to it from zero, within which a tied parameter rests against it:
a search whose steps end behind it halves them, and ends far closer. A judgement."""


def require_tied_starts(problem: Problem, starts: Sequence[Mapping[str, float]]) -> None:
    """Refuse ties that lead out of their bounds wherever the search could begin.

    Parameters
    ----------
    problem
        What is to be fitted.
    starts
        Parameter name → value, one mapping per start.

    Raises
    ------
    UsageError
        At every start a tied parameter is outside its bounds, or no finite number.
    """
    if problem.ties is None or any(keeps_ties(problem, start) for start in starts):
        return
    z = problem.free_unknowns(starts[0])
    p, value = _broken(problem, z)
    if not np.isfinite(value):
        raise UsageError(
            f"the tie {p.tie} gives {p.name} no finite value at {_taken(problem, p, z)}, where the "
            "search begins",
            where=f"parameter {p.name}",
            remedy="tie it by another expression",
        )
    raise UsageError(
        f"the tie {p.tie} takes {p.name} out of its bounds, {p.lower:g} to {p.upper:g}, where the "
        "search begins",
        where=f"parameter {p.name}",
        value=float(f"{value:.6g}"),
        remedy="tie it by an expression that stays positive"
        if p.scale == "log" and value <= 0.0
        else f"widen the bounds of {p.name}, or bound {_others(p)} such that the tie stays within",
    )


def require_room_of_ties(problem: Problem, optimum: Optimum) -> None:
    """Refuse an end at which a tie, and not the logs, holds the parameters where they are.

    Parameters
    ----------
    problem, optimum
        What was fitted, and where the search ended.

    Raises
    ------
    IdentificationError
        It did not reach an optimum, and the next step would take a tied parameter, which lies next
        to a bound, out of it.
    """
    if problem.ties is None or optimum.status.success or optimum.linearised is None:
        return
    z = optimum.unknowns
    reach, ended = problem.reach(), Minimum(z, optimum.linearised, 0, optimum.offset)
    step = next_point(ended, *problem.bounds(), reach) - z
    beyond = z + np.clip(step, -reach, reach)
    if np.isfinite(problem.theta(beyond)).all():
        return
    p, wanted = _broken(problem, beyond)
    value = problem.values(z)[p.name]
    bound = p.upper if wanted > p.upper else p.lower
    if not (np.isfinite(wanted) and abs(value - bound) <= NEAR * max(abs(value), abs(bound))):
        return
    raise IdentificationError(
        f"the best fit lies beyond the bound {bound:g} of {p.name}, against which the tie {p.tie} "
        "holds the search",
        where=f"parameter {p.name}",
        value=float(f"{value:.6g}"),
        remedy=f"widen the bounds of {p.name}, or tie it by another expression",
    )


def _broken(problem: Problem, z: Array) -> tuple[Parameter, float]:
    """The first tied parameter that is outside its bounds, and what its tie gives."""
    assert problem.ties is not None
    names, theta = problem.parameters.names, problem.theta(z)
    k = int(np.flatnonzero(~np.isfinite(theta))[0])
    return problem.parameters[names[k]], float(problem.ties.computed(theta)[k])


def _others(p: Parameter) -> str:
    return listed(sorted(names_in_tie(p.tie or "", where=f"parameter {p.name}")))


def _taken(problem: Problem, p: Parameter, z: Array) -> str:
    """What the tie is computed from."""
    values = problem.values(z)
    names = sorted(names_in_tie(p.tie or "", where=f"parameter {p.name}"))
    return listed(f"{name} = {values[name]:.4g}" for name in names)
