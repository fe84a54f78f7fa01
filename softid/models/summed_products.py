"""Products of a law's columns summed over a log; those of a long one over both halves at once.

A motion forgets where it began. The second half of a long log is therefore begun some steps earlier
from nothing, and is the motion itself, to the last digit, where it arrives. Whether it is, its
derivatives by the state there tell; where it is not, the second half waits for the first. What is
summed is the same whether or not a second thread was free.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.kernels.affine_blocks import N_COLUMNS, N_PADDED, N_PARAMETERS, N_STATES, STEPS
from softid.kernels.affine_sums import sum_products
from softid.models.division import Division, divide, held
from softid.models.products import Keep, Products
from softid.models.second_order import Law, affine_run
from softid.parallel import on_two_threads
from softid.segment import Segment

Array = npt.NDArray[np.float64]

HALVED_STEPS = 30_000
"""Steps from which on the halves of a log are summed at once. Each half then takes several times as
long as to hand one to a thread that waits for it."""

RUN_IN_SHARE = 16
"""Part of a half, as one in so many, in which the motion must have forgotten where it began. A
longer one eats up what the second thread saves."""

FORGOTTEN = 1e-20
"""Share of a state that is left when it is forgotten: rounding is ten thousand times as much."""

_EYE = np.eye(N_STATES)

_ALL = 1 << 62
"""More blocks than any log has."""


@dataclass(frozen=True, eq=False)
class _Place:
    """Where a run over a log is; the kernels move it on.

    Attributes
    ----------
    at
        Interval and step, counted from its beginning, that come next, shape (2,).
    state, tangent
        (x, v) there and its derivatives, of shapes (2,) and (2, 9).
    """

    at: npt.NDArray[np.int64]
    state: Array
    tangent: Array

    @classmethod
    def from_nothing(cls, step: int) -> _Place:
        """The beginning of a step, with nothing known of the motion there."""
        tangent = np.eye(N_STATES, N_PARAMETERS + N_STATES, N_PARAMETERS)
        return cls(np.array([0, step], np.int64), np.zeros(N_STATES), tangent)

    def forgets(self) -> bool:
        """Whether nothing is left of the state that it began with; what is, is then dropped."""
        by_state = self.tangent[:, N_PARAMETERS:]
        if not np.abs(by_state).max() < FORGOTTEN:  # nor where it is beyond all numbers
            return False
        by_state[:] = 0.0
        return True


class _Sums:
    """What is summed over a log.

    Parameters
    ----------
    course
        Law, rule, parameters, times, input, counts, measured output and its use, gain and level.
    stretch
        As in `Keep`.
    kept, residual
        Receive what is kept, as in `sum_products`.
    """

    def __init__(self, course: tuple[Any, ...], stretch: int, kept: Array, residual: Array) -> None:
        self._course, self._stretch = course, stretch
        self._kept, self._residual = kept, residual

    def along(self, place: _Place, blocks: int = _ALL, *, apart: int = -1) -> Array:
        """The products of so many blocks from a place on, shape (12, 12)."""
        gram = np.empty((N_PADDED, N_PADDED))
        here = place.at, blocks, place.state, place.tangent
        kept = self._stretch, self._kept, apart, self._residual
        arguments = (*self._course, *here, *kept, gram)
        sum_products(*arguments)
        return gram

    def by_halves(self, begin: _Place, steps: int) -> Array:
        """The products of the whole log, of which the kept have a column to spare."""
        half = steps // STEPS // 2
        run_in = half // RUN_IN_SHARE
        nothing = _Sums(self._course, 0, np.empty((N_COLUMNS, 0)), np.empty(0))

        def second() -> tuple[Array, int] | None:
            place = _Place.from_nothing((half - run_in) * STEPS)
            nothing.along(place, run_in)
            if not place.forgets():
                return None
            sample = int(place.at[0]) + 1
            shared = sample // self._stretch if self._stretch else -1
            return self.along(place, apart=shared), shared

        gram, later = on_two_threads(lambda: self.along(begin, half), second)
        if later is None:
            return gram + self.along(begin)
        if self._stretch:
            self._kept[:, later[1]] += self._kept[:, -1]
        total: Array = gram + later[0]
        return total


def sum_law(
    law: Law,
    segment: Segment,
    channel: str,
    start: Array | None,
    *,
    relative: bool,
    plan: Division | None,
    gain: float,
    level: float,
    keep: Keep,
) -> Products | None:
    """Summed products for an output gain·x + level; None for a law that the kernels do not know.

    Parameters
    ----------
    law
        The coefficients.
    segment, channel
        Times, input and measured output.
    start, relative, plan
        As in `simulate_law`.
    gain, level
        Output per position, and output at x = 0 with its sensor zero.
    keep
        As in `Model.products`.
    """
    form = law.affine()
    if form is None:
        return None
    if plan is None:
        plan = divide(law, segment.time_s, segment.input)
    run = affine_run(form, plan, start, relative=relative)
    y, used = held(segment.outputs[channel]), held(segment.used[channel])
    by_halves = plan.steps >= HALVED_STEPS
    stretches = -(-y.size // keep.stretch) if keep.stretch else 0
    kept = np.zeros((N_COLUMNS, stretches + 1 if stretches and by_halves else stretches))
    left = np.zeros(y.size if keep.residual else 0)
    sums = _Sums((*run.arguments[:6], y, used, gain, level), keep.stretch, kept, left)
    begin = _Place(np.zeros(2, np.int64), run.arguments[6], run.tangent)
    gram = sums.by_halves(begin, plan.steps) if by_halves else sums.along(begin)
    columns = kept[:, :stretches] if stretches else None
    return Products(
        gram[:N_COLUMNS, :N_COLUMNS].copy(),
        gain * form.by_theta,
        gain * _EYE,
        columns,
        _counted(columns, keep.stretch) if columns is not None and keep.stretch > 1 else None,
        left if keep.residual else None,
    )


def _counted(means: Array, stretch: int) -> Array:
    """Used samples of every stretch, shape (m,), of which alone the columns become means."""
    counts: Array = np.rint(stretch * means[-2])
    short = np.flatnonzero((counts > 0.0) & (counts < stretch))
    means[:, short] *= stretch / counts[short]
    return counts
