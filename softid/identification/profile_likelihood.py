"""Profile likelihood of one parameter of a finished fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, UsageError
from softid.fitters.objective import Objective
from softid.fitters.problem import Problem
from softid.identification.errors_in_variables import with_input_errors
from softid.identification.input_errors import InputErrors
from softid.identification.parameter_covariance import errors_of
from softid.identification.refitting import refitted
from softid.log import Log
from softid.parallel import matrices_on_one_thread
from softid.results import FitResult
from softid.uncertainty.profile import ProfileResult, profile

Array = npt.NDArray[np.float64]

REFIT_EVALUATIONS = 200
"""Evaluations of one refit, half of those of a fit: it begins at the optimum or at the refit
before, and every point of the profile takes two."""


@matrices_on_one_thread()
def profile_parameter(result: FitResult, logs: Log | Sequence[Log], name: str) -> ProfileResult:
    """Refit all other parameters along one of them and find where the cost rises to 95 %.

    Unlike the interval from the covariance, the profile follows a valley that bends, and says so
    when the logs do not bound the parameter on a side. It allows for noise of the input by as much
    as that interval does. A term that the fit went on without is none in the profile, too, while
    the interval from the covariance allows for one.

    Parameters
    ----------
    result
        A successful fit.
    logs
        The logs that were fitted, in any order.
    name
        A parameter that was free.

    Returns
    -------
    ProfileResult
        Its ``ci95`` is None on a side that the logs leave open.

    Raises
    ------
    UsageError
        The parameter is unknown or was not free.
    InputError
        A log lacks a channel of the model.
    IdentificationError
        The parameter does not change the response at all.

    Examples
    --------
    >>> import softid
    >>> from softid.synthesis import bundled_datasets
    >>> log = softid.load(bundled_datasets() / "data" / "oscillator_steps.csv")
    >>> found = softid.fit(log, model="oscillator")
    >>> low, high = profile_parameter(found, log, "Q").ci95
    >>> low < found.parameter("Q").value < high
    True
    """
    problem, optimum = refitted(result, logs)
    parameters = problem.parameters
    if name not in parameters.free:
        raise UsageError(
            f"{name} was not free in this fit",
            remedy=f"choose from {', '.join(parameters.free)}",
        )
    covariance = errors_of(problem, optimum).covariance
    if covariance is not None:
        errors = InputErrors.as_recorded(problem.logs)
        covariance = with_input_errors(covariance, problem, optimum, errors)
    row = covariance.names.index(name) if covariance and name in covariance.names else None
    if covariance is None or row is None or covariance.sd[row] is None:
        raise IdentificationError(
            f"{name} does not change the response, or only together with others",
            remedy="fix it, or fit logs that show it",
        )
    p = parameters[name]

    def solve(rival: Problem, starts: Starts) -> tuple[float, Array]:
        begins = (starts.nearest, starts.at_optimum())
        ended = [Objective(rival, optimum.sigma).solve(z, REFIT_EVALUATIONS) for z in begins]
        best = min(ended, key=lambda found: found.normal.cost)
        return 2.0 * best.normal.cost, best.point

    return profile(
        ProfileRefits(problem, name, optimum.unknowns, result.values, solve).refit,
        p.value,
        sd=float(covariance.sd[row] or 0.0),
        cost_per_variance=float(covariance.cost_per_variance[row]),
        optimum_cost=2.0 * optimum.cost,
        scale=p.scale,
        lower=p.lower,
        upper=p.upper,
        degrees_of_freedom=float(covariance.degrees_of_freedom[row] or np.inf),
    )


class Starts(NamedTuple):
    """Where a refit with a parameter held may begin, each of shape (U − 1,).

    Attributes
    ----------
    predicted
        Straight on from where the last refits on the way from the optimum ended, or along the
        tangent there.
    nearest
        What the last of them found.
    at_optimum
        Asks for the values of the optimum, which takes a simulation.
    """

    predicted: Array
    nearest: Array
    at_optimum: Callable[[], Array]


class ProfileRefits:
    """Refits along one parameter, which go on from the optimum and from the refits before.

    A valley that bends has left the other parameters of the optimum behind, and a start there may
    end in a false minimum.

    Parameters
    ----------
    problem
        The fit.
    name
        The parameter.
    unknowns
        The optimum, shape (U,).
    values
        Parameter → value there.
    solve
        From a problem that holds the parameter and starts to the least cost Σ (r/σ)² that it finds,
        and where, shape (U − 1,).
    matrix
        Normal equations at the optimum, shape (U, U), for the tangent there; None to begin without.
    """

    def __init__(
        self,
        problem: Problem,
        name: str,
        unknowns: Array,
        values: Mapping[str, float],
        solve: Callable[[Problem, Starts], tuple[float, Array]],
        matrix: Array | None = None,
    ) -> None:
        self._problem = problem
        self._name = name
        self._values = dict(values)
        self._solve = solve
        own = problem.free.index(name)
        self._found = {float(values[name]): np.delete(unknowns, own)}
        self._tangent = np.zeros(unknowns.size - 1)
        if matrix is not None:
            rows = np.delete(matrix, own, axis=0)
            others, along = np.delete(rows, own, axis=1), rows[:, own]
            self._tangent = np.asarray(np.linalg.lstsq(others, -along, rcond=None)[0], np.float64)

    def refit(self, held: float) -> float:
        """Least cost Σ (r/σ)² with the parameter held at a value."""
        fixed = self._problem.parameters.with_fixed({self._name: held})
        rival = Problem(self._problem.model, fixed, self._problem.logs)
        cost, point = self._solve(rival, self._starts(rival, held))
        if np.isfinite(cost):
            self._found[held] = point
        return cost

    def _starts(self, rival: Problem, held: float) -> Starts:
        first = self._values[self._name]
        low, high = sorted((first, held))
        passed = sorted((v for v in self._found if low <= v <= high), key=lambda v: abs(v - first))
        *_, last = passed
        nearest = self._found[last]
        slope = self._tangent
        if len(passed) > 1:
            slope = (nearest - self._found[passed[-2]]) / (self._at(last) - self._at(passed[-2]))
        predicted = nearest + slope * (self._at(held) - self._at(last))
        return Starts(
            np.clip(predicted, *rival.bounds()),
            nearest,
            lambda: rival.unknowns(self._values | {self._name: held}),
        )

    def _at(self, value: float) -> float:
        """The unknown of a value."""
        is_log = self._problem.parameters[self._name].scale == "log"
        return float(np.log(value)) if is_log else value
