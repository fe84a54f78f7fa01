"""What the noise of the recorded input makes of parameters that are fitted as if it had none.

The simulation follows the noise of a gauge, the actuator does not. The derivatives of the output
hold what the model does with the noise, and JᵀJ counts that as information: of a slow log it may be
nearly all that is said of an inertia. And where parameters calm what the noise stirs up, the fit
moves them so, as the slope of a line through points with errors in both variables is too flat.

Both are seen by more of the same: noise of the same size is added to the input, and what that does
on the average to JᵀJ and to the gradient Jᵀr, the recorded noise has done to them once already
(Cook and Stefanski 1994, simulation and extrapolation).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import numpy.typing as npt

from softid.fitters.normal_equations import Linearised, linearise
from softid.fitters.output_error import Optimum
from softid.fitters.problem import Problem
from softid.identification.input_denoising import input_noise_sd, without_input_noise
from softid.identification.unknown_names import unknown_names
from softid.log import Log
from softid.segment import Segment
from softid.uncertainty import Covariance

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

PAIRS = 3
"""Draws of the noise, each of which is added and taken away: what is odd in it goes. Three tell how
much they differ, to a factor."""

MOST_NOISE = 1.0 - 1e-4
"""Share of what is known in a direction that noise may make: rounding and few draws may find more
than there is."""

NEGLIGIBLE = 0.05
"""Share by which a standard error may grow before more than one pair is drawn and it counts."""

FARTHEST = 1.5
"""Farthest that the noise is said to have moved the logarithm of a parameter, a factor of 4.5:
farther off, the slopes that say so hold no more, and the parameter is not known anyway."""

TELLING = 36.0
"""Power of the answer to what may be noise, in the variance of the residual, from which on the
output tells whether it follows that: the residual's is then as much more, or as much less, where
six is the standard error of either."""

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
        For each log its draws in the unit of the input by their number, at least `PAIRS` of shape
        (n,) each; None where there is no error.
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
        found = []
        for segment, owner in zip(problem.segments, problem.owner, strict=True):
            error = errors[owner]
            if error is not None:
                moved = np.interp(segment.time_s, self.time_s[owner], error)
                segment = replace(segment, input=segment.input + moved)
            found.append(segment)
        return found


NO_INPUT_ERRORS = InputErrors((), (), is_averaged=True)
"""Of an input that is known exactly."""


def _white(sd: float, size: int, log: int, number: int) -> Array:
    """A draw of white noise, the same whenever it is asked for."""
    return sd * np.random.default_rng((SEED, log, number)).standard_normal(size)


def with_input_errors(
    covariance: Covariance, problem: Problem, optimum: Optimum, errors: InputErrors
) -> Covariance:
    r"""The covariance of parameters that allows for noise of the input; no variance becomes less.

    With H = JᵀJ and g = Jᵀr at the optimum, N and b what added noise adds to them on the average,

    .. math:: C' = T C T^T + m m^T, \qquad T H^{-1} T^T = (H - N)^{-1}, \qquad m = (H - N)^{-1} b

    for the C that the residuals tell; m is the distance to where the fit would be without the
    noise, to first order. What a gauge shows as noise may be a ripple of the pressure: then the
    output follows it, better than it follows a smooth course, and C stays. Where the output cannot
    tell, it is taken for noise.

    Parameters
    ----------
    covariance
        What the residuals tell.
    problem, optimum
        The fit.
    errors
        Those of the input, for each of the problem's logs.
    """
    names, known = unknown_names(problem), np.array([sd is not None for sd in covariance.sd], bool)
    kept = np.array([names.index(name) for name in covariance.names], int)[known]
    if not kept.size or not errors.are_there:
        return covariance
    still, wider = _at(problem, optimum, problem.segments), covariance
    square, matrices, pulls = np.ix_(kept, kept), [], []
    for number in range(PAIRS):
        moved = [_at(problem, optimum, errors.added(problem, number, sign)) for sign in (1.0, -1.0)]
        matrices.append(np.mean([m.matrix - still.matrix for m in moved], axis=0)[square])
        pulls.append(np.mean([m.gradient - still.gradient for m in moved], axis=0)[kept])
        found = _without_noise(
            still.matrix[np.ix_(kept, kept)], np.array(matrices), np.array(pulls)
        )
        if found is None:
            return covariance
        transform, move = found
        of_logarithms = np.abs(move[_is_logarithm(problem, covariance.names)[known]])
        move *= min(1.0, FARTHEST / max(of_logarithms.max(initial=0.0), FARTHEST))
        wider = _transformed(covariance, known, transform, move)
        if _widening(covariance, wider) < 1.0 + NEGLIGIBLE:
            return covariance
    is_ripple = not errors.is_averaged and _is_followed(problem, optimum)
    return covariance if is_ripple else wider


def _is_logarithm(problem: Problem, names: Iterable[str]) -> BoolArray:
    """Which unknowns are logarithms of parameters."""
    every = problem.parameters
    return np.array([name in every.free and every[name].scale == "log" for name in names], bool)


def _widening(before: Covariance, after: Covariance) -> float:
    """The largest factor by which a standard deviation grows."""
    pairs = zip(before.sd, after.sd, strict=True)
    return max((wide / sd for sd, wide in pairs if sd and wide), default=1.0)


def _transformed(
    covariance: Covariance, known: BoolArray, transform: Array, move: Array
) -> Covariance:
    """T C Tᵀ + m mᵀ over the parameters that are determined, with no variance less than in C."""
    square = np.ix_(known, known)
    before = covariance.matrix[square]
    after = transform @ before @ transform.T + np.outer(move, move)
    least = np.sqrt(np.maximum(np.diag(before) / np.diag(after), 1.0))
    matrix = covariance.matrix.copy()
    matrix[square] = after * np.outer(least, least)
    factors = np.sqrt(np.diag(matrix) / np.diag(covariance.matrix))
    sds = zip(covariance.sd, factors.tolist(), strict=True)
    return replace(
        covariance,
        matrix=matrix,
        sd=tuple(sd if sd is None else sd * factor for sd, factor in sds),
        inflation=covariance.inflation * factors**2,
        cost_per_variance=covariance.cost_per_variance * factors**2,
    )


def _is_followed(problem: Problem, optimum: Optimum) -> bool:
    """Whether the output follows what seems to be noise of the input, so that it is none."""
    moves = [partial(_smoothing_of, log) for log in problem.logs]
    smooth = InputErrors([log.time_s for log in problem.logs], moves, is_averaged=False)
    averaged = Problem.with_segments(problem, smooth.added(problem, 0, 1.0))
    both = [p.blocks(optimum.unknowns, derivatives=False) for p in (problem, averaged)]
    answer = gained = 0.0
    for own, without in zip(*both, strict=True):
        variance = float(np.mean(own.residual**2))
        answer += float(np.sum((without.residual - own.residual) ** 2)) / variance
        gained += float(np.sum(without.residual**2 - own.residual**2)) / variance
    return answer > TELLING and gained > 0.0


def _smoothing_of(log: Log, _: int) -> Array:
    """By how much averaging moves each sample of an input, shape (n,)."""
    smooth, recorded = (
        taken.channels[log.input].values for taken in (without_input_noise(log), log)
    )
    return smooth - recorded


def _at(problem: Problem, optimum: Optimum, segments: Sequence[Segment]) -> Linearised:
    """The normal equations over stretches in the place of a problem's own."""
    changed = Problem.with_segments(problem, segments)
    return linearise(changed, optimum.unknowns, optimum.sigma)


