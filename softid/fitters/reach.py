"""How far an unknown may plausibly move, in sizes of the log: no unit makes a fit another one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.log import Log
from softid.parameters import Parameter
from softid.segment import Segment

Array = npt.NDArray[np.float64]

LOG_REACH = 2.0
"""Plausible move of a parameter on a logarithmic scale: a factor of e² = 7.4, a judgement."""

LINEAR_REACH = 3.0
"""Plausible move of a parameter on a linear scale, in units of its value, which counts as no less
than the span of a channel of its unit, or 1 where none has it."""

FREE_REACH = 1e3
"""Plausible move of zeros and initial states, in spans and largest speeds of the outputs: meant
never to count, since the data always pin them down."""

BOUNDED_REACH = 0.05
"""Share of the distance of its bounds that a value moves at most: a step that carries the place of
a kink across the range says nothing of what happens in between."""


def parameter_reach(rows: Sequence[Parameter], log: Log, segments: Sequence[Segment]) -> Array:
    """How far parameters may move, each on its own scale, shape (F,).

    Parameters
    ----------
    rows
        The parameters.
    log, segments
        A log that has the channels of all, and the segments of all.
    """
    spans = _spans_by_unit(log, segments)
    found = np.full(len(rows), LOG_REACH)
    for k, p in enumerate(rows):
        if p.scale != "log":
            far = LINEAR_REACH * max(abs(p.value), spans.get(p.unit, 1.0))
            found[k] = min(far, BOUNDED_REACH * (p.upper - p.lower))
    return found


def _spans_by_unit(log: Log, segments: Sequence[Segment]) -> dict[str, float]:
    """Unit → largest span of a channel that has it, without units whose channels stay still."""
    spans = {log.input: max(float(np.ptp(s.input)) for s in segments)}
    for name in log.outputs:
        spans[name] = max(motion_of(s, name)[0] for s in segments)
    found: dict[str, float] = {}
    for name, span in spans.items():
        unit = log.channels[name].unit
        if span > 0.0:
            found[unit] = max(span, found.get(unit, 0.0))
    return found


def motion_of(segment: Segment, output: str) -> tuple[float, float]:
    """Span and largest speed of an output, 0 where nothing moves.

    Parameters
    ----------
    segment
        A stretch of a log.
    output
        The output channel.
    """
    used = segment.used[output]
    time_s, y = segment.time_s[used], segment.outputs[output][used]
    if not y.size:
        return 0.0, 0.0
    speed = np.max(np.abs(np.diff(y) / np.diff(time_s)), initial=0.0)
    return float(np.ptp(y)), float(speed)


def sizes_of_states(span: float, speed: float, count: int) -> Array:
    """Sizes of a position, a velocity, and then positions that follow it, shape (count,).

    Parameters
    ----------
    span, speed
        Span and largest speed of the position.
    count
        Number of states.
    """
    return np.array((span, speed, *[span] * count))[:count]


def usual_motion(segments: Sequence[Segment], output: str) -> tuple[float, float]:
    """The largest span and speed of an output in any segment; 1 where nothing moves in any.

    A short one may hold still, or all but for rounding, and yet begin anywhere in the motion.

    Parameters
    ----------
    segments, output
        The segments and the output channel.
    """
    spans, speeds = zip(*(motion_of(segment, output) for segment in segments), strict=True)
    return max(spans) or 1.0, max(speeds) or 1.0
