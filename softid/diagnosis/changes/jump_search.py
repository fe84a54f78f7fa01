"""The search for jumps of a sensor's zero, or of a load, that other causes of a misfit hide.

A jump that is all there is `change_point` tells. Beside a cause it takes a part of the misfit only,
and the cause cannot be found before the jump is taken out of the readings.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.changes.change_point import EDGE, GAIN, MEDIAN_SHARE, MOMENTS
from softid.diagnosis.changes.loads import LoadInLog, by_load
from softid.diagnosis.changes.shifts import (
    DECISIVE,
    EITHER,
    LOAD,
    ZERO,
    Course,
    reading_jumps,
    shift_at,
)
from softid.diagnosis.changes.zero_jumps import ZeroJump
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.projection import (
    added_basis,
    basis_of,
    joined,
    logs_of,
    project_out,
    rows_of,
)
from softid.effects.scale import Scale
from softid.uncertainty.autoregression import fit_ar, whiten

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

LEAST_TAKEN = 0.25
"""A jump must take away so much of the misfit above the noise."""

DISTINCT, FAR_STEPS = 0.95, 3
"""Share of what a jump takes away that one at any moment further off than so many steps of the
search must stay below."""

ZOOMS, ZOOM, ZOOM_MOMENTS = 4, 4.0, 9
"""The moment of a simulated load is looked for so often, each time in a part of the last stretch
that is this many times shorter, at so many moments."""


def zero_jumps(model: Candidate, scale: Scale, excess: float) -> tuple[ZeroJump, ...]:
    """The most likely jump of each log, where one takes away a part of the misfit.

    The residual is regressed on a step at each moment, beside the derivatives of the response and
    the rate of the output. Whether it is one is seen by what is left without it.

    Parameters
    ----------
    model
        A model over its logs.
    scale
        Sizes of the base fit.
    excess
        Variance of what it leaves above that of the noise, as a share of the latter.
    """
    look = _Steps.of(model, scale)
    if look is None or not excess > 0.0:
        return ()
    misfit = float(look.left @ look.left) * excess / (1.0 + excess)
    found = (look.likely_jump(k, misfit) for k in range(len(model.problem.logs)))
    return tuple(jump for jump in found if jump is not None)


def seen_again(model: Candidate, scale: Scale, jumps: Sequence[ZeroJump]) -> tuple[ZeroJump, ...]:
    """Moments and sizes of jumps as a better model sees them, without those that it sees no more.

    Parameters
    ----------
    model
        A model over logs without the jumps.
    scale
        Sizes of the base fit.
    jumps
        What was taken out of its logs.
    """
    look = _Steps.of(model, scale)
    if look is None:
        return tuple(jumps)
    found = map(look.seen_again, jumps)
    return tuple(jump for jump, size in found if size > DECISIVE)


@dataclass(frozen=True, eq=False)
class _Steps:
    """What a model leaves of the first output, and a step of it at any moment.

    Attributes
    ----------
    model, scale
        The model, and the sizes of the base fit.
    basis
        Of the derivatives of the response and the rate of the output, shape (m, k).
    residual, left
        What the model leaves, and what is left of that beside them, shape (m,).
    time_s, log
        Time and index of the log of each sample, shape (m,).
    shapes
        What a zero shifts, what a gain does, and where that is no zero what a load does, each of
        shape (m,).
    """

    model: Candidate
    scale: Scale
    basis: Array
    residual: Array
    left: Array
    time_s: Array
    log: npt.NDArray[np.intp]
    shapes: dict[str, Array]

    @classmethod
    def of(cls, model: Candidate, scale: Scale) -> _Steps | None:
        """Of a model where it stands; None where it runs away."""
        first = model.problem.outputs[0]
        rows = [row for row in rows_of(model) if row.channel == first]
        jacobian = np.concatenate([row.jacobian for row in rows])
        position = joined(rows, lambda motion: motion.x)
        shapes = {ZERO: np.ones(position.size), GAIN: position}
        if not model.problem.model.without_effects.is_linear:
            shapes[LOAD] = by_load(model, scale)
        if not all(np.isfinite(part).all() for part in (jacobian, *shapes.values())):
            return None
        rate = joined(rows, lambda motion: motion.v)[:, None]
        basis = basis_of(jacobian)
        basis = np.column_stack((basis, added_basis(basis, rate)))
        residual = np.concatenate([row.residual for row in rows])
        left = project_out(basis, residual)
        time_s = joined(rows, lambda motion: motion.time_s)
        return cls(model, scale, basis, residual, left, time_s, logs_of(rows), shapes)

    def likely_jump(self, log: int, misfit: float) -> ZeroJump | None:
        """The moment at which a step takes most, if none elsewhere takes as much.

        Nor a gain that changes, or a stiffness, which is nearly the same.
        """
        mine = self.log == log
        if np.count_nonzero(mine) < MOMENTS:
            return None
        begin, length = float(self.time_s[mine][0]), float(np.ptp(self.time_s[mine]))
        moments = begin + np.linspace(EDGE, 1.0 - EDGE, MOMENTS) * length
        behind = [mine * (self.time_s > t) for t in moments.tolist()]
        by_kind = {
            kind: np.array([self._taken(shape * after) for after in behind])
            for kind, shape in self.shapes.items()
        }
        likeliest = max(by_kind, key=lambda kind: float(by_kind[kind].max()))
        taken = by_kind[likeliest]
        best = int(taken.argmax())
        far = np.abs(np.arange(MOMENTS) - best) > FAR_STEPS
        most = float(taken[best])
        is_there = most > LEAST_TAKEN * misfit and float(taken[far].max()) < DISTINCT * most
        is_steady = float(np.median(taken)) > MEDIAN_SHARE * most
        if not is_there or is_steady or likeliest == GAIN:
            return None
        name = self.model.problem.logs[log].name
        return self.seen_again(ZeroJump(name, float(moments[best]), 0.0))[0]

    def seen_again(self, jump: ZeroJump) -> tuple[ZeroJump, float]:
        """A jump, of which the size that it has was taken out, at the moment that takes most.

        And what it takes, in variances of what is left.
        """
        logs = self.model.problem.logs
        mine = self.log == next(k for k, member in enumerate(logs) if member.name == jump.log)
        left = self.left + project_out(self.basis, mine * jump.at(self.time_s))
        by_kind = self._by_all_of_it if LOAD in self.shapes else self._by_its_course
        found = by_kind(left, mine, jump)
        rest = self._without(left, mine, found)
        before, behind = _whitened(rest, [left[mine], rest])
        return found, before - behind

    def _by_all_of_it(self, left: Array, mine: BoolArray, jump: ZeroJump) -> ZeroJump:
        """As a zero or a load, whichever takes more of the whole log."""
        found = {
            ZERO: self._nearest(left, mine, replace(jump, kind=ZERO, course=reading_jumps)),
            LOAD: self._load_nearest(left, mine, replace(jump, kind=LOAD)),
        }
        rests = {kind: self._without(left, mine, other) for kind, other in found.items()}
        kind, other = sorted(rests, key=lambda kind: float(rests[kind] @ rests[kind]))
        most, least = _whitened(rests[kind], [rests[other], rests[kind]])
        return found[kind] if most - least > DECISIVE else replace(found[kind], kind=EITHER)

    def _by_its_course(self, left: Array, mine: BoolArray, jump: ZeroJump) -> ZeroJump:
        """As a zero or a load, by the course about its moment."""
        again = self._nearest(left, mine, jump)
        time_s = self.time_s[mine]
        whole = self.residual[mine] + jump.at(time_s)
        noise = fit_ar([whole - again.at(time_s)])
        shift = shift_at([again.time_s], self.model, time_s, whole, noise)
        if shift is not None:
            known = replace(again, kind=shift.kind, course=shift.course)
        else:
            known = replace(again, kind=EITHER, course=reading_jumps)
        return known if known.course is again.course else self._nearest(left, mine, known)

    def _nearest(self, left: Array, mine: BoolArray, jump: ZeroJump) -> ZeroJump:
        """The jump at the sample near its moment behind which it takes most."""
        off = np.abs(self.time_s[mine] - jump.time_s)
        reach = max(self._reach_s(mine), float(off.min()))  # readings may be lost there
        near = self.time_s[mine][off <= reach]
        placed = (replace(jump, time_s=t) for t in near.tolist())
        return self._most(left, mine, placed)

    def _load_nearest(self, left: Array, mine: BoolArray, jump: ZeroJump) -> ZeroJump:
        """A load at the moment near that of a jump at which it takes most, along its course."""
        reach = self._reach_s(mine)
        for _ in range(ZOOMS):
            moments = jump.time_s + np.linspace(-reach, reach, ZOOM_MOMENTS)
            placed = (
                replace(jump, time_s=t, course=self._course(mine, t)) for t in moments.tolist()
            )
            jump, reach = self._most(left, mine, placed), reach / ZOOM
        return jump

    def _course(self, mine: BoolArray, time_s: float) -> Course:
        """How a load that is put on at a moment of a log shifts the output."""
        column = by_load(self.model, self.scale, time_s)[mine]
        since_s = self.time_s[mine] - time_s
        behind = column[since_s > 0.0]
        mean = float(np.mean(behind)) if behind.size else 0.0
        if not mean:
            return reading_jumps
        return LoadInLog(since_s, column / mean, self.shapes[LOAD][mine] / mean)

    def _taken(self, column: Array) -> float:
        """How much a column takes away of what is left."""
        return _fall(self.left, project_out(self.basis, column))

    def _most(self, left: Array, mine: BoolArray, jumps: Iterable[ZeroJump]) -> ZeroJump:
        """The jump that takes most of a sum of squares, with the size at which it does."""
        steps = [(jump, project_out(self.basis, self._step(mine, jump))) for jump in jumps]
        jump, step = max(steps, key=lambda one: _fall(left, one[1]))
        power = max(float(step @ step), np.finfo(float).tiny)
        return replace(jump, size=float(step @ left) / power)

    def _without(self, left: Array, mine: BoolArray, jump: ZeroJump) -> Array:
        """What is left of a log without a jump."""
        whole: Array = left - project_out(self.basis, mine * jump.at(self.time_s))
        return whole[mine]

    def _step(self, mine: BoolArray, jump: ZeroJump) -> Array:
        """A jump of size one of a log."""
        return mine * replace(jump, size=1.0).at(self.time_s)

    def _reach_s(self, mine: BoolArray) -> float:
        """How far off its moment a jump is looked for."""
        return float(np.ptp(self.time_s[mine])) / MOMENTS


def _fall(left: Array, step: Array) -> float:
    """How much of a sum of squares a column takes away."""
    return float((step @ left) ** 2 / max(float(step @ step), np.finfo(float).tiny))


def _whitened(noise: Array, residuals: Sequence[Array]) -> list[float]:
    """Sums of squares of residuals of one log, in variances of what is white of its noise."""
    known = fit_ar([noise])
    variance = max(known.sigma_innovation**2, np.finfo(float).tiny)
    return [float(np.sum(whiten(known, left) ** 2)) / variance for left in residuals]
