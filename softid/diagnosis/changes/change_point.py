"""Whether a misfit begins at one moment: something slipped, gave way, or jumped.

Every unknown of the base may change at a moment, and so may the delay of the output. The score test
of that, the largest over all moments (Andrews, Econometrica 61, 1993), needs no refit: a base that
was fitted to the whole of a log, before and after, bends towards either side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.chi_square import chi_square_tail
from softid.diagnosis.changes.loads import by_load
from softid.diagnosis.changes.shifts import EITHER, LOAD, ZERO, shift_at
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.projection import (
    Rows,
    added_basis,
    basis_of,
    joined,
    logs_of,
    project_out,
    rows_of,
)
from softid.effects.scale import Scale
from softid.uncertainty.autoregression import AutoRegression, autocovariance, fit_ar

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

GAIN = "gain"
"""Kind of a change that is no shift: of the reading's gain, or of what looks like one."""

MOMENTS = 48
"""Moments that are tried over a log."""

FINER = 12
"""Moments that are tried on either side of the best one of a log, up to its neighbours."""

EDGE = 0.08
"""Nothing is looked for in this share of a log at either end: too little would tell of it."""

LEAST_TAKEN = 0.94
"""A change must take away so much of the misfit above the noise."""

TAKES_AT_LARGE = 0.985
"""Share of the misfit above the noise that a change of everything must take away where no single
kind does: it takes much of any misfit."""

MEDIAN_SHARE = 0.75
"""Share of what a change at the best moment takes away that one at the median moment must stay
below: what goes on throughout a log, such as a drift, is made up for by a change at any moment."""

GRADUAL = 0.9
"""Share of what a change takes away from which on a weight that goes evenly with the time, or
settles, speaks against a moment: one that settles takes four fifths of what a moment does."""

SETTLES_WITHIN = (0.02, 0.04, 0.08, 0.16, 0.32)
"""Times in which such a weight settles, as shares of a log: a softening, a sensor that warms up."""

ALL_OF_IT = 0.9
"""Share of what a change takes away from which on one of the whole log against the others speaks
against a moment: what differs between logs shows from where a log begins to move."""

LARGEST_ODDS = 0.01
"""Odds of a change somewhere in a log that takes as much of mere noise, above which it is none."""

ALONE = 0.93
"""Share of what a change of everything takes away from which on a change of one kind alone is
told."""


@dataclass(frozen=True)
class ChangePoint:
    """A moment at which something changed.

    Attributes
    ----------
    log
        Index of the log.
    time_s
        The moment.
    share
        Share of the misfit above the noise that a change of everything takes away.
    kind
        What changed: ``zero``, ``load``, ``clock`` or ``gain``; ``zero or load`` where each of the
        two does as well and the course at the moment does not tell; empty where it is none alone.
    """

    log: int
    time_s: float
    share: float
    kind: str


def change_point(model: Candidate, scale: Scale, excess: float) -> ChangePoint | None:
    """The moment at which the misfit begins, if it begins at one.

    With B spanning the derivatives of the response and the rate of the output, the residual is
    regressed on B before and after a moment; the moment is where most goes. What other parameters
    throughout would take away, where the model is not at its optimum, is no part of the misfit.

    Parameters
    ----------
    model
        A model over its logs.
    scale
        Sizes of the base fit.
    excess
        Variance of what it leaves above that of the noise, as a share of the latter.
    """
    if not excess > 0.0:
        return None
    first = model.problem.outputs[0]
    rows = [row for row in rows_of(model) if row.channel == first]
    loaded = by_load(model, scale)
    columns = (loaded, *(row.jacobian for row in rows))
    if not all(np.isfinite(column).all() for column in columns):  # it runs away, or nearly so
        return None
    look = _ScoreTest(model, rows, loaded)
    noise = look.power / (1.0 + excess)
    best: ChangePoint | None = None
    for log in sorted({row.place.log for row in look.rows}):
        found = look.best_of(log, noise)
        if found is not None and (best is None or found.share > best.share):
            best = found
    return best


