"""Jumps of a sensor's zero, or of a load, and logs without them.

A load that is put on a linear actuator shifts the readings as a sensor does that slips, once the
motion has settled; another actuator at every level of its input by another amount.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.changes.loads import LoadInLog
from softid.diagnosis.changes.shifts import EITHER, LOAD, ZERO, Course, reading_jumps
from softid.diagnosis.logs.decimation import AveragedLog
from softid.errors import Issue
from softid.identification.slow_outputs import SlowOutputLog
from softid.log import Log

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
    stays
        Whether what is held out goes on as behind the moment, so that the log is taken as if it had
        been so from its start on.
    """

    log: str
    time_s: float
    size: float
    kind: str = ZERO
    course: Course = reading_jumps
    stays: bool = False

    def at(self, time_s: Array) -> Array:
        """What is added at some times, to the log as it is before the moment or behind it.

        Parameters
        ----------
        time_s
            Times of the log, shape (n,).
        """
        since_s = time_s - self.time_s
        added = self.course(since_s)
        if not self.stays:
            return self.size * added
        if isinstance(self.course, LoadInLog):
            return self.size * (added - self.course.throughout(since_s))
        return self.size * (added - 1.0)


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


def with_jumps_exchanged(log: Log, out: Iterable[ZeroJump], others: Iterable[ZeroJump]) -> Log:
    """A log out of which jumps were taken, as it is without others in their place.

    Parameters
    ----------
    log
        The log without jumps.
    out
        What was taken out of any logs.
    others
        What is to be taken out of them.
    """
    put_back = (replace(jump, size=-jump.size) for jump in out)
    for jump in (*put_back, *others):
        if jump.log == log.name:
            log = _without(log, jump)
    return log


def is_without_jumps(log: Log) -> bool:
    """Whether jumps were taken out of a log.

    Parameters
    ----------
    log
        A log.
    """
    return any(issue.code == ZERO_JUMP for issue in log.issues)


def _issue(log: Log, jump: ZeroJump) -> Issue:
    name = log.outputs[0]
    channel = log.channels[name]
    size = f"{jump.size * channel.display_factor:+.3g} {channel.display_unit}"
    told, remedy = IN_WORDS[jump.kind]
    if isinstance(jump.course, LoadInLog):
        size = f"{size} on average"
    what = told.format(name=name, size=size, time=f"{jump.time_s:.4g} s of {log.name}")
    taken = "as if it had been so from the start" if jump.stays else "without that"
    return Issue(
        ZERO_JUMP,
        "warning",
        f"{what}; the readings are taken {taken}",
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
