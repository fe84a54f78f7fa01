"""Long and broken records as lines that a plot can afford: gaps stay gaps, peaks stay peaks."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from softid.log import STALL_MIN_PERIODS, STALL_MIN_S

Array = npt.NDArray[np.float64]

BUCKETS = 1000
"""About one bucket per pixel column of a figure 1,200 pixels wide."""


def segment_spans(segment_starts: Sequence[int], samples: int) -> tuple[slice, ...]:
    """The segments of a log as slices, of two samples or more.

    Parameters
    ----------
    segment_starts
        Index of each segment's first sample.
    samples
        Samples of the log.

    Examples
    --------
    >>> segment_spans((0, 4), 10)
    (slice(0, 4, None), slice(4, 10, None))
    """
    return tuple(slice(a, b) for a, b in pairwise([*segment_starts, samples]) if b - a > 1)


def broken_trace(
    time_s: Array, values: Array, segment_starts: Sequence[int] = (0,)
) -> tuple[Array, Array]:
    """A record without its missing samples, with a NaN wherever the line must break.

    A line breaks where a segment starts and where samples are missing for longer than
    max(0.5 s, 10 periods), the rule by which a log falls into segments. Shorter drop-outs, and a
    channel that is slower than the log's clock, are bridged.

    Parameters
    ----------
    time_s, values
        Samples, shape (n,); NaN where missing.
    segment_starts
        Index of each segment's first sample.

    Returns
    -------
    tuple of ndarray
        Times and values, each of shape (m,), with NaN values at the breaks.

    Examples
    --------
    >>> t = np.array([0.0, 0.1, 0.2, 5.0, 5.1])
    >>> broken_trace(t, np.array([1.0, np.nan, 2.0, 3.0, 4.0]), (0, 3))[1].tolist()
    [1.0, 2.0, nan, 3.0, 4.0]
    """
    there = np.flatnonzero(np.isfinite(values))
    if there.size < 2:
        return time_s[there], values[there]
    steps = np.diff(time_s[there])
    longest = max(STALL_MIN_S, STALL_MIN_PERIODS * float(np.median(steps)))
    segment = np.searchsorted(np.asarray(segment_starts), there, side="right")
    breaks = np.flatnonzero((steps > longest) | (np.diff(segment) > 0)) + 1
    middle = 0.5 * (time_s[there[breaks - 1]] + time_s[there[breaks]])
    return (
        np.insert(time_s[there], breaks, middle),
        np.insert(values[there], breaks, np.nan),
    )


def decimate(x: Array, y: Array, *, buckets: int = BUCKETS) -> tuple[Array, Array]:
    """Thin a line so that it looks the same: of each bucket keep both ends and the extremes.

    Parameters
    ----------
    x, y
        Points of the line in drawing order, shape (n,); a NaN in ``y`` breaks the line and is kept.
    buckets
        Number of buckets of equally many points.

    Returns
    -------
    tuple of ndarray
        At most six points per bucket (four where ``x`` rises) plus the breaks.

    Examples
    --------
    >>> y = np.zeros(100_000)
    >>> y[777] = 5.0
    >>> x, thin = decimate(np.arange(100_000.0), y, buckets=100)
    >>> thin.size < 401, thin.max(), x[thin.argmax()]
    (True, np.float64(5.0), np.float64(777.0))
    """
    size = -(-y.size // buckets)
    if size <= 4:
        return x, y
    first = np.arange(0, y.size, size)
    last = np.minimum(first + size, y.size) - 1
    kept = [first, last, np.flatnonzero(np.isnan(y))]
    for values in (x, y):
        padded = np.pad(values, (0, -y.size % size), constant_values=np.nan).reshape(-1, size)
        there = np.isfinite(padded)
        kept.append(first + np.where(there, padded, np.inf).argmin(axis=1))
        kept.append(first + np.where(there, padded, -np.inf).argmax(axis=1))
    chosen = np.unique(np.concatenate(kept))
    return x[chosen], y[chosen]


def thinned_points(x: Array, y: Array, *, buckets: int = BUCKETS) -> tuple[Array, Array]:
    """Thin a cloud of points along ``x``, keeping its outline; missing points are dropped."""
    there = np.isfinite(x) & np.isfinite(y)
    order = np.argsort(x[there], kind="stable")
    return decimate(x[there][order], y[there][order], buckets=buckets)


def padded_limits(*arrays: Array, margin: float = 0.05) -> tuple[float, float] | None:
    """Limits that hold all finite values with a margin; None when there is no finite value."""
    finite = [a[np.isfinite(a)] for a in arrays]
    finite = [a for a in finite if a.size]
    if not finite:
        return None
    low = float(min(a.min() for a in finite))
    high = float(max(a.max() for a in finite))
    room = margin * (high - low) if high > low else margin * abs(high) or 1.0
    return low - room, high + room
