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

MORE_DRAWS = 9
"""Draws besides, of how far noise moves the fit: of twelve the mean square is known to a factor of
1.4."""

MOST_NOISE = 1.0 - 1e-4
"""Share of what is known in a direction that noise may make: rounding and few draws may find more
than there is."""

NEGLIGIBLE = 0.05
"""Share by which a standard error may grow before more than one pair is drawn and it counts."""

FARTHEST = 1.5
"""Farthest that the noise is said to have moved the logarithm of a parameter, a factor of 4.5:
farther off, the slopes that say so hold no more, and the parameter is not known anyway."""

TELLING = 6.0
"""Standard errors by which what averages leave differs between noise and a ripple that the output
follows, from which on it is said which: half of it is three."""

MOST_OF_NOISE = 1.25
"""Most that averages take away of a draw, in what they take away of the noise that was recorded:
the two differ by chance, and where they differ by more, averages do otherwise."""

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
    """A draw of white noise, the same whenever it is asked for.

    The first reading tells alone where a rest was: it is off by its standard deviation in each.
    """
    draw = np.random.default_rng((SEED, log, number)).standard_normal(size)
    draw[0] = np.copysign(1.0, draw[0])
    return sd * draw


def with_input_errors(
    covariance: Covariance, problem: Problem, optimum: Optimum, errors: InputErrors
) -> Covariance:
    r"""The covariance of parameters that allows for noise of the input; no variance becomes less.

    With H = JᵀJ and g = Jᵀr at the optimum, N and b what added noise adds to them on the average,

    .. math:: C' = T C T^T + m m^T, \qquad T H^{-1} T^T = (H - N)^{-1}, \qquad m = (H - N)^{-1} b

    for the C that the residuals tell; m is the distance to where the fit would be without the
    noise, to first order. A single draw moves the fit besides by H⁻¹(g − b), and no variance is
    less than the mean square of that: residuals tell noise as one that is alike throughout, and
    that of the first reading, from which the rest is taken, is not.

    What a gauge shows as noise may be a ripple of the pressure: then the output follows it, better
    than it follows a smooth course, and C stays. Where the output cannot tell, it is taken for
    noise.

    Parameters
    ----------
    covariance
        What the residuals tell.
    problem, optimum
        The fit.
    errors
        Those of the input, for each of the problem's logs.
    """
    known = np.array([sd is not None for sd in covariance.sd], bool)
    if not known.any() or not errors.are_there:
        return covariance
    names = [name for name, is_known in zip(covariance.names, known, strict=True) if is_known]
    stirred, wider = _Stirred(problem, optimum, errors, names), covariance
    for _ in range(PAIRS):
        stirred.draw_pair()
        found = stirred.allowed()
        if found is None:
            return covariance
        wider = _transformed(covariance, known, *found)
        if _widening(covariance, wider) < 1.0 + NEGLIGIBLE:
            return covariance
    stirred.draw_more()
    found = stirred.allowed()
    if found is None or (not errors.is_averaged and _is_followed(problem, optimum, errors)):
        return covariance
    return _transformed(covariance, known, *found)


def _widening(before: Covariance, after: Covariance) -> float:
    """The largest factor by which a standard deviation grows."""
    pairs = zip(before.sd, after.sd, strict=True)
    return max((wide / sd for sd, wide in pairs if sd and wide), default=1.0)


def _transformed(
    covariance: Covariance, known: BoolArray, transform: Array, move: Array, least: Array
) -> Covariance:
    """T C Tᵀ + m mᵀ over the parameters that are determined, with no variance less than some.

    Nor less than in C.
    """
    square = np.ix_(known, known)
    before = covariance.matrix[square]
    after = transform @ before @ transform.T + np.outer(move, move)
    least = np.maximum(np.diag(before), least)
    lower = np.sqrt(np.maximum(least / np.diag(after), 1.0))
    matrix = covariance.matrix.copy()
    matrix[square] = after * np.outer(lower, lower)
    factors = np.sqrt(np.diag(matrix) / np.diag(covariance.matrix))
    sds = zip(covariance.sd, factors.tolist(), strict=True)
    return replace(
        covariance,
        matrix=matrix,
        sd=tuple(sd if sd is None else sd * factor for sd, factor in sds),
        inflation=covariance.inflation * factors**2,
        cost_per_variance=covariance.cost_per_variance * factors**2,
    )


