"""The clock of a log: rate, jitter, gaps and stalls."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, log10

import numpy as np
import numpy.typing as npt

from softid.intersample import MAD_TO_STD
from softid.log import Log

Array = npt.NDArray[np.float64]

GAP_PERIODS = 3.0
"""Interval, in median ones, above which samples are missing: two of them at least. Where
`GAP_SIGMAS` asks for a longer one, that counts."""

GAP_SIGMAS = 8.0
"""Interval, in robust standard deviations above the median one, above which samples are missing.
Where `GAP_PERIODS` asks for a longer one, that counts."""

CLOSE = 0.2
"""Interval, in median ones, below which a sample comes close behind another, as two messages do
that are read at once."""

COARSE_CLOCK = 0.02
"""Tick of the time stamps, in periods, from which their clock is coarse: it rounds an interval by
0.8 % rms."""

FINE_CLOCK = 0.9
"""Tick of the time stamps, in periods, up to which one is looked for: one of about a period is the
sampling itself."""

ON_THE_TICK = 1e-3
"""Distance from a tick, in ticks, within which a time lies on it: the rounding of large times."""


@dataclass(frozen=True)
class Gap:
    """An interval between two samples that is much longer than usual.

    Attributes
    ----------
    index
        Sample before it.
    start_s
        Time of that sample.
    length_s
        Time to the next sample.
    """

    index: int
    start_s: float
    length_s: float


@dataclass(frozen=True)
class Sampling:
    """When the samples were taken.

    Attributes
    ----------
    n
        Number of samples.
    start_s, duration_s
        First time, and time from there to the last sample.
    period_s, rate_hz
        Median interval and its inverse.
    mean_rate_hz
        Number of intervals over the duration.
    jitter
        Robust standard deviation of the intervals over the median interval.
    shortest_s, longest_s
        Extreme intervals.
    close_share
        Share of intervals shorter than a fifth of the median.
    clock_step_s
        Resolution of the time stamps when it is coarse, 2 % of the period or more.
    gap_limit_s
        Length above which an interval is a gap: three medians, and clear of the jitter.
    stall_limit_s
        Length above which a gap is a stall and splits the log into segments.
    gaps
        Intervals above the limit that are no stalls.
    stalls
        Intervals above their limit.
    segments
        Number of segments between stalls; a single sample between two stalls is none.
    """

    n: int
    start_s: float
    duration_s: float
    period_s: float
    rate_hz: float
    mean_rate_hz: float
    jitter: float
    shortest_s: float
    longest_s: float
    close_share: float
    clock_step_s: float | None
    gap_limit_s: float
    stall_limit_s: float
    gaps: tuple[Gap, ...]
    stalls: tuple[Gap, ...]
    segments: int


def describe_sampling(log: Log) -> Sampling:
    """Measure when the samples of a log were taken.

    Jitter is 1.4826 times the median absolute deviation of the intervals, over their median, so
    that gaps and stalls do not count.
    """
    intervals = np.diff(log.time_s)
    period = float(np.median(intervals))
    spread = MAD_TO_STD * float(np.median(np.abs(intervals - period)))
    duration = float(log.time_s[-1] - log.time_s[0])
    threshold = max(GAP_PERIODS * period, period + GAP_SIGMAS * spread)
    limit = min(threshold, log.stall_s)
    long = np.flatnonzero(intervals > limit)
    found = [Gap(int(k), float(log.time_s[k]), float(intervals[k])) for k in long]
    return Sampling(
        n=len(log),
        start_s=float(log.time_s[0]),
        duration_s=duration,
        period_s=period,
        rate_hz=1.0 / period,
        mean_rate_hz=intervals.size / duration,
        jitter=spread / period,
        shortest_s=float(intervals.min()),
        longest_s=float(intervals.max()),
        close_share=float(np.mean(intervals < CLOSE * period)),
        clock_step_s=_clock_step(log, period),
        gap_limit_s=limit,
        stall_limit_s=log.stall_s,
        gaps=tuple(g for g in found if g.length_s <= log.stall_s),
        stalls=tuple(g for g in found if g.length_s > log.stall_s),
        segments=len(log.segments()),
    )


def _clock_step(log: Log, period: float) -> float | None:
    """The largest of 1, 2, 5 × 10^k s of which all times are multiples, when it is coarse.

    Samples at regular intervals say nothing of the clock that stamped them.
    """
    since = log.time_s - log.time_s[0]
    if _are_multiples(since, float(since[-1]) / max(round(float(since[-1]) / period), 1)):
        return None
    decade = floor(log10(period))
    steps = [m * 10.0**e for e in range(decade, decade - 3, -1) for m in (5.0, 2.0, 1.0)]
    for step in steps:
        if not COARSE_CLOCK * period <= step < FINE_CLOCK * period:
            continue
        if _are_multiples(since, step):
            return step
    return None


def _are_multiples(times: Array, step: float) -> bool:
    ticks = times / step
    return bool(np.abs(ticks - np.round(ticks)).max() < ON_THE_TICK)
