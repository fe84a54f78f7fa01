"""Whether a channel repeats its values until a slower sensor or the next packet brings new ones."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.excitation import (
    SampleHold,
    find_hold,
    find_quantisation,
    fresh_samples,
    run_starts,
)

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

LEAST_FACTOR = 1.5
"""Samples for which a value is repeated at least: steps that somebody wanted, beside a course that
brings news at every sample, repeat as many values, but not each."""

LEAST_OF_LOST = 1.1
"""Samples for which a value is repeated at least where values do not come again: then no repeat is
by chance, and one sample in eleven whose reading was lost counts."""

NEW_VALUES = 0.75
"""Share of the runs of equal values with a value of their own from which values do not come again;
the camera of the gripper finger has 0.85 and more, pressures on a grid 0.3 and less."""

MUCH_LONGER = 4.0
"""Runs of equal values so many times as long as the commonest are holds that somebody wanted."""

LONGER = 1.5
"""A run so many times as long as the longest of so many by chance is a reading that stays."""


def hold_of(time_s: Array, values: Array, *, may_be_set: bool = True) -> SampleHold | None:
    """How a channel repeats what a slower sensor says; None for one that does not.

    Parameters
    ----------
    time_s, values
        Samples of the channel, each of shape (n,), none of them missing.
    may_be_set
        Whether somebody may have set the values, as the levels of a staircase.
    """
    if not _repeats(values):
        return None
    grid = find_quantisation(values)
    hold = find_hold(time_s, values, grid.step if grid else None, may_be_set=may_be_set)
    least = LEAST_OF_LOST if has_new_values(values) else LEAST_FACTOR
    return hold if hold is not None and hold.factor >= least else None


def new_readings(time_s: Array, values: Array, hold: SampleHold) -> IntArray:
    """Indices of the samples that bring a new reading, shape (m,).

    Where values do not come again, a run of equal ones is one reading, unless it is so long that
    what is measured stands still.

    Parameters
    ----------
    time_s, values
        As in `hold_of`.
    hold
        What it found.
    """
    fresh = fresh_samples(time_s, values, hold)
    if not has_new_values(values):
        return fresh
    starts = run_starts(values)
    lengths = np.diff(starts, append=values.size)
    in_long = np.repeat(lengths > _longest(hold.factor, starts.size), lengths)
    return np.union1d(starts, fresh[in_long[fresh]])


def has_new_values(values: Array) -> bool:
    """Whether the values of a channel do not come again, so that no repeat is by chance.

    Parameters
    ----------
    values
        Samples of the channel, shape (n,), none of them missing.
    """
    once = values[run_starts(values)]
    return bool(np.unique(once).size >= NEW_VALUES * once.size)


def _repeats(values: Array) -> bool:
    """Whether runs of equal values are so long that a slower sensor may make them; soon told."""
    changes = int(np.count_nonzero(values[1:] != values[:-1]))
    if values.size - 1 < LEAST_OF_LOST * changes:
        return False  # all runs together are too short, the longest among them
    lengths = np.diff(run_starts(values))
    if lengths.size == 0:
        return False
    usual = int(np.argmax(np.bincount(lengths)))
    return float(np.mean(lengths[lengths <= MUCH_LONGER * usual])) >= LEAST_OF_LOST


def _longest(factor: float, runs: int) -> float:
    """Samples for which a reading may be repeated, where others were lost at random.

    The longest of some runs of a geometric law with that mean is about 1 + ln(runs)/ln(1/p), with
    the share p = 1 − 1/factor of what was lost.
    """
    share = 1.0 - 1.0 / factor
    return 1.0 + LONGER * float(np.log(runs) / -np.log(share))
