"""How channels go together: sign, lag of the pressure behind its command, step responses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from softid.excitation import SettledWindow, median_of_five
from softid.log import Log
from softid.quality.findings import CommandLag, Frozen, SignCheck, StepResponse
from softid.quality.holding import Hold
from softid.quality.lagged_correlation import common_grid, lagged_correlations, longest_lag_s

Array = npt.NDArray[np.float64]

FALLS_WITH_PRESSURE = ("distance", "length")
"""Outputs that an actuator makes smaller as its pressure rises, as softid defines them."""

CLEARLY_INVERTED = -0.6
"""Correlation, in the expected sense, up to which a sign is called inverted: over a third of the
variance goes the wrong way. A judgement."""

MIN_LAG_CORRELATION = 0.5
"""Correlation below which a measured pressure does not follow its command, so that a lag between
them means nothing; a judgement."""

LEAST_STEP = 0.15
"""Change of the input between two holds, as a share of its range, from which it is timed. A
judgement."""

RESPONDED = 0.632
"""Share of the way that is timed, 1 − 1/e: a lag of first order makes it in one time constant."""

LARGEST_DRIFT = 0.03
"""Drift between the last two fifths, as a share of the step, above which a response has no
overshoot: its end is not known yet."""

NOISE_OF_MEDIAN = 2.0
"""Standard deviations of the noise that a median of five may lie above its mean: one in 9000 does,
so that the largest of a response hardly ever passes for an overshoot."""

MIN_RESPONSE_SIGMAS = 6.0
"""Least way of an output that is timed, in standard deviations of its noise: the threshold at 63 %
then lies 3.8 of them above where the way begins, and must be passed by two samples."""


def check_sign(log: Log, output: str) -> SignCheck | None:
    """Correlate an output with the input at the best lag up to a quarter of the main period.

    Parameters
    ----------
    log
        The recording.
    output
        Name of the output channel.

    Returns
    -------
    SignCheck or None
        None when input or output does not move.
    """
    grid = common_grid(log, log.input, output)
    if grid is None:
        return None
    step_s, given, answered = grid
    lags = max(int(longest_lag_s(step_s, given) / step_s), 1)
    correlations = lagged_correlations(given, answered, lags)
    best = int(np.abs(correlations).argmax())
    correlation = float(correlations[best])
    sign = -1.0 if output in FALLS_WITH_PRESSURE else 1.0
    if log.channels[output].unit == "1":
        sign = 0.0  # raw counts may fall as the quantity rises
    return SignCheck(output, correlation, best * step_s, sign * correlation <= CLEARLY_INVERTED)


def command_lag(log: Log) -> CommandLag | None:
    """Roughly by how much the measured pressure lags behind the commanded one.

    The lag of the largest cross-correlation, refined by a parabola. It mixes delay and rise time.

    Returns
    -------
    CommandLag or None
        None without both channels, without motion, or when they are not alike.
    """
    if not {"pressure_command", "pressure"} <= set(log.channels):
        return None
    grid = common_grid(log, "pressure_command", "pressure")
    if grid is None:
        return None
    step_s, given, answered = grid
    lags = max(int(longest_lag_s(step_s, given) / step_s), 2)
    correlations = lagged_correlations(given, answered, lags)
    best = int(correlations.argmax())
    if correlations[best] < MIN_LAG_CORRELATION:
        return None
    shift = 0.0
    if 0 < best < correlations.size - 1:
        left, top, right = correlations[best - 1 : best + 2]
        bend = left - 2.0 * top + right
        shift = 0.5 * float((left - right) / bend) if bend < 0.0 else 0.0
    return CommandLag((best + shift) * step_s, float(correlations[best]))


def step_response(
    log: Log,
    output: str,
    windows: Sequence[SettledWindow],
    noise: Mapping[str, float | None],
    *,
    holds: Sequence[Hold] = (),
    stuck: Sequence[Frozen] = (),
) -> StepResponse | None:
    """Time how input and output pass from one settled window of the input to the next.

    Parameters
    ----------
    log
        The recording.
    output
        Name of the output channel.
    windows
        Settled windows of the input, in order.
    noise
        Channel → standard deviation of its noise, in its unit.
    holds
        What the output does on each of the windows; none says that it settles.
    stuck
        Where the input repeats a stale value; a change right after it is not timed.
    """
    given, answered = log.channels[log.input].values, log.channels[output].values
    span = float(np.ptp(given))
    given_noise, answered_noise = (noise.get(name) or 0.0 for name in (log.input, output))
    timed = []
    settled = [h.settled is not False for h in holds] or [True] * len(windows)
    for (before, after), (rested, rests) in zip(pairwise(windows), pairwise(settled), strict=True):
        if any(_until(before, f) for f in stuck):
            continue
        if abs(after.level - before.level) < LEAST_STEP * span:
            continue
        part = slice(before.stop - 1, after.stop)
        ends = _rest_values(answered, before), _rest_values(answered, after)
        if ends[0] is None or ends[1] is None:
            continue
        if abs(ends[1] - ends[0]) <= MIN_RESPONSE_SIGMAS * answered_noise:
            continue
        times = log.time_s[part] - log.time_s[part.start]
        if float(np.diff(times).max()) > log.stall_s:
            continue
        input_s = _crossing_s(times, given[part], before.level, after.level)
        output_s = _crossing_s(times, answered[part], ends[0], ends[1])
        if input_s is None or output_s is None:
            continue
        overshoots = (
            _overshoot(given[part], before.level, after.level, given_noise),
            _overshoot(answered[part], ends[0], ends[1], answered_noise),
        )
        timed.append((input_s, output_s, *overshoots, float(rested and rests)))
    if not timed:
        return None
    table = np.array(timed)
    input_over, output_over = (c[np.isfinite(c)] for c in (table[:, 2], table[:, 3]))
    return StepResponse(
        output,
        len(timed),
        float(np.median(table[:, 0])),
        float(np.median(table[:, 1])),
        float(np.mean(table[:, 4])),
        float(np.median(input_over)) if input_over.size else None,
        float(np.median(output_over)) if output_over.size else None,
    )


def _until(window: SettledWindow, frozen: Frozen) -> bool:
    """Whether a stuck stretch reaches into the last fifth of a window."""
    last_fifth = window.stop - (window.stop - window.start) // 5
    return frozen.start < window.stop and frozen.stop > last_fifth


def _rest_values(values: Array, window: SettledWindow) -> float | None:
    """Mean over the last fifth of a window."""
    tail = values[window.stop - max((window.stop - window.start) // 5, 2) : window.stop]
    tail = tail[np.isfinite(tail)]
    return float(tail.mean()) if tail.size else None


def _overshoot(values: Array, start: float, stop: float, noise_std: float) -> float:
    """By how much a response passes its end, beyond the noise; NaN when it has not settled."""
    way = (values[np.isfinite(values)] - start) / (stop - start)
    fifth = max(way.size // 5, 1)
    if abs(float(way[-fifth:].mean() - way[-2 * fifth : -fifth].mean())) > LARGEST_DRIFT:
        return float("nan")
    noise = NOISE_OF_MEDIAN * noise_std / abs(stop - start)
    return max(float(median_of_five(way).max()) - 1.0 - noise, 0.0)


def _crossing_s(times: Array, values: Array, start: float, stop: float) -> float | None:
    """First time at which 63 % of the way is made and stays made for the next sample."""
    way = (values - start) / (stop - start) >= RESPONDED
    made = np.flatnonzero(way[:-1] & way[1:])
    return float(times[made[0]]) if made.size else None
