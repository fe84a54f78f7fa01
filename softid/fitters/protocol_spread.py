"""Ru's protocol against the simultaneous fit on the same noisy data: how M scatters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.channels import read_only
from softid.errors import UsageError
from softid.fitters.muscle import sequential
from softid.fitters.output_error import draft_fit
from softid.fitters.problem import Problem
from softid.log import Log
from softid.models.muscle import Muscle
from softid.parallel import in_parallel

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Scatter:
    """Estimates of one number over noise draws.

    Attributes
    ----------
    values
        One estimate per draw, shape (n,).
    truth
        The true number.
    """

    values: Array
    truth: float

    @property
    def bias(self) -> float:
        """Mean − truth."""
        return float(self.values.mean()) - self.truth

    @property
    def bias_stderr(self) -> float:
        """Standard error of the bias, sd/√n."""
        return self.spread / float(np.sqrt(self.values.size))

    @property
    def spread(self) -> float:
        """Standard deviation over the draws."""
        return float(self.values.std(ddof=1))

    @property
    def quartiles(self) -> tuple[float, float, float]:
        """Lower quartile, median and upper quartile."""
        low, middle, high = np.quantile(self.values, [0.25, 0.5, 0.75])
        return float(low), float(middle), float(high)

    @property
    def negative_share(self) -> float:
        """Share of draws whose estimate is not positive, which no inertia can be."""
        return float(np.mean(self.values <= 0.0))


@dataclass(frozen=True, eq=False)
class InertiaDraws:
    """M from the same noisy logs by two ways.

    Attributes
    ----------
    sequential
        The paper's protocol in three stages; M as its extremes give it, negative or not.
    simultaneous
        Output error of all seven parameters on both logs at once.
    unit
        Unit of M.
    converged
        How many simultaneous fits reached their optimum.
    """

    sequential: Scatter
    simultaneous: Scatter
    unit: str
    converged: int


def inertia_draws(
    steps: Log,
    sine: Log,
    *,
    truth: float,
    noise_output: float,
    noise_kpa: float,
    draws: int,
    seed: int = 0,
    workers: int = 2,
) -> InertiaDraws:
    """Add noise to two noise-free logs again and again, and estimate M by both ways each time.

    Both ways take the output as contraction with a known zero. The simultaneous fit starts from
    the noisy data, as every fit does. Every draw has a generator of its own, so the result
    does not depend on the number of workers.

    Parameters
    ----------
    steps
        Noise-free steps that settle at many levels.
    sine
        Noise-free sine of several periods.
    truth
        The true M.
    noise_output, noise_kpa
        Standard deviations of the white noise of the output, in its unit, and of the pressure.
    draws
        How often, at least 2.
    seed
        Of all draws.
    workers
        Processes or, where the system cannot fork, threads.

    Raises
    ------
    UsageError
        There are fewer than two draws.

    Source: Ru et al. 2019, section "Parameter identification".
    """
    if draws < 2:
        raise UsageError("a spread needs two draws", value=draws, remedy="take 100")

    def one(rng: np.random.Generator) -> tuple[float, float, bool]:
        noisy = [_with_noise(log, noise_output, noise_kpa, rng) for log in (steps, sine)]
        by_stages = sequential(noisy[0], noisy[1])
        at_once, reached = _simultaneous(noisy)
        return by_stages.inertia.mass, at_once, reached

    generators = np.random.default_rng(seed).spawn(draws)
    rows = in_parallel(one, generators, workers=workers)
    model = Muscle()
    return InertiaDraws(
        Scatter(read_only(np.array([row[0] for row in rows])), truth),
        Scatter(read_only(np.array([row[1] for row in rows])), truth),
        model.parameters()["M"].unit,
        sum(row[2] for row in rows),
    )


def _with_noise(log: Log, noise_output: float, noise_kpa: float, rng: np.random.Generator) -> Log:
    (output,) = log.outputs
    n = len(log)
    channels = {
        "pressure": log.pressure_kpa + rng.normal(0.0, noise_kpa, n),
        output: log.channels[output].values + rng.normal(0.0, noise_output, n),
    }
    return Log.from_arrays(log.time_s, channels, outputs=(output,), name=log.name)


def _simultaneous(logs: list[Log]) -> tuple[float, bool]:
    """M by output error on all logs at once, and whether the optimum was reached.

    The starts are those of every fit, from the data. The stages' own result is no safe start: they
    may put c2 at zero, a flat place on a logarithmic scale that the optimiser never leaves.
    """
    model = Muscle()
    problem = Problem(model, model.parameters(), logs, zeros=False)
    starts = [
        guess.values_dict() for guess in model.guess(problem.plain_segments, problem.outputs[0])
    ]
    found = draft_fit(problem, starts)
    mass = problem.theta(found.unknowns)[problem.parameters.names.index("M")]
    return float(mass), found.status.success
