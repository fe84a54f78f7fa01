"""Logs whose input jumps within an interval at a moment that is known, or was estimated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.intersample import BEFORE
from softid.log import Log
from softid.log_kinds import KnottedLog, fields_of

Array = npt.NDArray[np.float64]

INSIDE = 0.02
"""Share of its interval that a jump keeps from either end: no row is put in beside another."""


class TimedLog(KnottedLog):
    """A log whose input goes at once from one sample to the next where it jumps.

    Attributes
    ----------
    knots
        Times and input just before and just behind each jump; see `KnottedLog`.
    """


def with_jumps_at(log: Log, spans_s: Sequence[Array], shares: Sequence[Array]) -> Log:
    """The log with jumps of the input at moments within their intervals.

    Parameters
    ----------
    log
        A log as it was recorded, between whose samples the input goes straight or is smooth.
    spans_s
        When the intervals of some jumps begin and end, each of shape (J, 2), in order.
    shares
        Where within its interval each jump is, from 0 to 1, each of shape (J,).

    Examples
    --------
    >>> channels = {"pressure": [0.0, 0.0, 50.0, 50.0], "angle": [0.0, 0.0, 1.0, 2.0]}
    >>> log = Log.from_arrays([0.0, 0.1, 0.2, 0.3], channels)
    >>> (segment,) = with_jumps_at(log, [np.array([[0.1, 0.2]])], [np.array([0.5])]).segments()
    >>> segment.time_s.round(4).tolist(), segment.input.tolist()
    ([0.0, 0.1, 0.1499, 0.15, 0.2, 0.3], [0.0, 0.0, 0.0, 50.0, 50.0, 50.0])
    """
    between_s = np.concatenate([*spans_s, np.empty((0, 2))])
    if between_s.size == 0:
        return log
    width_s = np.diff(between_s).ravel()
    inside = np.clip(np.concatenate(shares), INSIDE, 1.0 - INSIDE)
    after_s = between_s[:, 0] + width_s * inside
    knot_s = np.column_stack((after_s - BEFORE * width_s, after_s))
    level = np.interp(between_s, log.time_s, log.channels[log.input].values)
    return TimedLog(**fields_of(log), knots=(knot_s.ravel(), level.ravel()))