def _without_noise(known: Array, of_noise: Array, pulls: Array) -> tuple[Array, Array] | None:
    """T and m of `with_input_errors`, shapes (K, K) and (K,); None where nothing is known.

    The recorded noise is one of many, and may tell more than the mean of some draws does: their
    standard deviation is added.

    Parameters
    ----------
    known
        H = JᵀJ, shape (K, K).
    of_noise
        What each of P pairs of draws adds to it, N in the mean, shape (P, K, K).
    pulls
        What each adds to the gradient, b in the mean, shape (P, K).
    """
    scale = np.sqrt(np.diag(known))
    if not (np.isfinite(of_noise).all() and np.isfinite(pulls).all() and (scale > 0.0).all()):
        return None
    units = np.outer(scale, scale)
    try:
        root = np.linalg.inv(np.linalg.cholesky(known / units))
    except np.linalg.LinAlgError:
        return None
    inner = root @ (of_noise / units) @ root.T
    mean = inner.mean(axis=0)
    _, axes = np.linalg.eigh(0.5 * (mean + mean.T))
    shares = np.einsum("ik,pij,jk->pk", axes, inner, axes)
    most = shares.mean(axis=0) + (shares.std(axis=0, ddof=1) if len(shares) > 1 else 0.0)
    longer = 1.0 / (1.0 - np.clip(most, 0.0, MOST_NOISE))
    columns = root.T @ axes
    transform = (columns * np.sqrt(longer)) @ np.linalg.inv(columns)
    move = (columns * longer) @ (columns.T @ (pulls.mean(axis=0) / scale))
    return transform * np.outer(1.0 / scale, scale), move / scale
