"""Whether a misfit is a difference between logs: another gain, load, stiffness or delay in each.

Something was changed between two logs, and one model is to follow both. A model that follows one of
them is put to the others with one change for each, which is fitted with its zero and initial state.
Where one does not do, a second is freed beside it: a payload adds inertia and weight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.diagnosis.changes.changed_numbers import SIGN, Change, Sizes, Turn, changes_of
from softid.diagnosis.changes.shifts import ZERO
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.noise_floor import SMALLEST_EXCESS
from softid.effects.scale import Scale
from softid.log import Log
from softid.parallel import in_parallel

Array = npt.NDArray[np.float64]

LEAST_TAKEN = 0.9
"""A difference must take away so much of the misfit above the noise."""

RIVAL_SHARE = 0.97
"""Kinds that take away so much of what the best does are told beside it; of a second one beside a
first, of what the best adds to the first."""

SAME_SQUARES = 1.0
"""Kinds whose sums of squares differ by less, in variances of the noise, are the same here, and the
first that is declared stands for them: a gain of the reading and one of the pressure, in a linear
model."""

MUST_LEAVE = 0.5
"""Share of what one change leaves of the misfit that a second one beside it may leave at most."""

LEAST_START = 0.25
"""Share of the misfit above the noise that a change takes away by itself before a second one is
tried beside it."""


@dataclass(frozen=True)
class LogDifferences:
    """What differs from log to log.

    Attributes
    ----------
    kinds
        What differs, the one that takes most first: ``sign``, ``gain``, ``delay``, ``drift`` and
        ``settling_drift`` of the reading, ``load``, ``stiffness``, ``damping``, ``pressure_gain``,
        ``pressure_zero`` or a parameter of the model; all others take nearly as much. It is
        ``zero`` alone where that does.
    sizes
        Of the first kind, for each log: shares, a load as a share of the elastic force, a zero of
        the pressure as a share of the input's range, a drift as one of the output's over the
        longest log, a delay in s; no numbers for a zero.
    share
        Share of the misfit above the noise that goes.
    beside
        What differs besides, where one number for each log does not take so much; its share is that
        of both.
    """

    kinds: tuple[str, ...]
    sizes: tuple[float, ...]
    share: float
    beside: LogDifferences | None = None


def log_differences(
    reference: Candidate,
    scale: Scale,
    logs: Sequence[Log],
    *,
    before: float,
    noise: float,
    own: float = 0.0,
    zero_counts: bool = False,
) -> LogDifferences | None:
    """What differs from log to log and takes away nearly all of the misfit that is more than noise.

    Parameters
    ----------
    reference
        A model whose parameters stay.
    scale
        Sizes of the base fit.
    logs
        Other logs, with the channels of the model.
    before, noise
        Sums of squares of the first output over these logs, and over what belongs to ``own``: of
        the misfit, and of the noise.
    own
        Sum of squares that the reference leaves on what it was fitted to, if that counts.
    zero_counts
        Whether a zero of their own is a difference.

    Returns
    -------
    LogDifferences or None
        None where neither one kind nor two take so much.
    """
    misfit = before - noise
    if not misfit > 0.0:
        return None
    problem, values = reference.problem, reference.parameters
    unnamed = [name for name in problem.free if name != problem.model.inertia_parameter]
    same = SAME_SQUARES * noise / (misfit * sum(log.time_s.size for log in logs))

    def tried(changes: Sequence[Change], without: float = 0.0) -> _Tried:
        fitted = in_parallel(lambda change: [change.on(log) for log in logs], changes)
        rows = [[sizes for _, sizes in each] for each in fitted]
        left = [sum(squares for squares, _ in each) for each in fitted]
        falls = [
            (before - own - squares) / misfit if change.may_be(sizes) else -np.inf
            for change, squares, sizes in zip(changes, left, rows, strict=True)
        ]
        return _Tried(changes, rows, np.array(falls), same, without)

    single = tried(changes_of(reference, scale))
    if zero_counts:
        zero = tried([Change((ZERO,), (), problem, values)])
        if zero.most > max(LEAST_TAKEN, RIVAL_SHARE * single.most):
            return zero.told(unnamed)
    left = misfit * (1.0 - single.most)
    pairs = single.joined_with_best() if single.most > LEAST_START else []
    if pairs and (single.most <= LEAST_TAKEN or left > SMALLEST_EXCESS * noise):
        both = tried(pairs, single.most)
        if both.most > max(LEAST_TAKEN, 1.0 - MUST_LEAVE * (1.0 - single.most)):
            return both.told(unnamed)
    return single.told(unnamed) if single.most > LEAST_TAKEN else None


def turned_output(
    reference: Candidate, logs: Sequence[Log], before: float
) -> LogDifferences | None:
    """That the first output of other logs has the other sign, whatever else a model misses.

    Parameters
    ----------
    reference, logs
        As in `log_differences`.
    before
        Sum of squares that the model leaves of the first output over these logs.
    """
    change = Turn((SIGN,), (), reference.problem, reference.parameters)
    rows = [change.on(log) for log in logs]
    share = 1.0 - sum(left for left, _ in rows) / before if before > 0.0 else 0.0
    sizes = tuple(size for _, row in rows for size in row or ())
    return LogDifferences((SIGN,), sizes, share) if share > LEAST_TAKEN and any(sizes) else None


def squares_with(
    reference: Candidate, scale: Scale, logs: Sequence[Log], found: LogDifferences
) -> float:
    """Sum of squares that a model leaves of other logs if each has its own of what differs.

    Parameters
    ----------
    reference, scale, logs
        As in `log_differences`.
    found
        What differs; of kinds that do as well the first.

    Returns
    -------
    float
        Infinite where the model has no such number.
    """
    changes = {change.kinds[0]: change for change in changes_of(reference, scale)}
    asked = changes.get(found.kinds[0])
    if asked is not None and found.beside is not None:
        second = changes.get(found.beside.kinds[0])
        asked = None if second is None else asked.joined_with(second)
    return np.inf if asked is None else sum(asked.on(log)[0] for log in logs)


@dataclass(frozen=True, eq=False)
class _Tried:
    """Changes that were put to logs.

    Attributes
    ----------
    changes
        What was changed.
    rows
        For each change and each log, the sizes.
    falls
        Shares of the misfit above the noise that they take away; −∞ for what may not be, shape
        (changes,).
    same
        Falls that are no further apart are the same here.
    without
        Of changes at once, the share that the first of them takes away by itself.
    """

    changes: Sequence[Change]
    rows: Sequence[Sequence[Sizes]]
    falls: Array
    same: float
    without: float

    @property
    def most(self) -> float:
        """The largest share."""
        return float(self.falls.max())

    def joined_with_best(self) -> list[Change]:
        """The change that takes the most, with each of the others."""
        first = self.changes[self._ranked()[0]]
        joined = (first.joined_with(change) for change in self.changes if change is not first)
        return [pair for pair in joined if pair is not None]

    def told(self, own: Sequence[str]) -> LogDifferences:
        """The kinds that take nearly as much as the best; of changes at once, the last's.

        Parameters
        ----------
        own
            Parameters of the model: what has a name of its own comes before them.
        """
        least = self.without + RIVAL_SHARE * (self.most - self.without)
        alike = [k for k in self._ranked() if self.falls[k] > least]
        alike = [k for k in alike if self.changes[k].kinds[-1] not in own] or alike
        best, share = alike[0], min(float(self.falls[alike[0]]), 1.0)
        last = tuple(row[-1] for row in self.rows[best] if row)
        kinds = tuple(self.changes[k].kinds[-1] for k in alike)
        found = LogDifferences(kinds, last, share)
        if len(self.changes[best].kinds) == 1:
            return found
        first = tuple(row[0] for row in self.rows[best] if row)
        return LogDifferences(self.changes[best].kinds[:1], first, share, found)

    def _ranked(self) -> list[int]:
        """Places of the changes, the largest fall first; what is the same as it is declared."""
        ranked: list[int] = np.argsort(-self.falls, kind="stable").tolist()
        level = sorted(k for k in ranked if self.most - self.falls[k] < self.same)
        return [*level, *ranked[len(level) :]]
