"""Bounds and plausible values of the times of lags, relaxations and delays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from softid.effects.scale import Scale
from softid.parameters import Parameter

SHORTEST_PERIODS = 1e-3
"""Shortest lag in sampling intervals: it stands for none, which the logarithmic scale has not."""

LONGEST_SHARE = 0.25
"""Longest lag as a share of the log, which then holds four of them: it has settled before the
end."""

SETTLING_PERIODS = 5.0
"""Shortest relaxation in sampling intervals: one that is over sooner is part of the motion."""

LEAST_FACTOR = 10.0
"""Least ratio of the bounds of a time, that a search has some way even in a log of a few
samples."""

FIRST_PERIODS = 2.0
"""Shortest start of a time in sampling intervals: one that two samples just show."""

FIRST_SHARE = 0.1
"""Shortest start of a time as a share of the longest time, where that is less, in a short log, that
starts are spread at all."""

SPREAD = 8.0
"""Least ratio of the last to the first start of a time, where the motion is quick."""


def time_bounds(scale: Scale, *, periods: float, share: float) -> tuple[float, float]:
    """Shortest and longest time, in seconds, that an effect may take.

    Parameters
    ----------
    scale
        Sizes of the logs.
    periods
        The shortest in sampling intervals.
    share
        The longest as a share of the longest log.
    """
    shortest = periods * scale.period_s
    return shortest, max(share * scale.duration_s, LEAST_FACTOR * shortest)


def start_times(time: Parameter, scale: Scale, shares: Sequence[float]) -> tuple[float, ...]:
    """Starts of a time, in seconds, within its bounds.

    Parameters
    ----------
    time
        The parameter as it is declared.
    scale
        Sizes of the logs.
    shares
        The starts as shares of the longest log.
    """
    return tuple(min(max(share * scale.duration_s, time.lower), time.upper) for share in shares)


def first_time(scale: Scale, longest: float, *, periods: float = FIRST_PERIODS) -> float:
    """Time, in seconds, of the shortest start.

    Parameters
    ----------
    scale
        Sizes of the logs.
    longest
        The longest start, in seconds.
    periods
        It in sampling intervals, where the log is long enough.
    """
    return min(periods * scale.period_s, FIRST_SHARE * longest)


def last_time(slowest_s: float, first_s: float, longest_s: float) -> float:
    """Time, in seconds, of the longest start.

    Parameters
    ----------
    slowest_s
        What the motion suggests.
    first_s
        The shortest start.
    longest_s
        What it may not exceed.
    """
    return min(max(slowest_s, SPREAD * first_s), longest_s)


def lag_bounds(scale: Scale) -> tuple[float, float]:
    """Shortest and longest time constant of a lag that a log could show.

    Parameters
    ----------
    scale
        Sizes of the logs.
    """
    return time_bounds(scale, periods=SHORTEST_PERIODS, share=LONGEST_SHARE)


def lag_times(scale: Scale) -> tuple[float, ...]:
    """Three plausible time constants, from two samples to the motion's own.

    Parameters
    ----------
    scale
        Sizes of the logs.
    """
    _, longest = lag_bounds(scale)
    shortest = first_time(scale, longest)
    slowest = last_time(scale.motion_s, shortest, longest)
    return tuple(np.geomspace(shortest, slowest, 3).tolist())


def lag_time(scale: Scale, meaning: str, source: str) -> Parameter:
    """The time constant τ of a lag, within `lag_bounds`; the middle one of `lag_times` at first.

    Parameters
    ----------
    scale
        Sizes of the logs.
    meaning, source
        What follows in that time, and where the law comes from.
    """
    shortest, longest = lag_bounds(scale)
    middle = lag_times(scale)[1]
    return Parameter("tau", middle, "s", shortest, longest, "log", meaning=meaning, source=source)
