"""A stretch of one log without a stall, as fits and simulations see it."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.intersample import Intersample, knots

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

APART = 1e-3
"""Share of an interval within which a knot is where a row is."""


@dataclass(frozen=True, eq=False)
class Segment:
    """A stretch of one log without a stall, with the roles resolved to arrays.

    Attributes
    ----------
    log_name
        The log that it is part of.
    index
        Position among the segments of that log.
    start, stop
        Half-open range of the log's samples.
    time_s
        Sample times, shape (n,).
    input
        The input channel's samples in its unit, shape (n,).
    outputs
        Output channel name → samples, each of shape (n,).
    used
        Output channel name → which samples count in the residual, each of shape (n,).
    log_start_s
        Time of the log's first sample.
    is_sample
        Which rows are samples, shape (n,), where others are knots of a held input; else None.
    input_read_s
        As in `Log`, within this stretch.
    """

    log_name: str
    index: int
    start: int
    stop: int
    time_s: Array
    input: Array
    outputs: Mapping[str, Array]
    used: Mapping[str, BoolArray]
    log_start_s: float = 0.0
    is_sample: BoolArray | None = None
    input_read_s: Array | None = None

    @cached_property
    def kept(self) -> dict[str, tuple[Hashable, Any]]:
        """What was made of the stretch last, by kind, for whoever asks for it again.

        It is no part of the stretch: copies of the process need not have asked for the same.
        """
        return {}

    @property
    def since_s(self) -> Array:
        """Times since the log's first sample, shape (n,)."""
        return self.time_s - self.log_start_s

    @property
    def readings(self) -> tuple[Array, Array]:
        """Times at which the input was read, and what it was then, each of shape (R,)."""
        if self.input_read_s is None:
            return self.samples_of(self.time_s), self.samples_of(self.input)
        return self.input_read_s, np.interp(self.input_read_s, self.time_s, self.input)

    def samples_of(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Those of rows, the first axis of an array, that are samples."""
        return values if self.is_sample is None else values[self.is_sample]

    def part(self, kept: slice) -> Segment:
        """A run of rows as a segment of its own; ``start`` and ``stop`` stay those of the whole."""
        return replace(
            self,
            time_s=self.time_s[kept],
            input=self.input[kept],
            outputs={name: y[kept] for name, y in self.outputs.items()},
            used={name: used[kept] for name, used in self.used.items()},
            is_sample=None if self.is_sample is None else self.is_sample[kept],
        )

    def without_knots(self) -> Segment:
        """The samples alone, between which the input is straight."""
        if self.is_sample is None:
            return self
        return replace(
            self,
            time_s=self.samples_of(self.time_s),
            input=self.samples_of(self.input),
            outputs={name: self.samples_of(y) for name, y in self.outputs.items()},
            used={name: self.samples_of(used) for name, used in self.used.items()},
            is_sample=None,
        )


def with_knots(segment: Segment, intersample: Intersample) -> Segment:
    """The segment with a row before each change of a held input, which no output was recorded at.

    Parameters
    ----------
    segment
        Samples alone.
    intersample
        What the input does between them.
    """
    return with_rows(segment, *knots(segment.time_s, segment.input, intersample))


def with_rows(segment: Segment, knot_s: Array, level: Array) -> Segment:
    """The segment with more rows, which no output was recorded at.

    Parameters
    ----------
    segment
        A stretch; none of its rows is at the time of a new one.
    knot_s, level
        Times and input of the rows, in order of time, each of shape (m,).
    """
    if knot_s.size == 0:
        return segment
    places = np.searchsorted(segment.time_s, knot_s) + np.arange(knot_s.size)
    is_old = np.ones(segment.time_s.size + knot_s.size, bool)
    is_old[places] = False

    def inserted(old: npt.NDArray[Any], new: npt.ArrayLike) -> npt.NDArray[Any]:
        whole = np.empty(is_old.size, old.dtype)
        whole[is_old], whole[places] = old, new
        return whole

    return replace(
        segment,
        time_s=inserted(segment.time_s, knot_s),
        input=inserted(segment.input, level),
        outputs={name: inserted(y, np.nan) for name, y in segment.outputs.items()},
        used={name: inserted(used, False) for name, used in segment.used.items()},
        is_sample=is_old if segment.is_sample is None else inserted(segment.is_sample, False),
    )


def absent_times(time_s: Array, knot_s: Array, apart_s: Array | float) -> Array:
    """Those of some times that are at no row, in order and each once.

    Parameters
    ----------
    time_s
        Times of the rows, shape (n,).
    knot_s
        The times, of any shape.
    apart_s
        Up to where a time is that of a row.
    """
    after = np.searchsorted(time_s, knot_s)
    beside_s = time_s[np.clip((after - 1, after), 0, time_s.size - 1)]
    return np.unique(knot_s[np.abs(beside_s - knot_s).min(axis=0) > apart_s])


def with_added(segment: Segment, knot_s: Array, added: Array) -> Segment:
    """The segment with an input to which something is added that goes straight between knots.

    Parameters
    ----------
    segment
        A stretch; rows are put in where a knot is at none.
    knot_s, added
        Times and what is added at them, each of shape (J, K), for J intervals one after the other
        at both ends of which nothing is added.
    """
    new_s = absent_times(segment.time_s, knot_s, APART * (knot_s[:, -1:] - knot_s[:, :1]))
    finer = with_rows(segment, new_s, np.interp(new_s, segment.time_s, segment.input))
    more = np.interp(finer.time_s, knot_s.ravel(), added.ravel()) if added.size else 0.0
    return replace(finer, input=finer.input + more)
