"""What a term that no sample shows leaves unknown of the other parameters.

A fit goes on without an inertia that dies out between two samples. That does not say that there is
none: a slow sine follows Q − Mω² and knows neither apart, and Q is off by Mω² if the inertia is
more than nothing. So the others are as well known as they are with the term, not as without.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.fitters.output_error import Optimum
from softid.fitters.problem import Problem
from softid.identification.errors_in_variables import with_input_errors
from softid.identification.input_errors import InputErrors
from softid.identification.parameter_covariance import errors_of
from softid.uncertainty import larger_of

Array = npt.NDArray[np.float64]

RISE = 2.0
"""Factor by which a dropped parameter is raised at a time until it would be seen."""

MOST_RISES = 100
"""Times that it is raised at most: 30 orders of magnitude."""


@dataclass(frozen=True, eq=False)
class DroppedTerm:
    """A fit with a term that was left out afterwards.

    Attributes
    ----------
    problem, optimum
        The fit, the term as large as it may be without being seen.
    """

    problem: Problem
    optimum: Optimum

    def deviations(self, input_errors: InputErrors) -> dict[str, float]:
        """Unknown → its standard deviation beside the term, in internal coordinates.

        In a linear model it is the same however large the term is, so that it may be as large as it
        goes unseen: where a search ends at 1e-9 the derivatives by the logarithm vanish.

        Parameters
        ----------
        input_errors
            Those of the logs.
        """
        problem, optimum = self.problem, self.optimum
        covariance = errors_of(problem, optimum).covariance
        if covariance is None:
            return {}
        covariance = with_input_errors(covariance, problem, optimum, input_errors)
        pairs = zip(covariance.names, covariance.sd, strict=True)
        return {name: sd for name, sd in pairs if sd is not None and np.isfinite(sd)}


def dropped_term(
    problem: Problem, optimum: Optimum, names: Collection[str], is_seen: Callable[[Array], bool]
) -> DroppedTerm:
    """The fit before a term was left out, with that term as large as it may be unseen.

    Where that is an inertia, logs that begin in motion begin with the same momentum: a velocity
    that is lost at once would throw a heavier actuator out of this world.

    Parameters
    ----------
    problem, optimum
        The fit with the term.
    names
        Its parameters; those of a linear scale stay as they are.
    is_seen
        Whether the samples would show it, from the parameters θ, shape (K,).
    """
    free = problem.free
    raised = np.array([n in names and problem.parameters[n].scale == "log" for n in free])
    step, slower = np.zeros(optimum.unknowns.size), np.ones(optimum.unknowns.size)
    step[: len(free)] = np.log(RISE) * raised
    if problem.model.inertia_parameter in names:
        slower[_velocities(problem)] = 1.0 / RISE
    z = optimum.unknowns
    for _ in range(MOST_RISES):
        further = slower * z + step
        if not step.any() or is_seen(problem.theta(further)):
            break
        z = further
    at_bound = optimum.at_bound.copy()
    at_bound[: len(free)] &= ~raised
    return DroppedTerm(problem, replace(optimum, unknowns=z, at_bound=at_bound, linearised=None))


def _velocities(problem: Problem) -> list[int]:
    """Where the initial velocities stand among the unknowns."""
    states = problem.model.start_states
    return [
        at
        for k in range(len(problem.segments))
        for at, name in zip(problem.state_positions(k), states, strict=False)
        if name == "v"
    ]


def deviations_beside(
    terms: Collection[DroppedTerm], least_sd: Mapping[str, float], input_errors: InputErrors
) -> dict[str, float]:
    """The larger of given deviations and those beside every term that was left out.

    Parameters
    ----------
    terms
        What was left out, in any order.
    least_sd
        Unknown → deviation in internal coordinates.
    input_errors
        Those of the logs.
    """
    return larger_of(least_sd, *(term.deviations(input_errors) for term in terms))
