"""What an output does while the input is held: settles, is still on its way, or moves by itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.excitation import SettledWindow, median_of_five
from softid.log import Log
from softid.quality.second_inputs import OF_RANGE, other_inputs

Array = npt.NDArray[np.float64]

LEAST_SAMPLES = 10
"""Samples of a hold at least: two in each of the fifths that are compared."""

SETTLED_OF_WAY = 0.05
"""Drift between the last two fifths that still counts as settled, as a share of the way since the
hold before: an exponential passes from 3.4 of its time constants on."""

SETTLED_OF_RANGE = 0.005
"""Drift between the last two fifths that counts as settled beside `SETTLED_OF_WAY`, as a share of
the output's range: after a small way noise alone drifts."""

MOVES_OF_RANGE = 0.15
"""Share of the output's range that it travels in the second half of a hold to move by itself. A
judgement."""

WANDERS_OF_RANGE = 0.1
"""Share of the output's range that it travels in a whole hold to move by itself, where nothing
moved before and no motion of this log can be dying out. A judgement."""

MIN_SIGMAS = 10.0
"""Standard deviations of the noise that a travel exceeds to count: 10,000 samples of white noise,
in medians of five, span four."""

UNDIMINISHED = 0.7
"""Travel in the second half over that in the first from which it does not slow down. An exponential
reaches it in a hold of less than 0.7 of its time constant."""

STEADY_SPEED = 0.4
"""Drift between the last two fifths over the travel in the second half, from which the travel does
not slow down: a straight line has just this."""


@dataclass(frozen=True)
class Hold:
    """One range of time on which the input is held, and what the output does meanwhile.

    Attributes
    ----------
    start_s, stop_s
        Times of its first and last sample.
    level
        The input, in its unit.
    after_change
        Whether the input moved before it in this log.
    settled
        Whether the output has come to rest at its end; None with too few samples to tell.
    unexplained
        By how much the output moves in the second half without slowing down, in its unit; None
        where it does not.
    at_start
        By how much it moves before the input has moved at all, in its unit; None where it does
        not.
    moving
        Other channels of the input's unit that move meanwhile, where the output does so.
    """

    start_s: float
    stop_s: float
    level: float
    after_change: bool
    settled: bool | None
    unexplained: float | None
    at_start: float | None = None
    moving: tuple[str, ...] = ()

    @property
    def length_s(self) -> float:
        """Time from the first to the last sample."""
        return self.stop_s - self.start_s


def describe_holds(
    log: Log, output: str, windows: Sequence[SettledWindow], noise_std: float | None
) -> tuple[Hold, ...]:
    """Judge an output on every range on which the input is held.

    It has settled when its mean over the last fifth differs from that over the fifth before by no
    more than 5 % of its way since the last hold and 0.5 % of its range. It moves by itself
    when it still travels 15 % of its range in the second half of the hold and does not slow down,
    and at the start when it travels 10 % of it in a hold before which nothing moved.

    Parameters
    ----------
    log
        The recording.
    output
        Name of the output channel.
    windows
        Settled windows of the input, in order.
    noise_std
        Noise of the output, in its unit.
    """
    values = log.channels[output].values
    finite = values[np.isfinite(values)]
    span = float(np.ptp(finite)) if finite.size else 0.0
    quiet = MIN_SIGMAS * (noise_std or 0.0)
    found, before = [], None
    for window in windows:
        held = values[window.start : window.stop]
        held = median_of_five(held[np.isfinite(held)])
        moved = window.start > 0
        settled, unexplained, at_start = None, None, None
        if held.size >= LEAST_SAMPLES and span > 0.0:
            settled = _settled(held, before, span)
            unexplained = _unexplained(held, span, quiet)
            whole = float(np.ptp(held))
            if not moved and whole >= max(WANDERS_OF_RANGE * span, quiet):
                at_start = whole
            before = float(held[-(held.size // 5) :].mean())
        times = log.time_s[window.start], log.time_s[window.stop - 1]
        found.append(
            Hold(
                float(times[0]),
                float(times[1]),
                window.level,
                moved,
                settled,
                unexplained,
                at_start,
                () if unexplained is None else _moving(log, output, window),
            )
        )
    return tuple(found)


def _moving(log: Log, output: str, window: SettledWindow) -> tuple[str, ...]:
    least = OF_RANGE * float(np.ptp(log.channels[log.input].values))
    moving = []
    for name in other_inputs(log, output):
        held = log.channels[name].values[window.start : window.stop]
        held = median_of_five(held[np.isfinite(held)])
        if held.size and float(np.ptp(held)) >= least:
            moving.append(name)
    return tuple(moving)


def _last_drift(held: Array) -> float:
    """Mean of the last fifth less that of the fifth before."""
    fifth = held.size // 5
    return float(held[-fifth:].mean() - held[-2 * fifth : -fifth].mean())


def _settled(held: Array, before: float | None, span: float) -> bool:
    fifth = held.size // 5
    since = float(held[:fifth].mean()) if before is None else before
    way = abs(float(held[-fifth:].mean()) - since)
    return abs(_last_drift(held)) <= SETTLED_OF_WAY * way + SETTLED_OF_RANGE * span


def _unexplained(held: Array, span: float, quiet: float) -> float | None:
    first, second = (float(np.ptp(half)) for half in np.array_split(held, 2))
    if second < max(MOVES_OF_RANGE * span, quiet):
        return None
    undiminished = second >= UNDIMINISHED * first
    steady = abs(_last_drift(held)) >= STEADY_SPEED * second
    return second if undiminished or steady else None
