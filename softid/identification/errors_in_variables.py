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

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import numpy.typing as npt

from softid.fitters.normal_equations import linearise
from softid.fitters.output_error import Optimum
from softid.fitters.problem import Problem
from softid.identification.input_errors import InputErrors
from softid.identification.input_ripple import is_followed
from softid.identification.unknown_names import unknown_names
from softid.parallel import both, in_parallel
from softid.segment import Segment
from softid.uncertainty import Covariance, widened

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


def with_input_errors(
    covariance: Covariance, problem: Problem, optimum: Optimum, errors: InputErrors
) -> Covariance:
    r"""The covariance of parameters that allows for noise of the input; no variance becomes less.

    With H = JᵀJ and g = Jᵀr at the optimum, N and b what added noise adds to them on the average,

    .. math:: C' = T C T^T + m m^T, \qquad T H^{-1} T^T = (H - N)^{-1}, \qquad m = (H - N)^{-1} b

    for the C that the residuals tell; m is the distance to where the fit would be without the
    noise, to first order. A single draw moves the fit besides by H⁻¹(g − b), and no variance is
    less than the mean square of that: residuals tell noise as one that is alike throughout, and
    that of the first reading, from which the rest is taken, is not. Where noise was averaged away,
    who did so knows how far a draw moves the fit.

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
    stirred = _Stirred(problem, optimum, errors, names)
    for _ in range(PAIRS):
        stirred.draw_pair()
        found = stirred.allowed()
        if found is None:
            return covariance
        if _widening(covariance, _transformed(covariance, known, *found)) < 1.0 + NEGLIGIBLE:
            return covariance
    stirred.draw_more()
    found = stirred.allowed()
    if found is None or (not errors.is_averaged and is_followed(problem, optimum, errors)):
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
    sds = dict(zip(covariance.names, np.sqrt(np.diag(matrix)).tolist(), strict=True))
    return replace(widened(covariance, sds), matrix=matrix)


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
        kept = np.array([every.index(name) for name in names], int)
        self._at = partial(_sums, problem, optimum, kept)
        self._added = partial(errors.added, problem)
        self._is_averaged = errors.is_averaged
        self._is_logarithm = np.array(
            [name in own.free and own[name].scale == "log" for name in names], bool
        )
        self._matrix, self._gradient = self._at(problem.segments)
        self._matrices: list[Array] = []
        self._pulls: list[Array] = []
        self._stirs: list[Array] = []

    def draw_pair(self) -> None:
        """One draw, which is added and taken away: what is even in it lasts on the average."""
        number = len(self._pulls)
        up, down = both(lambda: self._with(number, 1.0), lambda: self._with(number, -1.0))
        (matrix_up, gradient_up), (matrix_down, gradient_down) = up, down
        self._matrices.append(0.5 * (matrix_up + matrix_down) - self._matrix)
        self._pulls.append(0.5 * (gradient_up + gradient_down) - self._gradient)
        self._stirs.append(0.5 * (gradient_up - gradient_down))

    def _with(self, number: int, sign: float) -> tuple[Array, Array]:
        """JᵀJ and Jᵀr with a draw of the noise, added or taken away."""
        return self._at(self._added(number, sign))

    def draw_more(self) -> None:
        """More draws of what is odd, which is another in each, where it counts."""
        if self._is_averaged:
            return
        even = self._gradient + np.mean(self._pulls, axis=0)
        numbers = range(len(self._stirs), len(self._stirs) + MORE_DRAWS)
        drawn = in_parallel(lambda number: self._with(number, 1.0), numbers, small=True)
        self._stirs.extend(gradient - even for _, gradient in drawn)

    def allowed(self) -> tuple[Array, Array, Array] | None:
        """T and m of `with_input_errors`, and the mean squares of H⁻¹(g − b).

        The recorded noise is one of many, and may tell more than the mean of some draws does: their
        standard deviation is added.

        Returns
        -------
        arrays of shapes (K, K), (K,) and (K,), or None
            None where nothing is known.
        """
        known = self._matrix
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
        squares = np.zeros_like(pull) if self._is_averaged else np.mean(moves**2, axis=0)
        return transform * np.outer(1.0 / scale, scale), move * FARTHEST / farthest, squares


def _sums(
    problem: Problem, optimum: Optimum, kept: Array, segments: Sequence[Segment]
) -> tuple[Array, Array]:
    """JᵀJ and Jᵀr of some unknowns over stretches in the place of a problem's own."""
    changed = Problem.with_segments(problem, segments)
    found = linearise(changed, optimum.unknowns, optimum.sigma)
    return found.matrix[np.ix_(kept, kept)], found.gradient[kept]