def _is_followed(problem: Problem, optimum: Optimum, errors: InputErrors) -> bool:
    """Whether the output follows what seems to be noise of the input, so that it is none.

    Averages leave more of the output unexplained then, by the power of the answer to what they take
    away. They bend a quick course as well, which leaves more whether or not there is noise: how
    much of that answer is due to noise is seen by what they take away of a draw. Where that is
    more than all of the answer, noise makes them bend otherwise, and nothing is told.
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
        partial(_difference, log.channels[log.input].values, other.channels[log.input].values)
        for log, other in zip(logs, others, strict=True)
    ]
    added = InputErrors([log.time_s for log in logs], moves, is_averaged=False)
    changed = Problem.with_segments(problem, added.added(problem, 0, 1.0))
    blocks = changed.blocks(optimum.unknowns, derivatives=False)
    return np.concatenate([block.residual / optimum.sigma[block.channel] for block in blocks])


def _difference(before: Array, after: Array, _: int) -> Array:
    return after - before


class _Stirred:
    """Normal equations of a fit with noise added to the input.

    Parameters
    ----------
    problem, optimum, errors
        As in `with_input_errors`.
    names
        Unknowns that are determined, K of them.
    """

    def __init__(
        self, problem: Problem, optimum: Optimum, errors: InputErrors, names: Sequence[str]
    ) -> None:
        every, own = unknown_names(problem), problem.parameters
        self._at = partial(_linearised, problem, optimum)
        self._added = partial(errors.added, problem)
        self._kept = np.array([every.index(name) for name in names], int)
        self._is_logarithm = np.array(
            [name in own.free and own[name].scale == "log" for name in names], bool
        )
        self._still = self._at(problem.segments)
        self._matrices: list[Array] = []
        self._pulls: list[Array] = []
        self._stirs: list[Array] = []

    def draw_pair(self) -> None:
        """One draw, which is added and taken away: what is even in it lasts on the average."""
        number = len(self._pulls)
        up, down = (self._at(self._added(number, sign)) for sign in (1.0, -1.0))
        square = np.ix_(self._kept, self._kept)
        self._matrices.append((0.5 * (up.matrix + down.matrix) - self._still.matrix)[square])
        pull = 0.5 * (up.gradient + down.gradient) - self._still.gradient
        self._pulls.append(pull[self._kept])
        self._stirs.append(0.5 * (up.gradient - down.gradient)[self._kept])

    def draw_more(self) -> None:
        """More draws of what is odd, which is another in each."""
        pull = np.mean(self._pulls, axis=0)
        for number in range(len(self._stirs), len(self._stirs) + MORE_DRAWS):
            once = self._at(self._added(number, 1.0))
            self._stirs.append((once.gradient - self._still.gradient)[self._kept] - pull)

    def allowed(self) -> tuple[Array, Array, Array] | None:
        """T and m of `with_input_errors`, and the mean squares of H⁻¹(g − b).

        The recorded noise is one of many, and may tell more than the mean of some draws does: their
        standard deviation is added.

        Returns
        -------
        arrays of shapes (K, K), (K,) and (K,), or None
            None where nothing is known.
        """
        known = self._still.matrix[np.ix_(self._kept, self._kept)]
        added, stirs = np.array(self._matrices), np.array(self._stirs)
        pull, scale = np.mean(self._pulls, axis=0), np.sqrt(np.diag(known))
        is_finite = (
            np.isfinite(added).all() and np.isfinite(pull).all() and np.isfinite(stirs).all()
        )
        if not (is_finite and (scale > 0.0).all()):
            return None
        units = np.outer(scale, scale)
        try:
            root = np.linalg.inv(np.linalg.cholesky(known / units))
        except np.linalg.LinAlgError:
            return None
        inner = root @ (added / units) @ root.T
        mean = inner.mean(axis=0)
        _, axes = np.linalg.eigh(0.5 * (mean + mean.T))
        shares = np.einsum("ik,pij,jk->pk", axes, inner, axes)
        most = shares.mean(axis=0) + (shares.std(axis=0, ddof=1) if len(shares) > 1 else 0.0)
        longer = 1.0 / (1.0 - np.clip(most, 0.0, MOST_NOISE))
        columns = root.T @ axes
        transform = (columns * np.sqrt(longer)) @ np.linalg.inv(columns)
        move = (columns * longer) @ (columns.T @ (pull / scale)) / scale
        farthest = np.abs(move[self._is_logarithm]).max(initial=FARTHEST)
        moves = stirs / scale @ (root.T @ root) / scale
        squares: Array = np.mean(moves**2, axis=0)
        return transform * np.outer(1.0 / scale, scale), move * FARTHEST / farthest, squares


def _linearised(problem: Problem, optimum: Optimum, segments: Sequence[Segment]) -> Linearised:
    """The normal equations over stretches in the place of a problem's own."""
    changed = Problem.with_segments(problem, segments)
    return linearise(changed, optimum.unknowns, optimum.sigma)
