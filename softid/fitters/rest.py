"""Whether a stretch of a log begins at rest."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from softid.excitation import SECOND_DIFFERENCE
from softid.log import Log
from softid.segment import Segment

REST_WINDOW_S = 0.3
"""Time from the start of a segment over which the input must hold still, and at both ends of a rest
over which the outputs are averaged; a judgement."""

REST_MIN_SAMPLES = 5
"""Fewest samples over which a segment is looked at for rest, where the sampling is so slow that 0.3
s hold fewer."""

REST_FRACTION = 0.02
"""Share of its span in the log within which the input stays at rest, and the outputs until the
input first moves, or within less where noise lets less be seen."""

LEAST_FRACTION, SURE_ERRORS = 0.005, 4.0
"""Least share of its span in the log that an output may move at rest, since slow noise moves, too,
and how many standard errors of what it moved count otherwise, up to `REST_FRACTION`."""


def starts_at_rest(segment: Segment, spans: Mapping[str, float]) -> bool:
    """Whether input and outputs hold still from the start of a segment to the first input change.

    Parameters
    ----------
    segment
        The segment.
    spans
        ``"input"`` and output name → largest minus smallest value over the whole log.
    """
    n = int(np.searchsorted(segment.time_s, segment.time_s[0] + REST_WINDOW_S))
    n = max(n, REST_MIN_SAMPLES)
    if np.ptp(segment.input[:n]) > REST_FRACTION * spans["input"]:
        return False
    level = float(np.median(segment.input[:n]))
    moving = np.abs(segment.input - level) > REST_FRACTION * spans["input"]
    end = int(np.argmax(moving)) if moving.any() else segment.input.size
    for name, values in segment.outputs.items():
        still = values[: max(end, n)][segment.used[name][: max(end, n)]]
        if still.size < REST_MIN_SAMPLES:
            return False
        few = min(n, still.size // 2)
        moved = abs(float(still[-few:].mean() - still[:few].mean()))
        seen = SURE_ERRORS * _noise(still) * float(np.sqrt(2.0 / few))
        if moved > np.clip(seen, LEAST_FRACTION * spans[name], REST_FRACTION * spans[name]):
            return False
        if _swing(still) > REST_FRACTION * spans[name]:
            return False
    return True


def _swing(still: npt.NDArray[np.float64]) -> float:
    """Standard deviation of what is surely no noise, for what swings ends where it began."""
    most_noise = _noise(still) ** 2 * (1.0 + SURE_ERRORS * (2.0 / still.size) ** 0.5)
    return float(np.sqrt(max(np.var(still) - most_noise, 0.0)))


def _noise(values: npt.NDArray[np.float64]) -> float:
    """Standard deviation of the fast part, from second differences; spikes make it larger.

    A mean of squares, for a median of few or coarse readings says little.
    """
    return float(np.sqrt(np.mean(np.diff(values, 2) ** 2) / SECOND_DIFFERENCE))


def spans_of(log: Log) -> dict[str, float]:
    """Largest minus smallest value of the input, under ``"input"``, and of every output."""
    spans = {"input": float(np.ptp(log.channels[log.input].values))}
    for name in log.outputs:
        values = log.channels[name].values
        there = np.isfinite(values)
        finite = values if there.all() else values[there]
        spans[name] = float(np.ptp(finite)) if finite.size else 0.0
    return spans
