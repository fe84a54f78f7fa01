"""A look at the part of long logs in which the input moves most: another input is soon ruled out.

What an input does between its samples shows where it moves fast. There a wrong one leaves so much
more that a part of a long log says so, and only where that is not clear all of it is asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.fitters.levenberg_marquardt import NormalEquations, whole_gain
from softid.fitters.objective import Objective
from softid.fitters.problem import Problem
from softid.fitters.residual_whiteness import (
    TESTED_LAGS,
    WHITE_SDS,
    largest_sum,
    residuals_by_channel,
    squared_autocorrelation,
)
from softid.log import Log, LogSet

Array = npt.NDArray[np.float64]
Span = tuple[float, float]

LOOK = 5000
"""Samples of the parts of all logs together."""

LEAST_PART = 1000
"""Fewest samples of a part: it has an initial state and a zero of its own."""

LEAST_SAVING = 8
"""Times as many samples that all logs hold at least, for a look to be worth its evaluations."""

LOOKED = 3
"""Evaluations on the part: the first finds the state at its beginning, the others the optimum."""

LOOKED_AGAIN = 2
"""Evaluations with another input, which begin at the optimum with the logs' own."""

CLEARLY = 100.0
"""n·ln(mean square) by which another input leaves more: ten times what two of them may differ by to
be told apart, so that the rest of the logs does not turn it round."""

TRUSTED = 3.0
"""Times what the normal equations promise that is taken for possible: they may promise too
little."""


@dataclass(frozen=True, eq=False)
class LiveliestPart:
    """What a fit leaves over in the part of its logs in which the input moves most.

    Attributes
    ----------
    problem
        The model over that part.
    spans
        First and last time of the part, one for each log.
    left
        The normal equations at the optimum over the part.
    """

    problem: Problem
    spans: tuple[Span, ...]
    left: NormalEquations

    @classmethod
    def of(cls, problem: Problem, unknowns: Array) -> LiveliestPart | None:
        """From a fit at its optimum; None where the logs are too short for a look to save anything.

        None, too, where it leaves more than white noise: one part may then speak against what all
        of the log speaks for.

        Parameters
        ----------
        problem
            A fit.
        unknowns
            Its optimum, shape (U,).
        """
        size = LOOK // len(problem.logs)
        is_long = problem.n_samples >= LEAST_SAVING * LOOK and size >= LEAST_PART
        if not is_long or len(problem.outputs) > 1:
            return None
        spans = tuple(_liveliest(log, size) for log in problem.logs)
        part = _cut(problem, problem.logs, spans)
        start = part.free_unknowns(problem.values(unknowns))
        left = _left(part, start, LOOKED)
        return cls(part, spans, left) if _is_white(part, left.point) else None

    def rules_out(self, other: LogSet) -> bool:
        """Whether the model leaves clearly more under another input.

        Parameters
        ----------
        other
            The logs with that input.
        """
        part = _cut(self.problem, other.logs, self.spans)
        is_alike = part.at_rest == self.problem.at_rest and part.size == self.problem.size
        if not is_alike or not np.isfinite(self.left.cost):
            return False
        there = _left(part, self.left.point, LOOKED_AGAIN)
        if not np.isfinite(there.cost) or there.n != self.left.n:
            return False
        return promised(there) > _misfit(self.left, self.left.cost) + CLEARLY


def promised(there: NormalEquations) -> float:
    """n·ln(mean square) of one channel, lowered by `TRUSTED` times what one step promises.

    Parameters
    ----------
    there
        The normal equations of the unweighted residual.
    """
    return _misfit(there, max(there.cost - TRUSTED * whole_gain(there), 0.0))


def _misfit(normal: NormalEquations, cost: float) -> float:
    return normal.n * float(np.log(2.0 * cost / normal.n + np.finfo(float).tiny))


def _liveliest(log: Log, size: int) -> Span:
    """Of the runs of so many samples side by side that whose input moves most."""
    count = max(len(log) // size, 1)
    moves = np.diff(log.channels[log.input].values) ** 2
    k = int(np.argmax([moves[i * size : (i + 1) * size].sum() for i in range(count)]))
    last = min((k + 1) * size, len(log)) - 1
    return float(log.time_s[k * size]), float(np.nextafter(log.time_s[last], np.inf))


def _cut(problem: Problem, logs: Sequence[Log], spans: Sequence[Span]) -> Problem:
    parts = [log.between(*span) for log, span in zip(logs, spans, strict=True)]
    return Problem(problem.model, problem.parameters, parts)


def _is_white(part: Problem, unknowns: Array) -> bool:
    (residuals,) = residuals_by_channel(part, unknowns)
    squares = squared_autocorrelation(residuals, TESTED_LAGS)
    return sum(r.size for r in residuals) * squares <= largest_sum(WHITE_SDS)


def _left(part: Problem, start: Array, evaluations: int) -> NormalEquations:
    objective = Objective(part, dict.fromkeys(part.outputs, 1.0))
    return objective.solve(start, evaluations, accelerates=False).normal
