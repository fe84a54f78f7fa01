"""Samples at which a sensor or its line failed: missing ones, sentinels, spikes, lost digits."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from softid.channels import read_only
from softid.kernels.excursions import measure_depths
from softid.quality.findings import Dropout, DropoutCause
from softid.quality.trace import MIN_DISTINCT, Runs, Trace, weighted_median

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

BULK = (0.005, 0.995)
"""Quantiles between which a channel's range lies, whatever spikes do beyond."""

USUAL_DEPTH = 0.95
"""Quantile of how far values lie off both neighbours that is usual: spikes are fewer than that."""

SPIKE_OVER_USUAL = 6.0
"""How many times further a spike lies off its neighbours than is usual; the furthest of 200,000
samples of white noise lies 2.8 times as far."""

SPIKE_OF_RANGE = 0.03
"""Share of the range that a spike lies off its neighbours at least: less spoils no fit."""

SPIKE_STEPS = 5.0
"""Steps of the grid that a spike lies off its neighbours at least: a value that hardly moves may
jump by a few."""

NEARBY_MOVES = 4
"""Moves on either side that say how fast a channel is moving: few enough that one motion makes all,
and enough that a second spike among them is none of their median."""

RETURNS_WITHIN = 0.3
"""Difference of the two neighbours of a spike, in its depth: what does not come back is a step."""

LONGEST_STEP_BACK = 4.0
"""Time to either neighbour, in sampling periods or holds: beyond a gap there is no neighbour."""

SHORT_SPIKE = 3
"""Samples, or holds, that a spike may last; a motion there and back takes longer."""

LONGEST_SENTINEL_S = 2.0
"""Time that an exact sentinel may last, as of a loose plug; a longer one may be where the channel
stands still."""

FEWEST_CODED, MOST_CODED = 5, 0.8
"""Sentinels of one value, and their share of the samples with that value, from which it is a code:
then it is no reading where the channel happens to be near it, either."""

GLITCH_OF_HOLD = 0.05
"""Longest glitch of a command as a share of its usual hold."""

GLITCH_SAMPLES = 4
"""Longest glitch of a command in samples: a level of a command is meant, and one that lasts longer
was sent."""

LEADING_DIGIT = 10.0
"""Least size of a value with a digit before its last whole one, which a line could lose."""

SHOWN_DIGITS = 9
"""Decimals to which values are compared as they were printed."""

DIGIT_TOLERANCE = 1e-4
"""What the other digits may have moved between two samples, in units of the digit that was lost."""


def find_dropouts(trace: Trace) -> tuple[Dropout, ...]:
    """Find samples at which the sensor or its line failed.

    These are NaN, and isolated excursions: a value that lies off both neighbours on the same
    side, by more than 6 times what 95 % of the samples do and than the channel moves nearby, by
    more than 3 % of the range and 5 quantisation steps, while the neighbours agree. It may last 3
    samples (or holds), longer only when it is an exact sentinel: 0, the extreme value, or one that
    returns elsewhere. Where a sentinel is a drop-out nearly every time, it is one every time. In a
    command they are changes of level for up to 4 samples.
    """
    missing = _missing(trace)
    runs = Runs.of(trace.values)
    if runs.start.size < MIN_DISTINCT:
        return tuple(missing)
    seen = _glitches(trace, runs) if trace.kind == "command" else _excursions(trace, runs)
    found = [*missing, *seen]
    unique = {d.start: d for d in reversed(found)}
    return tuple(unique[k] for k in sorted(unique))


def may_drop_out(values: Array) -> bool:
    """Whether `find_dropouts` can find anything in a channel that is measured, however it is read.

    It needs no more than the range and the moves, whatever the noise, the quantisation and the
    holds are, which take ten times as long to find.

    Parameters
    ----------
    values
        All samples of the log, shape (n,); may hold NaN.
    """
    if not np.isfinite(values).all():
        return True
    runs = Runs.of(values)
    if runs.start.size < MIN_DISTINCT:
        return False
    return _far_off(values, runs).size > 0


def _depth(runs: Runs) -> Array:
    """How far each inner run lies off both neighbours on the same side, shape (r − 2,)."""
    depth = np.empty(runs.value.size - 2)
    measure_depths(read_only(runs.value), depth)  # one type for the compiler, as in a log
    return depth


def _missing(trace: Trace) -> list[Dropout]:
    absent = ~np.isfinite(trace.values)
    if not absent.any():
        return []
    edges = np.flatnonzero(np.diff(np.concatenate([[False], absent, [False]])))
    return [
        _dropout(trace, int(a), int(b), None, "missing")
        for a, b in zip(edges[::2], edges[1::2], strict=True)
    ]


def _dropout(
    trace: Trace, start: int, stop: int, value: float | None, cause: DropoutCause
) -> Dropout:
    beside = [trace.values[k] for k in (start - 1, stop) if 0 <= k < trace.values.size]
    good = [float(v) for v in beside if math.isfinite(v)]
    until = trace.time_s[min(stop, trace.time_s.size - 1)]
    return Dropout(
        start,
        stop,
        float(trace.time_s[start]),
        float(until - trace.time_s[start]),
        value,
        sum(good) / len(good) if good else None,
        cause,
    )


