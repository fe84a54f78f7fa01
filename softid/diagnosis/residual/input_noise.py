"""What the noise of the recorded input leaves of a true model.

The actuator follows the input that was there, the simulation the one that was recorded. Noise of
the gauge is averaged away as far as the course of the input allows; what is slow of it stays, goes
through the motion, and is large where the static curve is steep and nothing at rest. It is neither
white nor steady, so that it looks like a misfit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.logs.input_denoising import without_input_noise
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.motion import simulated
from softid.diagnosis.residual.noise_floor import NoiseFloor
from softid.diagnosis.residual.projection import basis_of, rows_of
from softid.log import Log

Array = npt.NDArray[np.float64]

DRAWS = 12
"""Draws of a noise that nobody knows; the mean square of what they make varies by a tenth."""

SEED = 0
"""Of those draws, the same in every log."""


@dataclass(frozen=True, eq=False)
class InputNoise:
    """Draws of what the noise of the input leaves of the first output of a true model.

    Attributes
    ----------
    draws
        One in each row, at the used samples of all segments, shape (D, m).
    """

    draws: Array

    @property
    def variance(self) -> float:
        """Mean square of the draws."""
        return float(np.mean(self.draws**2))

    def beside(self, floor: NoiseFloor) -> NoiseFloor:
        """The noise of both sensors together.

        Parameters
        ----------
        floor
            The noise of the output.
        """
        whole = floor.variance + self.variance
        spread = float(np.std(np.mean(self.draws**2, axis=1)))
        sd = float(np.hypot(floor.relative_sd * floor.variance, spread)) / whole
        return replace(floor, variance=whole, relative_sd=sd)

    def with_white(self, variance: float, *, rng: np.random.Generator) -> Array:
        """The draws with white noise of the output, one in each column, shape (m, D).

        Parameters
        ----------
        variance
            That of the output's noise.
        rng
            Draws it.
        """
        white = variance**0.5 * rng.standard_normal(self.draws.shape)
        found: Array = (self.draws + white).T
        return found


def input_noise(model: Candidate, sds: Mapping[str, float]) -> InputNoise | None:
    """Simulate what the noise of the input may have left; None where there is none.

    What the parameters make up for is taken away.

    Parameters
    ----------
    model
        A fit to logs whose input was averaged.
    sds
        Log → standard deviation of the noise of its input as it was recorded, in its unit.
    """
    problem = model.problem
    if not any(sds.get(log.name, 0.0) > 0.0 for log in problem.logs):
        return None
    draws = np.array([_draw(model, sds, seed) for seed in range(DRAWS)])
    first = problem.outputs[0]
    jacobian = np.concatenate([r.jacobian for r in rows_of(model) if r.channel == first])
    basis = basis_of(jacobian)
    return InputNoise(draws - (draws @ basis) @ basis.T)


def _draw(model: Candidate, sds: Mapping[str, float], seed: int) -> Array:
    """Change of the first output at its used samples with one draw of the noise, shape (m,)."""
    problem = model.problem
    first, moves = problem.outputs[0], []
    shifts = [_left(log, sds.get(log.name, 0.0), seed) for log in problem.logs]
    for k, segment in enumerate(problem.segments):
        shift = np.interp(segment.time_s, *shifts[problem.owner[k]])
        moved = replace(segment, input=segment.input + shift)
        change = simulated(model, k, moved) - simulated(model, k, segment)
        moves.append(change[segment.samples_of(segment.used[first])])
    return np.concatenate(moves)


def _left(log: Log, sd: float, seed: int) -> tuple[Array, Array]:
    """When, and what is left of a draw of the noise behind the averaging, each of shape (n,)."""
    whole = log.as_recorded
    channel = whole.channels[whole.input]
    noise = sd * np.random.default_rng((SEED, seed)).standard_normal(len(whole))
    channels = {**whole.channels, whole.input: replace(channel, values=channel.values + noise)}
    noisy = replace(whole, channels=channels)
    left = without_input_noise(noisy).channels[whole.input].values - channel.values
    return whole.time_s, left
