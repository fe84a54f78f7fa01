"""Marks of what no law of motion brings: a line in the spectrum, short events and slow wander.

All are looked for in what the last model leaves, and told beside the verdict: a pump, a supply
that swings or a cable that is touched are no effects of an actuator.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.diagnosis.residual.noise_floor import LOOK_S, input_span, still_spans
from softid.diagnosis.residual.slow_noise import CODE, slow_noise_issues
from softid.diagnosis.residual.spectral_line import Line
from softid.diagnosis.residual.structure import ResidualContext
from softid.errors import Issue
from softid.even_times import even_interval_s

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

QUIET_TIMES = 5.0
"""An event does not follow from a move of the input in so many of the last time constants."""

QUIET_MOVE = 0.02
"""Least move of the input from which an event may follow, as a share of the input's range."""

LOOKED_AT = 0.2
"""Share of the time that the input must have rested over which it is looked at for a move, so that
little of a rest is lost."""

FEWEST_LOOKED_AT = 10
"""Fewest samples over which the input is looked at for a move: their median errs by a third of the
gauge's noise."""

WINDOW_SAMPLES = 5
"""Samples of a window in which an event is looked for: a few, for a bump or a spike is short."""

LOUD_WINDOW = 16.0
"""Windows count as events when their power is so many times the median one."""

MOST_EVENTS = 0.05
"""Largest share of the windows that are events: where more are so loud, that is how the rest is."""

EVENTS_SHARE = 0.2
"""Least share of the rest's power at rest that all events hold together."""

STEADY = (
    "a steady line",
    "look for a pump, a fan, the mains or a supply that swings",
)
SWINGS = (
    "swings that begin again and again,",
    "see whether they begin with the moves: then a load or a mount swings, else look for a pump or "
    "a supply that does",
)
"""What a line is called, and what to look for, if it keeps its phase and if it does not."""

MOST_TOLD = 3
"""Moments that are told; of more their number is."""

SPECTRAL_LINE, SHORT_EVENTS = "spectral-line", "short-events"
"""Codes of the remarks on a line and on events."""

CODES = (SPECTRAL_LINE, SHORT_EVENTS, CODE)
"""Codes of the remarks on a line, on events and on a slow wander."""


def events_in(parts: Sequence[ResidualContext], motion_s: float) -> tuple[float, ...]:
    """Times of short and large deviations while the input rests.

    One that is there when a rest begins is what the motion before it left.

    Parameters
    ----------
    parts
        Residuals with their input.
    motion_s
        Time constant of the motion.

    Returns
    -------
    tuple of float
        In order, each the begin of a run of loud windows; empty where there are none.
    """
    times, follows, power = [], [], []
    span = max(input_span(parts), float(np.finfo(float).tiny))
    for part in parts:
        quiet = _at_rest(part, QUIET_TIMES * motion_s, QUIET_MOVE * span)
        used = quiet & np.isfinite(part.residual)
        count = used.size // WINDOW_SAMPLES
        whole = used[: count * WINDOW_SAMPLES].reshape(count, WINDOW_SAMPLES).all(axis=1)
        squares = part.residual[: count * WINDOW_SAMPLES].reshape(count, WINDOW_SAMPLES) ** 2
        times.append(part.time_s[: count * WINDOW_SAMPLES : WINDOW_SAMPLES][whole])
        power.append(squares.mean(axis=1)[whole])
        follows.append(np.diff(np.flatnonzero(whole), prepend=-1) == 1)
    joined = np.concatenate(power)
    if joined.size < WINDOW_SAMPLES / MOST_EVENTS:
        return ()
    limit = LOUD_WINDOW * float(np.median(joined))
    loud = [_begun_within(p > limit, f) for p, f in zip(power, follows, strict=True)]
    marked = np.concatenate(loud)
    few = 0 < int(marked.sum()) <= MOST_EVENTS * marked.size
    if not few or float(joined[marked].sum()) < EVENTS_SHARE * float(joined.sum()):
        return ()
    found = []
    for t, is_loud in zip(times, loud, strict=True):
        begins = is_loud & ~np.concatenate(([False], is_loud[:-1]))
        found += t[begins].tolist()
    return tuple(found)


def disturbance_issues(
    parts: Sequence[ResidualContext],
    motion_s: float,
    line: Line | None,
    *,
    channel: str,
    unit: str,
    factor: float,
) -> tuple[Issue, ...]:
    """The marks as remarks for the user.

    Parameters
    ----------
    parts, motion_s
        As in `events_in`.
    line
        From `line_in`.
    channel, unit, factor
        Name of the output, the unit in which people know it, and the factor to that unit.
    """
    found = []
    if line is not None:
        what, remedy = STEADY if line.in_step else SWINGS
        found.append(
            Issue(
                SPECTRAL_LINE,
                "warning",
                f"what is left of {channel} holds {what} at {line.frequency_hz:.3g} Hz, "
                f"{factor * line.amplitude:.3g} {unit} high, which the input does not have",
                remedy,
            )
        )
    events = events_in(parts, motion_s)
    if events:
        told = ", ".join(f"{t:.4g}" for t in events[:MOST_TOLD])
        count = "1 short event" if len(events) == 1 else f"{len(events)} short events"
        more = f" and {len(events) - MOST_TOLD} more" if len(events) > MOST_TOLD else ""
        found.append(
            Issue(
                SHORT_EVENTS,
                "warning",
                f"what is left of {channel} holds {count} while the input rests, at {told} s{more}",
                "look at these times: a touched cable, a slipped mount or lost samples",
            )
        )
    slow = slow_noise_issues(parts, motion_s, channel=channel, unit=unit, factor=factor)
    return (*found, *slow)


def _begun_within(loud: BoolArray, follows: BoolArray) -> BoolArray:
    """Loud windows without those that have been so since the first window of their rest."""
    kept = loud.copy()
    carried = False
    for k in range(loud.size):
        carried = loud[k] and (carried or not follows[k])
        kept[k] = loud[k] and not carried
    return kept


def _at_rest(part: ResidualContext, since_s: float, least: float) -> BoolArray:
    """Samples before which the input has not moved by more than ``least`` for a while."""
    least_s = FEWEST_LOOKED_AT * even_interval_s(part.time_s)
    look_s = max(min(LOOK_S, LOOKED_AT * since_s), least_s)
    still = np.zeros(part.time_s.size, np.bool_)
    for span in still_spans(part.u, part.time_s, least, look_s=look_s):
        still[span] = part.time_s[span] - part.time_s[span.start] >= since_s
    return still