def _excursions(trace: Trace, runs: Runs) -> list[Dropout]:
    far = _far_off(trace.values[np.isfinite(trace.values)], runs)
    if not far.size:
        return []
    limit_s = LONGEST_STEP_BACK * max(
        float(np.median(np.diff(trace.time_s))), trace.hold.hold_s if trace.hold else 0
    )
    first, last = runs.start[far], runs.stop[far]
    near = (trace.time_s[first] - trace.time_s[first - 1] <= limit_s) & (
        trace.time_s[last] - trace.time_s[last - 1] <= limit_s
    )
    candidates = far[near & (_depth(runs)[far - 1] > SPIKE_STEPS * trace.step)]
    found = []
    for k in candidates:
        cause = _cause(trace, runs, int(k), candidates)
        short = runs.length[k] <= SHORT_SPIKE * trace.repeats
        lasting_s = trace.time_s[runs.stop[k] - 1] - trace.time_s[runs.start[k]]
        told = cause == "sentinel" and (trace.noisy or trace.kind == "output")
        if short or (told and lasting_s <= LONGEST_SENTINEL_S):
            value = float(runs.value[k])
            found.append(_dropout(trace, int(runs.start[k]), int(runs.stop[k]), value, cause))
    return [*found, *_of_known_codes(trace, runs, found)]


def _of_known_codes(trace: Trace, runs: Runs, found: list[Dropout]) -> list[Dropout]:
    """Runs of a value that stands for a drop-out nearly wherever it occurs, found or not."""
    more = []
    sentinels = [d for d in found if d.cause == "sentinel" and d.value is not None]
    known = {d.start for d in found}
    for value in sorted({d.value for d in sentinels if d.value is not None}):
        lengths = [d.stop - d.start for d in sentinels if d.value == value]
        same = np.flatnonzero(runs.value == value)
        is_code = sum(lengths) >= MOST_CODED * runs.length[same].sum()
        if is_code and len(lengths) >= FEWEST_CODED:
            more += [
                _dropout(trace, int(runs.start[k]), int(runs.stop[k]), value, "sentinel")
                for k in same
                if int(runs.start[k]) not in known
            ]
    return more


def _far_off(values: Array, runs: Runs) -> IntArray:
    """Inner runs that lie further off neighbours which agree than is usual, here and everywhere.

    Those that lie near enough by the channel's bulk are left out before others are looked at, for
    hardly any is left then.
    """
    depth = _depth(runs)
    near_deepest = np.count_nonzero(depth >= depth.max() / SPIKE_OVER_USUAL)
    if near_deepest > (1.0 - USUAL_DEPTH) * depth.size + 1.0:
        return np.empty(0, np.intp)  # the quantile is no less than that, so nothing is deep
    low, high = np.quantile(values, BULK)
    usual = float(np.quantile(depth, USUAL_DEPTH))
    deep = depth > max(SPIKE_OVER_USUAL * usual, SPIKE_OF_RANGE * float(high - low))
    far = np.flatnonzero(deep) + 1
    depth, value = depth[far - 1], runs.value
    returns = np.abs(value[far + 1] - value[far - 1]) <= RETURNS_WITHIN * depth
    clear = depth > SPIKE_OVER_USUAL * _moves_nearby(value, far)
    return far[returns & clear]


def _moves_nearby(values: Array, at: IntArray) -> Array:
    """Median size of the moves near some of the runs, their own two left out, shape of ``at``."""
    moves = np.abs(np.diff(values))
    padded = np.pad(moves, NEARBY_MOVES, mode="reflect")
    around = np.delete(np.arange(2 * NEARBY_MOVES), [NEARBY_MOVES - 1, NEARBY_MOVES])
    nearby: Array = np.median(padded[at[:, None] + around], axis=1)
    return nearby


def _cause(trace: Trace, runs: Runs, k: int, candidates: IntArray) -> DropoutCause:
    value = float(runs.value[k])
    shown = round(value * trace.display_factor, SHOWN_DIGITS)
    neighbour = round(float(runs.value[k - 1]) * trace.display_factor, SHOWN_DIGITS)
    if _lost_first_digit(neighbour, shown):
        return "lost digit"
    extreme = value in (np.nanmin(trace.values), np.nanmax(trace.values))
    again = int(np.sum(runs.value[candidates] == value)) > 1
    if shown == 0.0 or again or (extreme and runs.length[k] > 1):
        return "sentinel"
    return "spike"


def _lost_first_digit(before: float, value: float) -> bool:
    """Whether a value is its neighbour without the leading digit: 31.37 → 1.37, −152.5 → −52.5."""
    if abs(before) < LEADING_DIGIT or before * value < 0.0:
        return False
    power = 10.0 ** math.floor(math.log10(abs(before)))
    return math.isclose(abs(value), math.fmod(abs(before), power), abs_tol=DIGIT_TOLERANCE * power)


def _glitches(trace: Trace, runs: Runs) -> list[Dropout]:
    """Samples of another level in a channel that otherwise holds its levels, as commands do."""
    lengths = runs.length
    usual = weighted_median(lengths)
    short = lengths[1:-1] <= min(GLITCH_SAMPLES, GLITCH_OF_HOLD * usual)
    same = runs.value[:-2] == runs.value[2:]
    found = np.flatnonzero(short & same) + 1
    kept: list[int] = []
    for k in found:
        if not kept or k > kept[-1] + 1:
            kept.append(int(k))
    return [
        _dropout(trace, int(runs.start[k]), int(runs.stop[k]), float(runs.value[k]), "spike")
        for k in kept
    ]