class _ScoreTest:
    """Residual of the first output, and the columns that a change is made of."""

    def __init__(self, model: Candidate, rows: Sequence[Rows], loaded: Array) -> None:
        self.model, self.rows = model, rows
        jacobian = np.concatenate([row.jacobian for row in self.rows])
        self.rate = joined(self.rows, lambda motion: motion.v)
        self.kinds = {
            ZERO: np.ones(self.rate.size),
            LOAD: loaded,
            "clock": self.rate,
            GAIN: joined(self.rows, lambda motion: motion.x),
        }
        self.time_s = joined(self.rows, lambda motion: motion.time_s)
        self.log = logs_of(self.rows)
        self.basis = basis_of(jacobian)
        self.residual = np.concatenate([row.residual for row in self.rows])
        self.left = project_out(self.basis, self.residual)
        self.power = float(self.residual @ self.residual)
        self.columns = basis_of(np.column_stack((jacobian, self.rate, loaded)))

    def best_of(self, log: int, noise: float) -> ChangePoint | None:
        """The moment of one log at which a change takes most of what is more than noise."""
        misfit = float(self.left @ self.left) - noise
        if not misfit > 0.0:  # or no number, where a column is nearly beyond all numbers
            return None
        mine = self.time_s[self.log == log]
        begin, length = float(mine[0]), float(np.ptp(mine))
        step = (1.0 - 2.0 * EDGE) * length / (MOMENTS - 1)
        moments = begin + EDGE * length + step * np.arange(MOMENTS)
        taken = np.array([self.taken(self.columns, log, t) for t in moments.tolist()])
        most = float(taken.max())
        if not most >= LEAST_TAKEN * misfit or float(np.median(taken)) > MEDIAN_SHARE * most:
            return None
        at = float(moments[int(taken.argmax())])
        variance = max(noise / self.left.size, self.long_run_variance(log, at))
        if MOMENTS * chi_square_tail(most / variance, 1 + self.columns.shape[1]) > LARGEST_ODDS:
            return None
        near = at + np.linspace(-step, step, 2 * FINER + 1)
        finer = [self.taken(self.columns, log, t) for t in near.tolist()]
        time_s, most = float(near[int(np.argmax(finer))]), max(finer)
        kind = self.kind_of(log, time_s, most)
        if kind == EITHER:
            kind = self.kind_of_shift(log, time_s)
        if not kind and most < TAKES_AT_LARGE * misfit:
            return None
        if self.taken_gradually(log, begin, length) > GRADUAL * most:
            return None
        if self.taken(self.columns, log, -np.inf) > ALL_OF_IT * most:
            return None
        return ChangePoint(log, time_s, most / misfit, kind)

    def taken(self, columns: Array, log: int, time_s: float) -> float:
        """Fall of the sum of squares when the weights of columns change at a moment of a log."""
        return self._fall(columns * self._is_after(log, time_s)[:, None])

    def taken_gradually(self, log: int, begin_s: float, length_s: float) -> float:
        """The most that the weight of one kind alone takes that goes with the time of a log."""
        since = np.clip((self.time_s - begin_s) / length_s, 0.0, 1.0)
        ways = (since, *(1.0 - np.exp(-since / within) for within in SETTLES_WITHIN))
        mine = self.log == log
        return max(
            self._fall((column * way * mine)[:, None])
            for column in self.kinds.values()
            for way in ways
        )

    def long_run_variance(self, log: int, time_s: float) -> float:
        """Sum of all autocovariances of what a change of everything at a moment leaves.

        A change holds on, so slow noise counts for as many samples fewer as are alike in it.
        """
        gamma = autocovariance(self._noise(log, time_s), self.left.size)
        return float(gamma[0] + 2.0 * gamma[1:].sum())

    def kind_of_shift(self, log: int, time_s: float) -> str:
        """Whether a zero or a load shifts a log from a moment on, by its course there."""
        mine = self.log == log
        noise = self._noise(log, time_s)
        found = shift_at([time_s], self.model, self.time_s[mine], self.residual[mine], noise)
        return EITHER if found is None else found.kind

    def _noise(self, log: int, time_s: float) -> AutoRegression:
        """What a change of everything at a moment leaves."""
        directions = self._directions(self.columns * self._is_after(log, time_s)[:, None])
        rest = project_out(directions, self.left)
        return fit_ar(np.split(rest, np.cumsum([row.residual.size for row in self.rows])[:-1]))

    def _is_after(self, log: int, time_s: float) -> BoolArray:
        """Which samples come behind a moment of a log."""
        after: BoolArray = (self.log == log) & (self.time_s > time_s)
        return after

    def _directions(self, columns: Array) -> Array:
        """What columns, and the rate, span beside the derivatives of the response."""
        return added_basis(self.basis, np.column_stack((self.rate, columns)))

    def _fall(self, columns: Array) -> float:
        """Fall of the sum of squares with columns, and the rate, in the regression."""
        return float(np.sum((self._directions(columns).T @ self.left) ** 2))

    def kind_of(self, log: int, time_s: float, most: float) -> str:
        """What alone takes nearly as much, the simplest first."""
        alike = [
            name
            for name, column in self.kinds.items()
            if self.taken(column[:, None], log, time_s) > ALONE * most
        ]
        return EITHER if alike[:2] == [ZERO, LOAD] else next(iter(alike), "")
