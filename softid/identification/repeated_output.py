"""An output that a slower sensor delivers: each reading is repeated until the next one arrives.

A camera of 30 frames a second in a log of 100 rows a second says one thing three times. The repeats
are no readings: they are late, by one row, by two, as a lag of the sensor would be.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.channels import PRESSURE_COMMAND
from softid.excitation import run_starts
from softid.identification.repeated_values import hold_of, new_readings
from softid.log import Log

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

DRIVEN_RUNS = 0.5
"""Share of the runs of equal values in which the input moves, above which they are readings that a
gauge repeats, however far apart they are."""


def repeated_readings(log: Log) -> BoolArray:
    """At which rows every output repeats what it said before, shape (n,).

    Parameters
    ----------
    log
        A log; a commanded output is what it is at every row.

    Examples
    --------
    >>> readings = np.random.default_rng(0).normal(size=200)
    >>> channels = {"pressure": np.arange(600.0), "angle": np.repeat(readings, 3)}
    >>> repeated_readings(Log.from_arrays(np.arange(600.0), channels))[:6].tolist()
    [False, True, True, False, True, True]
    """
    return rows_without_news(log) & ~log.masked


def rows_without_news(log: Log) -> BoolArray:
    """As `repeated_readings`, masked rows included, shape (n,)."""
    every = np.ones(len(log), bool)
    for name in log.outputs:
        if name == PRESSURE_COMMAND:
            return np.zeros(len(log), bool)
        every &= _repeated(log.time_s, log.channels[name].values, log.channels[log.input].values)
    return every


def _repeated(time_s: Array, values: Array, driving: Array) -> BoolArray:
    """At which rows one channel repeats the value before; a missing value repeats none."""
    finite = np.isfinite(values)
    known = slice(None) if finite.all() else finite
    follows = not _stays_while_driven(values[known], driving[known])
    hold = hold_of(time_s[known], values[known], may_be_set=follows)
    if hold is None:
        return np.zeros(values.size, bool)
    found = finite.copy()
    fresh = new_readings(time_s[known], values[known], hold)
    found[np.flatnonzero(finite)[fresh]] = False
    return found


def _stays_while_driven(values: Array, driving: Array) -> bool:
    """Whether the input moves within most runs of equal values, so that these are no levels of it.

    What moves at rest with its input stays where that does; a gauge knows nothing of it.
    """
    starts = run_starts(values)
    if starts.size < 2:
        return False
    moves = np.concatenate(([False], driving[1:] != driving[:-1]))
    moves[starts] = False
    return float(np.mean(np.logical_or.reduceat(moves, starts))) > DRIVEN_RUNS
