"""What logs of other kinds have in common with the plain one that they were made of."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.log import Log
from softid.segment import Segment, with_rows

Array = npt.NDArray[np.float64]


def fields_of(log: Log) -> dict[str, Any]:
    """The fields that every kind of log has, to make a log of another kind with.

    Parameters
    ----------
    log
        A log of any kind.

    Examples
    --------
    >>> log = Log.from_arrays([0.0, 0.1], {"pressure": [0.0, 1.0], "angle": [0.0, 2.0]})
    >>> knots = (np.array([0.05]), np.array([1.0]))
    >>> KnottedLog(**fields_of(log), knots=knots).segments()[0].input.tolist()
    [0.0, 1.0, 1.0]
    """
    return {each.name: getattr(log, each.name) for each in fields(Log)}


@dataclass(frozen=True, eq=False)
class KnottedLog(Log):
    """A log whose input is known at moments between its samples, too.

    Attributes
    ----------
    knots
        These times, in order, and the input there, each of shape (m,).
    """

    knots: tuple[Array, Array] = field(kw_only=True)

    def _segment(self, index: int, start: int, stop: int) -> Segment:
        segment = super()._segment(index, start, stop)
        knot_s, level = self.knots
        first, last = np.searchsorted(knot_s, segment.time_s[[0, -1]])
        return with_rows(segment, knot_s[first:last], level[first:last])
