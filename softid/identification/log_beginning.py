"""The beginning of a long log, where that tells as much as all of it."""

from __future__ import annotations

import numpy as np

from softid.fitters.beginnings import LEAST_WAY
from softid.log import Log


def beginning(log: Log, samples: int) -> Log:
    """So many first samples, or twice as many again and again until the input travels enough there.

    Parameters
    ----------
    log
        A log, which is returned itself where it is no longer.
    samples
        How many.

    Examples
    --------
    >>> t = np.arange(100.0)
    >>> late = Log.from_arrays(t, {"pressure": np.where(t < 15, 0.0, t), "angle": t})
    >>> len(beginning(late, 10)), len(beginning(late, 50)), len(beginning(late, 200))
    (20, 50, 100)
    """
    if samples >= len(log):
        return log
    moves = np.abs(np.diff(log.channels[log.input].values))
    way = LEAST_WAY * float(moves.sum()) / len(log)
    while samples < len(log) and moves[:samples].sum() < way * samples:
        samples *= 2
    return log if samples >= len(log) else log.between(log.time_s[0], log.time_s[samples])
