"""Whether a stretch of a log begins at rest."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from softid.log import Log
from softid.segment import Segment

REST_WINDOW_S = 0.3
REST_MIN_SAMPLES = 5
REST_FRACTION = 0.02
"""A segment starts at rest when over its first 0.3 s (at least five samples) the input stays within
2 % of its span in that log, and the outputs within 2 % of theirs until the input first moves."""


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
        if moved > REST_FRACTION * spans[name]:
            return False
    return True


def spans_of(log: Log) -> dict[str, float]:
    """Largest minus smallest value of the input, under ``"input"``, and of every output."""
    spans = {"input": float(np.ptp(log.channels[log.input].values))}
    for name in log.outputs:
        values = log.channels[name].values
        finite = values[np.isfinite(values)]
        spans[name] = float(np.ptp(finite)) if finite.size else 0.0
    return spans
