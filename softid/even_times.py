"""Times at equal distances that stand for uneven ones, and no more of them than are needed."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

MOST_PER_SAMPLE = 10.0
"""Times at equal distances per sample at most. The median interval is the usual one in a log that
lost nine tenths of its samples; where samples come in bursts, it says how long a burst takes."""


def even_interval_s(*times_s: Array) -> float:
    """The median interval, or as much more as keeps the even times few; zero without intervals.

    Parameters
    ----------
    *times_s
        Rising times in s of one stretch of samples or of several, each of shape (n,).

    Examples
    --------
    >>> even_interval_s(np.array([0.0, 1.0, 2.0, 3.0, 5.0]))
    1.0

    Pairs, of which the median interval would make 40,000 times of six samples:

    >>> round(even_interval_s(np.array([0.0, 1e-5, 0.2, 0.20001, 0.4, 0.40001])), 6)
    0.008
    """
    interval_s = np.concatenate([np.diff(time_s) for time_s in times_s])
    if not interval_s.size:
        return 0.0
    return max(float(np.median(interval_s)), float(interval_s.mean()) / MOST_PER_SAMPLE)
