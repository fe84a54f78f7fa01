"""The clock of a log: rate, jitter, gaps and stalls."""

from __future__ import annotations

from math import floor, log10

import numpy as np
import numpy.typing as npt

from softid.log import Log
from softid.quality.findings import Gap, Sampling

Array = npt.NDArray[np.float64]

GAP_PERIODS = 3.0
GAP_SIGMAS = 8.0
CLOSE = 0.2
COARSE_CLOCK = 0.02
FINE_CLOCK = 0.9
ON_THE_TICK = 1e-3
MAD_TO_STD = 1.4826


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
    long = np.flatnonzero(intervals > min(threshold, log.stall_s))
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
    if _are_multiples(since, period):
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
