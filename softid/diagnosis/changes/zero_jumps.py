"""Jumps of a sensor's zero, or of a load, that other causes of a misfit may hide.

A sensor that slips is told by `change_point` where that is all there is. Beside a cause it takes a
part of the misfit only, and the cause cannot be found before the jump is taken out of the readings.
A load that is put on a linear actuator shifts the readings, too, once the motion has settled.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.changes.change_point import EDGE, MEDIAN_SHARE, MOMENTS
from softid.diagnosis.changes.shifts import EITHER, LOAD, ZERO, Course, reading_jumps, shift_at
from softid.diagnosis.logs.decimation import AveragedLog
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.projection import Rows, added_basis, basis_of, project_out, rows_of
from softid.errors import Issue
from softid.identification.slow_outputs import SlowOutputLog
from softid.log import Log
from softid.uncertainty.autoregression import fit_ar

Array = npt.NDArray[np.float64]

ZERO_JUMP = "zero-jump"
"""Code of the remark that readings are taken without a jump."""

SLIPPED, LOADED = "a slipped mount or a touched cable", "a payload that was put on or taken off"
IN_WORDS = {
    ZERO: (
        "the zero of {name} jumps by {size} at {time}, as where a sensor slips or is touched",
        SLIPPED,
    ),
    LOAD: (
        "the motion goes to another place at {time}, {name} by {size}, as where a load is put on "
        "or taken off",
        LOADED,
    ),
    EITHER: (
        "the zero of {name} jumps by {size} at {time}, or a load is put on or taken off",
        f"{SLIPPED}, or {LOADED}",
    ),
}
"""Each kind of a jump in words, and what to look for."""

LEAST_TAKEN = 0.25
"""A jump must take away so much of the misfit above the noise."""

DISTINCT, FAR_STEPS = 0.95, 3
"""Share of what a jump takes away that one at any moment further off than so many steps of the
search must stay below."""


@dataclass(frozen=True)
class ZeroJump:
    """The first output is shifted from a moment on.

    Attributes
    ----------
    log
        Name of the log.
    time_s
        The last moment before.
    size
        What is added from then on, in the output's unit.
    kind
        ``zero``, ``load``, or ``zero or load``, as of a `Shift`.
    course
        How it comes to be added.
    """

    log: str
    time_s: float
    size: float
    kind: str = ZERO
    course: Course = reading_jumps

    def at(self, time_s: Array) -> Array:
        """What is added at some times.

        Parameters
        ----------
        time_s
            Times of the log, shape (n,).
        """
        return self.size * self.course(time_s - self.time_s)


def zero_jumps(model: Candidate, excess: float) -> tuple[ZeroJump, ...]:
    """The most likely jump of each log, where one takes away a part of the misfit.

    The residual is regressed on a step at each moment, beside the derivatives of the response and
    the rate of the output. Whether it is one is seen by what is left without it.

    Parameters
    ----------
    model
        A model over its logs.
    excess
        Variance of what it leaves above that of the noise, as a share of the latter.
    """
    look = _Steps.of(model)
    if look is None or not excess > 0.0:
        return ()
    misfit = float(look.left @ look.left) * excess / (1.0 + excess)
    found = (look.likely_jump(k, model, misfit) for k in range(len(model.problem.logs)))
    return tuple(jump for jump in found if jump is not None)


def seen_again(model: Candidate, jumps: Sequence[ZeroJump]) -> tuple[ZeroJump, ...]:
    """Moments and sizes of jumps as a better model sees them.

    Parameters
    ----------
    model
        A model over logs without the jumps.
    jumps
        What was taken out of its logs.
    """
    look = _Steps.of(model)
    if look is None:
        return tuple(jumps)
    return tuple(look.seen_again(jump, model) for jump in jumps)


def without_jumps(log: Log, jumps: Iterable[ZeroJump]) -> Log:
    """The log without jumps of its zero, and with a remark on each.

    Parameters
    ----------
    log
        A log.
    jumps
        Jumps of any logs.
    """
    for jump in jumps:
        if jump.log == log.name:
            log = replace(_without(log, jump), issues=(*log.issues, _issue(log, jump)))
    return log


def _issue(log: Log, jump: ZeroJump) -> Issue:
    name = log.outputs[0]
    channel = log.channels[name]
    size = f"{jump.size * channel.display_factor:+.3g} {channel.display_unit}"
    told, remedy = IN_WORDS[jump.kind]
    what = told.format(name=name, size=size, time=f"{jump.time_s:.4g} s")
    return Issue(
        ZERO_JUMP,
        "warning",
        f"{log.name}: {what}; the causes are those of the readings without that",
        f"look at what happened then, such as {remedy}",
    )


def _without(log: Log, jump: ZeroJump) -> Log:
    name = log.outputs[0]
    channel = log.channels[name]
    values = channel.values - jump.at(log.time_s)
    channels = {**log.channels, name: replace(channel, values=values)}
    if isinstance(log, (AveragedLog, SlowOutputLog)):
        return replace(log, channels=channels, recorded=_without(log.recorded, jump))
    return replace(log, channels=channels)


@dataclass(frozen=True, eq=False)
class _Steps:
    """What a model leaves of the first output, and a step of it at any moment.

    Attributes
    ----------
    basis
        Of the derivatives of the response and the rate of the output, shape (m, k).
    residual, left
        What the model leaves, and what is left of that beside them, shape (m,).
    time_s, log
        Time and index of the log of each sample, shape (m,).
    """

    basis: Array
    residual: Array
    left: Array
    time_s: Array
    log: npt.NDArray[np.intp]

    @classmethod
    def of(cls, model: Candidate) -> _Steps | None:
        """Of a model where it stands; None where it runs away."""
        first = model.problem.outputs[0]
        rows = [row for row in rows_of(model) if row.channel == first]
        if not all(np.isfinite(row.jacobian).all() for row in rows):
            return None
        jacobian = np.concatenate([row.jacobian for row in rows])
        rate = np.concatenate([row.motion.v[row.used] for row in rows])[:, None]
        basis = basis_of(jacobian)
        basis = np.column_stack((basis, added_basis(basis, rate)))
        residual = np.concatenate([row.residual for row in rows])
        left = project_out(basis, residual)
        time_s = np.concatenate([row.motion.time_s[row.used] for row in rows])
        return cls(basis, residual, left, time_s, np.concatenate([_index(row) for row in rows]))

    def at(self, log: int, time_s: float, course: Course = reading_jumps) -> Array:
        """A step of a log at a moment, beside what the model can make up for."""
        return project_out(self.basis, (self.log == log) * course(self.time_s - time_s))

    def fall(self, left: Array, log: int, time_s: float, course: Course = reading_jumps) -> float:
        """How much of a sum of squares a step takes away."""
        step = self.at(log, time_s, course)
        return float((step @ left) ** 2 / max(float(step @ step), np.finfo(float).tiny))

    def likely_jump(self, log: int, model: Candidate, misfit: float) -> ZeroJump | None:
        """The moment at which a step takes most, if none elsewhere takes as much."""
        mine = self.time_s[self.log == log]
        if mine.size < MOMENTS:
            return None
        length = float(np.ptp(mine))
        moments = float(mine[0]) + np.linspace(EDGE, 1.0 - EDGE, MOMENTS) * length
        taken = np.array([self.fall(self.left, log, t) for t in moments.tolist()])
        best = int(taken.argmax())
        far = np.abs(np.arange(MOMENTS) - best) > FAR_STEPS
        most = float(taken[best])
        is_there = most > LEAST_TAKEN * misfit and float(taken[far].max()) < DISTINCT * most
        if not is_there or float(np.median(taken)) > MEDIAN_SHARE * most:
            return None
        jump = ZeroJump(model.problem.logs[log].name, float(moments[best]), 0.0)
        return self._of_its_kind(jump, log, model)

    def seen_again(self, jump: ZeroJump, model: Candidate) -> ZeroJump:
        """A jump that was taken out, at the moment near its own that takes most."""
        log = next(k for k, member in enumerate(model.problem.logs) if member.name == jump.log)
        return self._of_its_kind(jump, log, model)

    def _of_its_kind(self, jump: ZeroJump, log: int, model: Candidate) -> ZeroJump:
        """A jump, of which the size that it has was taken out, as a zero or a load."""
        left = self.left + jump.size * self.at(log, jump.time_s, jump.course)
        again, mine = self._nearest(left, log, jump), self.log == log
        time_s = self.time_s[mine]
        whole = self.residual[mine] + jump.at(time_s)
        noise = fit_ar([whole - again.at(time_s)])
        shift = shift_at([again.time_s], model, time_s, whole, noise)
        if shift is not None:
            known = replace(again, kind=shift.kind, course=shift.course)
        else:
            is_linear = model.problem.model.without_effects.is_linear
            known = replace(again, kind=EITHER if is_linear else ZERO, course=reading_jumps)
        return known if known.course is again.course else self._nearest(left, log, known)

    def _nearest(self, left: Array, log: int, jump: ZeroJump) -> ZeroJump:
        """The jump at the sample near its moment behind which it takes most."""
        mine = self.time_s[self.log == log]
        off = np.abs(mine - jump.time_s)
        reach = max(float(np.ptp(mine)) / MOMENTS, float(off.min()))  # readings may be lost there
        near = mine[off <= reach]
        at = max(near.tolist(), key=lambda t: self.fall(left, log, t, jump.course))
        step = self.at(log, at, jump.course)
        return replace(jump, time_s=at, size=float(step @ left / (step @ step)))


def _index(row: Rows) -> npt.NDArray[np.intp]:
    """Index of the log, at each of a row's samples."""
    return np.full(row.residual.size, row.place.log)
