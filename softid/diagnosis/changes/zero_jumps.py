"""Jumps of a sensor's zero that other causes of a misfit may hide.

A sensor that slips is told by `change_point` where that is all there is. Beside a cause it takes a
part of the misfit only, and the cause cannot be found before the jump is taken out of the readings.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.changes.change_point import EDGE, MEDIAN_SHARE, MOMENTS
from softid.diagnosis.logs.decimation import AveragedLog
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.projection import Rows, added_basis, basis_of, project_out, rows_of
from softid.errors import Issue
from softid.identification.slow_outputs import SlowOutputLog
from softid.log import Log

Array = npt.NDArray[np.float64]

ZERO_JUMP = "zero-jump"
"""Code of the remark that readings are taken without a jump."""

LEAST_TAKEN = 0.25
"""A jump must take away so much of the misfit above the noise."""

DISTINCT, FAR_STEPS = 0.95, 3
"""Share of what a jump takes away that one at any moment further off than so many steps of the
search must stay below."""


@dataclass(frozen=True)
class ZeroJump:
    """The zero of the first output is another one from a moment on.

    Attributes
    ----------
    log
        Name of the log.
    time_s
        The last moment before.
    size
        What is added from then on, in the output's unit.
    """

    log: str
    time_s: float
    size: float


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
    found = (look.likely_jump(k, log, misfit) for k, log in enumerate(model.problem.logs))
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
    return tuple(look.seen_again(jump, model.problem.logs) for jump in jumps)


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
    return Issue(
        ZERO_JUMP,
        "warning",
        f"{log.name}: the zero of {name} jumps by {size} at {jump.time_s:.4g} s, as where a sensor "
        "slips or is touched; the causes are those of the readings without that jump",
        "look at what happened then, such as a slipped mount or a touched cable",
    )


def _without(log: Log, jump: ZeroJump) -> Log:
    name = log.outputs[0]
    channel = log.channels[name]
    values = channel.values - jump.size * (log.time_s > jump.time_s)
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
    left
        What the model leaves beside them, shape (m,).
    time_s, log
        Time and index of the log of each sample, shape (m,).
    """

    basis: Array
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
        left = project_out(basis, np.concatenate([row.residual for row in rows]))
        time_s = np.concatenate([row.motion.time_s[row.used] for row in rows])
        return cls(basis, left, time_s, np.concatenate([_index(row) for row in rows]))

    def at(self, log: int, time_s: float) -> Array:
        """A step of a log at a moment, beside what the model can make up for."""
        return project_out(self.basis, ((self.log == log) & (self.time_s > time_s)).astype(float))

    def fall(self, left: Array, log: int, time_s: float) -> float:
        """How much of a sum of squares a step takes away."""
        step = self.at(log, time_s)
        return float((step @ left) ** 2 / max(float(step @ step), np.finfo(float).tiny))

    def likely_jump(self, log: int, member: Log, misfit: float) -> ZeroJump | None:
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
        return self._nearest(self.left, log, member.name, float(moments[best]))

    def seen_again(self, jump: ZeroJump, logs: Sequence[Log]) -> ZeroJump:
        """A jump that was taken out, at the moment near its own that takes most."""
        log = next(k for k, member in enumerate(logs) if member.name == jump.log)
        left = self.left + jump.size * self.at(log, jump.time_s)
        return self._nearest(left, log, jump.log, jump.time_s)

    def _nearest(self, left: Array, log: int, name: str, time_s: float) -> ZeroJump:
        """The jump at the sample near a moment behind which a step takes most."""
        mine = self.time_s[self.log == log]
        off = np.abs(mine - time_s)
        reach = max(float(np.ptp(mine)) / MOMENTS, float(off.min()))  # readings may be lost there
        near = mine[off <= reach]
        at = max(near.tolist(), key=lambda t: self.fall(left, log, t))
        step = self.at(log, at)
        return ZeroJump(name, at, float(step @ left / (step @ step)))


def _index(row: Rows) -> npt.NDArray[np.intp]:
    """Index of the log, at each of a row's samples."""
    return np.full(row.residual.size, row.place.log)
