"""Errors of a finished fit by refits to residuals that are drawn again."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.channels import read_only
from softid.errors import UsageError
from softid.fitters.objective import Objective
from softid.fitters.problem import Problem
from softid.fitters.redrawn import redrawn
from softid.given_values import require_whole
from softid.identification.refitting import refitted
from softid.log import Log
from softid.parallel import in_parallel, matrices_on_one_thread
from softid.results import FitResult
from softid.uncertainty.bootstrap import BootstrapResult, common_block, resample

Array = npt.NDArray[np.float64]

REFIT_EVALUATIONS = 100
"""Evaluations of one refit, which begins at the optimum and ends nearby."""

FEWEST_DRAWS = 20
"""With fewer, the limits of a 95 % interval are the extremes of the draws."""


@matrices_on_one_thread()
def bootstrap_parameters(
    result: FitResult,
    logs: Log | Sequence[Log],
    *,
    draws: int = 200,
    seed: int = 0,
    workers: int | None = None,
) -> BootstrapResult:
    r"""Refit the model to its own response plus its residuals, drawn again in blocks.

    ŷ + e* replaces the measured output, with e* the residuals less their mean, stretched by
    √[n/(n − U)] for the U unknowns that were fitted to them, in blocks as long as their memory asks
    for; blocks of several outputs are drawn at the same places. Unlike errors from the covariance
    the intervals follow a response that bends within them. They hold as far as the residuals are
    noise: what the model gets wrong is drawn again as if it were. The input stays as it was
    recorded: its noise, which `fit` and `profile_parameter` allow for, is in none of the draws, so
    where `fit` says that it matters (issue ``noisy-input``) its own intervals are the ones to use.

    Parameters
    ----------
    result
        A successful fit.
    logs
        The logs that were fitted, in any order.
    draws
        Refits.
    seed
        Of the draws; each has a generator of its own, so the number of workers changes nothing.
    workers
        Processes that share the refits, or threads where the system cannot fork; by default as
        many as there are cores, four at most.

    Returns
    -------
    BootstrapResult
        Estimates, standard errors and 95 % intervals of the free parameters; the errors are refused
        where more than a tenth of the refits failed.

    Raises
    ------
    UsageError
        Fewer than 20 draws, a number of them, of workers or a seed that is none, or nothing was
        free.
    InputError
        A log lacks a channel of the model.

    Source: Politis and Romano, in *Exploring the Limits of Bootstrap*, 1992 (blocks in a circle);
    Davison and Hinkley, *Bootstrap Methods and their Application*, 1997, §6.2 and §8.2.3.

    Examples
    --------
    >>> import softid
    >>> from softid.synthesis import bundled_datasets
    >>> log = softid.load(bundled_datasets() / "data" / "oscillator_steps.csv")
    >>> found = softid.fit(log, model="oscillator")
    >>> drawn = bootstrap_parameters(found, log, draws=20, workers=1)
    >>> drawn.names, drawn.estimates.shape, drawn.failed
    (('M', 'N', 'Q'), (20, 3), 0)
    """
    seed = require_whole(seed, least=0, where="seed")
    draws = require_whole(draws, least=1, where="draws")
    if workers is not None:
        workers = require_whole(workers, least=1, where="workers")
    if draws < FEWEST_DRAWS:
        raise UsageError(
            "an interval needs more bootstrap draws", value=draws, remedy="take 200 or more"
        )
    problem, optimum = refitted(result, logs)
    if not problem.free:
        raise UsageError("no parameter was free in this fit", remedy="fit one at least")
    response, residuals = _response_and_residuals(problem, optimum.unknowns)
    block = common_block(residuals.values())
    count = len(problem.free)

    def estimate(generator: np.random.Generator) -> Array:
        own = int(generator.integers(2**63))
        drawn = {
            name: next(
                resample(
                    of_segments,
                    rng=np.random.default_rng(own),  # outputs share the places of their blocks
                    block=block,
                    fitted_parameters=problem.size // len(problem.outputs),
                )
            )
            for name, of_segments in residuals.items()
        }
        again = redrawn(
            problem, {name: _sums(response[name], drawn[name]) for name in problem.outputs}
        )
        ended = Objective(again, optimum.sigma).solve(optimum.unknowns, REFIT_EVALUATIONS)
        if not np.isfinite(ended.normal.cost):
            return np.full(count, np.nan)
        values = again.values(ended.point)
        return np.array([values[name] for name in again.free])

    rows = in_parallel(estimate, np.random.default_rng(seed).spawn(draws), workers=workers)
    return BootstrapResult(tuple(problem.free), read_only(np.array(rows)), block)


def _response_and_residuals(
    problem: Problem, unknowns: Array
) -> tuple[dict[str, list[Array]], dict[str, list[Array]]]:
    """Output → simulated output with its zero, and residual, of every segment.

    What is not used has no residual.
    """
    response: dict[str, list[Array]] = {name: [] for name in problem.outputs}
    residuals: dict[str, list[Array]] = {name: [] for name in problem.outputs}
    for block in problem.blocks(unknowns, derivatives=False):
        segment = problem.segments[block.segment]
        used, measured = segment.used[block.channel], segment.outputs[block.channel]
        residual = np.full(measured.size, np.nan)
        residual[used] = block.residual
        residuals[block.channel].append(residual)
        response[block.channel].append(measured - residual)
    return response, residuals


def _sums(response: Sequence[Array], drawn: Sequence[Array]) -> list[Array]:
    return [y + e for y, e in zip(response, drawn, strict=True)]
