"""What is worth a remark in when the samples were taken."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from softid.errors import Issue
from softid.quality.sampling import Gap, Sampling
from softid.quality.wording import NAMED, count, seconds

MUCH_JITTER = 0.2
"""Robust spread of the sampling interval, over its median, that is worth a remark."""

MANY_CLOSE = 0.02
"""Share of samples within a fifth of the interval that is more than a hiccup of the logger."""


def sampling_issues(sampling: Sampling) -> Iterator[Issue]:
    """Stalls, gaps, uneven intervals and samples that come too close, each with its remedy.

    Parameters
    ----------
    sampling
        What was found of the log's times.
    """
    if sampling.stalls:
        yield Issue(
            "stalls",
            "warning",
            f"{count(sampling.stalls, 'stall')} longer than {sampling.stall_limit_s:.3g} s "
            f"({_places(sampling.stalls)}) split the log into {sampling.segments} segments"
            + _left_alone(sampling),
            "each segment gets its own initial state; find out what blocks the logger",
        )
    if sampling.gaps:
        yield Issue(
            "gaps",
            "info",
            f"{count(sampling.gaps, 'gap')} longer than {1e3 * sampling.gap_limit_s:.3g} ms "
            f"({_places(sampling.gaps)})",
            None,
        )
    if sampling.jitter > MUCH_JITTER:
        yield Issue(
            "irregular-sampling",
            "info",
            f"the sampling interval varies by {100 * sampling.jitter:.0f} % about "
            f"{seconds(sampling.period_s)}",
            "nothing to do: the log's own times are used",
        )
    if sampling.close_share > MANY_CLOSE:
        yield Issue(
            "close-samples",
            "info",
            f"{100 * sampling.close_share:.0f} % of the samples follow the one before within a "
            "fifth of the usual interval",
            "check whether two messages are logged as two samples",
        )


def _left_alone(sampling: Sampling) -> str:
    alone = len(sampling.stalls) + 1 - sampling.segments
    return f" ({count(range(alone), 'single sample')} between stalls left out)" if alone else ""


def _places(gaps: Sequence[Gap]) -> str:
    named = ", ".join(f"{g.length_s:.2f} s at {g.start_s:.2f} s" for g in gaps[:NAMED])
    return named + (", …" if len(gaps) > NAMED else "")
