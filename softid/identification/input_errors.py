"""Draws of the errors of the input of some logs, added to what a fit simulates."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import numpy.typing as npt

from softid.fitters.problem import Problem
from softid.identification.input_denoising import input_noise_sd
from softid.log import Log
from softid.segment import Segment

Array = npt.NDArray[np.float64]

SEED = 0
"""Seed of the draws, the same in every log."""


@dataclass(frozen=True, eq=False)
class InputErrors:
    """Draws of the errors of the input of some logs.

    Attributes
    ----------
    time_s
        When each input was read, shape (n,) each.
    drawn
        For each log its draws in the unit of the input by their number, of shape (n,) each; None
        where there is no error.
    is_averaged
        Whether noise was averaged away before the fit.
    """

    time_s: Sequence[Array]
    drawn: Sequence[Callable[[int], Array] | None]
    is_averaged: bool

    @classmethod
    def as_recorded(cls, logs: Iterable[Log]) -> InputErrors:
        """White noise of the size that the input of each log shows.

        Parameters
        ----------
        logs
            Logs whose input was not averaged.
        """
        times: list[Array] = []
        drawn: list[Callable[[int], Array] | None] = []
        for k, log in enumerate(logs):
            sd = input_noise_sd(log.as_recorded)
            times.append(log.time_s if log.input_read_s is None else log.input_read_s)
            drawn.append(partial(_white, sd, times[k].size, k) if sd > 0.0 else None)
        return cls(times, drawn, is_averaged=False)

    @property
    def are_there(self) -> bool:
        """Whether any input has errors."""
        return any(draws is not None for draws in self.drawn)

    def added(self, problem: Problem, number: int, sign: float) -> list[Segment]:
        """The stretches of a problem with one draw on their inputs, or with that taken away.

        Parameters
        ----------
        problem
            Over the logs.
        number, sign
            Which draw, and by how much.
        """
        errors = [None if draws is None else sign * draws(number) for draws in self.drawn]
        return with_moved_inputs(problem, self.time_s, errors)


NO_INPUT_ERRORS = InputErrors((), (), is_averaged=True)
"""Of an input that is known exactly."""


def with_moved_inputs(
    problem: Problem, time_s: Sequence[Array], moves: Sequence[Array | None]
) -> list[Segment]:
    """The stretches of a problem with their inputs moved, straight between given times.

    Parameters
    ----------
    problem
        Over some logs.
    time_s, moves
        For each log times, and by how much its input is moved then, each of shape (n,); None for an
        input that stays.
    """
    found = []
    for segment, owner in zip(problem.segments, problem.owner, strict=True):
        move = moves[owner]
        if move is not None:
            move = np.interp(segment.time_s, time_s[owner], move)
            segment = replace(segment, input=segment.input + move)
        found.append(segment)
    return found


def _white(sd: float, size: int, log: int, number: int) -> Array:
    """A draw of white noise, the same whenever it is asked for.

    The first reading tells alone where a rest was: it is off by its standard deviation in each.
    """
    draw = np.random.default_rng((SEED, log, number)).standard_normal(size)
    draw[0] = np.copysign(1.0, draw[0])
    return sd * draw
