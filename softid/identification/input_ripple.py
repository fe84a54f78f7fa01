"""Whether what seems to be noise of the input is a ripple that the actuator follows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.fitters.output_error import Optimum
from softid.fitters.problem import Problem
from softid.identification.input_denoising import without_input_noise
from softid.identification.input_errors import InputErrors, with_moved_inputs
from softid.log import Log

Array = npt.NDArray[np.float64]

TELLING = 6.0
"""Standard errors by which what averages leave differs between noise and a ripple that the output
follows, from which on it is said which: half of it is three."""

MOST_OF_NOISE = 1.25
"""Most that averages take away of a draw, in what they take away of the noise that was recorded:
the two differ by chance, and where they differ by more, averages do otherwise."""


def is_followed(problem: Problem, optimum: Optimum, errors: InputErrors) -> bool:
    """Whether the output follows what seems to be noise of the input, so that it is none.

    Averages leave more of the output unexplained then, by the power of the answer to what they take
    away. They bend a quick course as well, which leaves more whether or not there is noise: how
    much of that answer is due to noise is seen by what they take away of a draw. Where that is
    more than all of the answer, noise makes them bend otherwise, and nothing is told.

    Parameters
    ----------
    problem, optimum
        A fit.
    errors
        Draws of noise as large as the inputs seem to have.
    """
    logs = problem.logs
    smooth = [without_input_noise(log) for log in logs]
    noisy = [_with_added(log, errors.drawn[k]) for k, log in enumerate(smooth)]
    twice, again = ([without_input_noise(log) for log in own] for own in (smooth, noisy))
    recorded, averaged, drawn, smoother, redrawn = (
        _residuals(problem, optimum, logs, other) for other in (logs, smooth, noisy, twice, again)
    )
    variance = float(np.mean(recorded**2))
    answer = float(np.sum((averaged - recorded) ** 2)) / variance
    of_noise = float(np.sum((redrawn - drawn - smoother + averaged) ** 2)) / variance
    gained = float(np.sum(averaged**2) - np.sum(recorded**2)) / variance
    tells = TELLING * answer**0.5 < of_noise < MOST_OF_NOISE * answer
    return tells and gained > max(0.5 * answer, answer - of_noise)


def _with_added(log: Log, drawn: Callable[[int], Array] | None) -> Log:
    """A log with a draw of noise on its input, of which one is read at every sample."""
    if drawn is None:
        return log
    channel, noise = log.channels[log.input], np.resize(drawn(0), len(log))
    channels = {**log.channels, log.input: replace(channel, values=channel.values + noise)}
    return replace(log, channels=channels)


def _residuals(
    problem: Problem, optimum: Optimum, logs: Sequence[Log], others: Sequence[Log]
) -> Array:
    """Residuals of all channels in their scales, with the inputs of other logs."""
    moves = [
        other.channels[other.input].values - log.channels[log.input].values
        for log, other in zip(logs, others, strict=True)
    ]
    segments = with_moved_inputs(problem, [log.time_s for log in logs], moves)
    changed = Problem.with_segments(problem, segments)
    blocks = changed.blocks(optimum.unknowns, derivatives=False)
    return np.concatenate([block.residual / optimum.sigma[block.channel] for block in blocks])
