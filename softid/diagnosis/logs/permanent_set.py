"""What remains of a motion when its input is back where it began."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.channels import Channel
from softid.errors import Issue
from softid.excitation import second_difference_noise, settled_windows
from softid.log import Log

Array = npt.NDArray[np.float64]

RESIDUAL_SET = "residual-set"
"""Code of the remark that the first cycle of a log leaves a set."""

SAME_LEVEL = 0.05
"""Two inputs count as the same within this share of the input's span."""

STEEPEST = 3.0
"""A static curve is at most so many times as steep as it is on the average: so much of a set may
come from the small difference of the two inputs."""

AWAY = 0.5
"""A cycle leads at least so far from where it began, as a share of the span."""

NOTABLE_SET = 0.05
"""A set of less than this share of the output's range is not told."""

LONGEST_START_S = 1.0
"""Longest part, in s, of a rest at the beginning that is averaged for where the output began."""

SHORTEST_START_S = 0.05
"""A log that leaves its first level sooner may begin in mid-motion."""

REST_TAIL = 0.25
"""Share of a rest, at its end, in which the output is to have settled."""

STILL_GOING = 0.05
"""The output has settled when the halves of the window's tail differ by less than this share of the
set."""

LEAST_REST_TIMES = 4.0
"""A rest lasts so many time constants of the motion at least: 2 % of a move are left then."""

NOISES = 4.957
"""A set is more than so many standard deviations of white noise: three times its median second
difference."""

AS_ZERO = 1e-4
"""A reading below this share of the largest is told as zero."""


@dataclass(frozen=True)
class ResidualSet:
    """Position before the first cycle of a log and after it, at the same input.

    Attributes
    ----------
    input_level
        Input before and after, canonical unit.
    before, after
        Output at rest, canonical unit.
    share
        Their difference as a share of the output's range.
    """

    input_level: float
    before: float
    after: float
    share: float


def residual_set(log: Log, output: str, motion_s: float = 0.0) -> ResidualSet | None:
    """The set that the first cycle of a log leaves; None where the log cannot show one.

    Parameters
    ----------
    log
        A log that begins at rest and holds its input at the first level again later.
    output
        Channel that is looked at.
    motion_s
        Time constant of the motion; what is still under way in a rest is no set.

    Examples
    --------
    >>> time_s = np.arange(400) * 0.01
    >>> pressure = np.repeat([0.0, 50.0, 0.0, 50.0], 100)
    >>> angle = np.repeat([0.0, 1.0, 0.2, 1.1], 100)
    >>> log = Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})
    >>> found = residual_set(log, "angle")
    >>> round(found.after, 3), round(found.share, 3)
    (0.2, 0.182)
    """
    u, y = log.channels[log.input].values, log.channels[output].values
    used = np.isfinite(u) & np.isfinite(y) & ~log.masked
    time_s, u, y = log.time_s[used], u[used], y[used]
    span = float(np.ptp(u)) if u.size else 0.0
    if span <= 0.0 or np.ptp(y) <= 0.0:
        return None
    away = np.abs(u - u[0])
    left = int(np.argmax(away > SAME_LEVEL * span))
    if time_s[left] - time_s[0] < SHORTEST_START_S:
        return None
    start = slice(0, max(min(left, int(np.searchsorted(time_s, time_s[0] + LONGEST_START_S))), 1))
    cycle = int(np.argmax(away > AWAY * span))
    for window in settled_windows(time_s, u, tail=REST_TAIL):
        apart = abs(window.level - float(np.median(u[start]))) / span
        rests_s = (time_s[window.stop - 1] - time_s[window.start]) / REST_TAIL
        if (
            apart <= SAME_LEVEL
            and window.start > cycle > 0
            and rests_s >= LEAST_REST_TIMES * motion_s
        ):
            return _set_of(y, start, slice(window.start, window.stop), window.level, apart)
    return None


def _set_of(y: Array, start: slice, tail: slice, level: float, apart: float) -> ResidualSet | None:
    """The set between two stretches of the output; None while it still moves or is but noise.

    ``apart`` is the difference of the two inputs as a share of the input's span.
    """
    before, after = float(np.median(y[start])), float(np.median(y[tail]))
    size = abs(after - before)
    noise = NOISES * second_difference_noise(y)
    span = float(np.ptp(y))
    if _change(y, tail) > STILL_GOING * size or size <= noise + STEEPEST * apart * span:
        return None
    if _change(y, start) > STILL_GOING * size + noise:
        return None  # a log that begins in mid-motion
    return ResidualSet(level, before, after, size / span)


def _change(y: Array, part: slice) -> float:
    """From one half of a stretch to the other; 0 for a single sample."""
    middle = (part.start + part.stop) // 2
    first, second = y[part.start : middle], y[middle : part.stop]
    return abs(float(np.median(first) - np.median(second))) if first.size else 0.0


def permanent_set_issues(logs: Iterable[Log], motion_s: float) -> tuple[Issue, ...]:
    """A remark for every log whose first cycle leaves a notable set in its first output.

    Parameters
    ----------
    logs
        The logs.
    motion_s
        As in `residual_set`.
    """
    found = []
    for log in logs:
        output = log.outputs[0]
        left = residual_set(log, output, motion_s)
        if left is not None and left.share > NOTABLE_SET:
            found.append(_told(log, output, left))
    return tuple(found)


def _told(log: Log, output: str, left: ResidualSet) -> Issue:
    channel, driving = log.channels[output], log.channels[log.input]
    return Issue(
        RESIDUAL_SET,
        "info",
        f"{log.name}: {output} begins at {_shown(channel, left.before)} and rests at "
        f"{_shown(channel, left.after)} after the first cycle, with the {log.input} back at "
        f"{_shown(driving, left.input_level)}: a set of {100.0 * left.share:.0f} % of its range; "
        "hysteresis and creep of the material leave one, and so does a sensor that warms up",
        "run a few cycles before the log, and end it with a rest of a minute that shows whether "
        "the set goes back",
    )


def _shown(channel: Channel, value: float) -> str:
    unit = "" if channel.display_unit == "1" else f" {channel.display_unit}"
    is_zero = abs(value) < AS_ZERO * float(np.nanmax(np.abs(channel.values)))
    return f"{0.0 if is_zero else value * channel.display_factor:.3g}{unit}"
