"""What a gauge adds to the input that it records: noise, and the rounding of coarse steps."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from softid.channels import is_command
from softid.excitation import find_quantisation, run_starts
from softid.identification.input_denoising import input_noise_sd
from softid.log import Log

Array = npt.NDArray[np.float64]

BLURRED = 0.4
"""Noise of so much of a step blurs the rounding: the mean of many samples is known, and what is
left of each counts as noise already."""

LEAST_RUNS = 20
"""Fewest changes of value that a gauge shows: so few values one after the other are the levels of a
command."""

TO_NEXT = 0.5
"""Share of the changes that lead to a neighbouring step: a gauge passes them one by one, and a
command that is set jumps."""

LEAST_PASSED, LEAST_LONG = 4, 4
"""Fewest values that are passed on the way from one to another, and intervals that each lasts, to
see on the output whether they were passed or set."""

UNEVEN = 0.4
"""Difference of the output's moves in the two halves of such values, as a share of both, from which
on they were set: it passes evenly what is passed evenly, and answers to a level that is set. A
motion of first order has so much, tanh(T/4τ), where a level lasts T = 1.7 of its time constants."""

FEWEST_CODES = 16
"""Values over the range that a gauge has at least, of which the output does not tell; a judgement,
as four bits are less than any converter has, and a dozen levels are usual for a staircase."""


@dataclass(frozen=True, eq=False)
class GaugeErrors:
    """Errors of a recorded input.

    Attributes
    ----------
    sd
        Standard deviation of its noise, in its unit.
    step
        Step of its converter, in its unit; 0 where the noise blurs it.
    time_s, readings
        When and what was recorded, each of shape (n,); empty without a step.
    """

    sd: float = 0.0
    step: float = 0.0
    time_s: Array = field(default_factory=lambda: np.empty(0))
    readings: Array = field(default_factory=lambda: np.empty(0))

    @property
    def are_there(self) -> bool:
        """Whether the gauge has noise or steps."""
        return self.sd > 0.0 or self.step > 0.0

    def rounding(self, time_s: Array, rng: np.random.Generator) -> Array:
        """A draw of what rounding hides at some times, alike wherever the reading is the same.

        A held pressure between two steps is off by as much as half a step for as long as it is
        held, by another amount at every level, and by the same whenever that level is set again: no
        mean over samples takes that away. Nothing is hidden of a run of equal readings that is
        entered at one end and left at the other, for it passes the step.

        Parameters
        ----------
        time_s
            The times, shape (m,), which need not be those of all readings.
        rng
            Draws the errors.

        Returns
        -------
        Array
            In the unit of the input, shape (m,).

        Examples
        --------
        >>> time_s = np.arange(6.0)
        >>> gauge = GaugeErrors(0.0, 1.0, time_s, np.array([0.0, 1.0, 1.0, 2.0, 2.0, 2.0]))
        >>> found = gauge.rounding(time_s, np.random.default_rng(0))
        >>> found[1:3].tolist(), bool(np.ptp(found[3:]) == 0.0 < abs(found[3]) <= 0.5)
        ([0.0, 0.0], True)
        """
        starts = run_starts(self.readings)
        moves = np.round(np.diff(self.readings[starts]) / self.step)
        before, after = np.concatenate(([0.0], moves)), np.concatenate((moves, [0.0]))
        passes = (before == after) & (np.abs(before) == 1.0)
        levels, level = np.unique(self.readings[starts], return_inverse=True)
        errors = np.where(passes, 0.0, self.step * (rng.random(levels.size) - 0.5)[level])
        read = np.repeat(errors, np.diff(starts, append=self.readings.size))
        found: Array = np.interp(time_s, self.time_s, read)
        return found


NO_ERRORS = GaugeErrors()
"""Errors of a gauge of which nothing is known."""


def gauge_errors(log: Log) -> GaugeErrors:
    """The errors of the input of a log.

    Parameters
    ----------
    log
        A log as it was recorded.
    """
    sd = input_noise_sd(log)
    step = _hidden_step(log, sd)
    if step == 0.0:
        return GaugeErrors(sd)
    return GaugeErrors(sd, step, log.time_s, log.channels[log.input].values)


def _hidden_step(log: Log, sd: float) -> float:
    """Step of the converter of an input; 0 where its rounding hides nothing."""
    values = log.channels[log.input].values
    grid = None if is_command(log.input) else find_quantisation(values)
    if grid is None or sd >= BLURRED * grid.step:
        return 0.0
    moves = np.abs(np.diff(values[run_starts(values)])) / grid.step
    if moves.size < LEAST_RUNS or np.mean(np.round(moves) == 1.0) < TO_NEXT:
        return 0.0
    return 0.0 if _are_set(log, grid.step) else grid.step


def _are_set(log: Log, step: float) -> bool:
    """Whether the values of an input are levels that were set, as those of a staircase.

    The output answers to a level that is set by a motion that ends, and goes on evenly through what
    is only read in steps.

    Parameters
    ----------
    log
        The log.
    step
        Distance of neighbouring values.
    """
    values, output = log.channels[log.input].values, log.channels[log.outputs[0]].values
    starts = run_starts(values)
    moves = np.round(np.diff(values[starts]) / step)
    passed = np.flatnonzero((moves[1:] == moves[:-1]) & (np.abs(moves[1:]) == 1.0))
    begin, end = starts[passed + 1] - 1, starts[passed + 2] - 1
    middle = 0.5 * (log.time_s[begin] + log.time_s[end])
    half_way = np.interp(middle, log.time_s, output)
    halves = np.array([half_way - output[begin], output[end] - half_way]) * moves[passed]
    tells = (end - begin >= LEAST_LONG) & np.isfinite(halves).all(axis=0)
    if np.count_nonzero(tells) < LEAST_PASSED:
        return float(np.ptp(values)) < (FEWEST_CODES - 1) * step
    first, second = halves[:, tells].sum(axis=1)
    return bool(abs(first - second) > UNEVEN * (abs(first) + abs(second)))
