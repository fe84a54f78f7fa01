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

FURTHER = (4.0, 16.0, 64.0)
"""Factors by which it is raised further where the input is noisy. A judgement: an inertia that dies
out within a tenth of a sampling interval then does so within a few of them."""


@dataclass(frozen=True, eq=False)
class DroppedTerm:
    """A fit with a term that was left out afterwards.

    Attributes
    ----------
    problem, optimum
        The fit, the term as large as it may be without being seen.
    names
        Its parameters.
    """

    problem: Problem
    optimum: Optimum
    names: frozenset[str]

    def deviations(self, input_errors: InputErrors) -> dict[str, float]:
        """Unknown → its standard deviation beside the term, in internal coordinates.

        In a linear model it is the same however large the term is, so that it may be as large as it
        goes unseen: where a search ends at 1e-9 the derivatives by the logarithm vanish. But what
        noise of the input seems to tell of a term goes by its size, so the largest of several
        counts then.

        Parameters
        ----------
        input_errors
            Those of the logs.
        """
        found, is_noisy = self._deviations_at(self.optimum, input_errors)
        for factor in FURTHER if is_noisy else ():
            z = _with_term(self.problem, self.optimum.unknowns, self.names, factor)
            found = larger_of(found, self._deviations_at(_at(self.optimum, z), input_errors)[0])
        return found

    def _deviations_at(
        self, optimum: Optimum, input_errors: InputErrors
    ) -> tuple[dict[str, float], bool]:
        """The same with a term of one size, and whether noise of the input counts."""
        told = errors_of(self.problem, optimum).covariance
        if told is None:
            return {}, False
        covariance = with_input_errors(told, self.problem, optimum, input_errors)
        pairs = zip(covariance.names, covariance.sd, strict=True)
        known = {name: sd for name, sd in pairs if sd is not None and np.isfinite(sd)}
        return known, covariance is not told


def dropped_term(
    problem: Problem, optimum: Optimum, names: Collection[str], is_seen: Callable[[Array], bool]
) -> DroppedTerm:
    """The fit before a term was left out, with that term as large as it may be unseen.

    Parameters
    ----------
    problem, optimum
        The fit with the term.
    names
        Its parameters; those of a linear scale stay as they are.
    is_seen
        Whether the samples would show it, from the parameters θ, shape (K,).
    """
    z = optimum.unknowns
    for _ in range(MOST_RISES):
        further = _with_term(problem, z, names, RISE)
        if np.array_equal(further, z) or is_seen(problem.theta(further)):
            break
        z = further
    at_bound = optimum.at_bound.copy()
    at_bound[: len(problem.free)] &= ~_raised(problem, names)
    return DroppedTerm(problem, replace(_at(optimum, z), at_bound=at_bound), frozenset(names))


def _at(optimum: Optimum, z: Array) -> Optimum:
    return replace(optimum, unknowns=z, linearised=None)


def _raised(problem: Problem, names: Collection[str]) -> npt.NDArray[np.bool_]:
    """Which free parameters are those of a term, and have a logarithmic scale."""
    parameters = problem.parameters
    return np.array([n in names and parameters[n].scale == "log" for n in problem.free], bool)


def _with_term(problem: Problem, z: Array, names: Collection[str], factor: float) -> Array:
    """Unknowns with a term that is so many times as large.

    Where that is an inertia, logs that begin in motion begin with the same momentum: a velocity
    that is lost at once would throw a heavier actuator out of this world.
    """
    larger: Array = z.copy()
    larger[: len(problem.free)] += np.log(factor) * _raised(problem, names)
    if problem.model.inertia_parameter in names:
        larger[_velocities(problem)] /= factor
    return larger


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
