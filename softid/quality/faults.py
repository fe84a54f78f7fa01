"""Sensor faults: drop-outs, frozen stretches and saturation of one channel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.excitation import Quantisation, SampleHold
from softid.quality.findings import Dropout, DropoutCause, Frozen, Saturation

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
BoolArray = npt.NDArray[np.bool_]

SPIKE_OVER_USUAL = 6.0
SPIKE_OF_RANGE = 0.03
SPIKE_STEPS = 5.0
NEARBY = 4
RETURNS_WITHIN = 0.3
SHORT_SPIKE = 3
LONGEST_SENTINEL_S = 2.0
GLITCH_OF_HOLD = 0.05
GLITCH_SAMPLES = 4
FROZEN_SAMPLES = 30
FROZEN_S = 1.0
FROZEN_OVER_USUAL = 20.0
FROZEN_INPUT_MOVE = 0.15
REVERSALS = 0.5
ROUNDING = 1e-9
NOISE_STEPS = 0.6
FLAT_SAMPLES = 5
FLAT_OVER_USUAL = 10.0
ARRIVING = 6
ARRIVAL_SPEED = 0.7
MIN_DISTINCT = 8


@dataclass(frozen=True, eq=False)
class Trace:
    """A channel with what is known about its sampling.

    Attributes
    ----------
    time_s, values
        All samples of the log, shape (n,); values in the display unit may hold NaN.
    quantisation, hold, noise_std
        As found for the channel.
    display_factor
        Factor from ``values`` to the numbers in the file.
    kind
        ``"command"`` (set, not measured), ``"input"`` (what drives) or ``"output"``.
    """

    time_s: Array
    values: Array
    quantisation: Quantisation | None
    hold: SampleHold | None
    noise_std: float | None
    display_factor: float = 1.0
    kind: Literal["command", "input", "output"] = "output"

    @property
    def step(self) -> float:
        """Quantisation step, 0 when there is none."""
        return self.quantisation.step if self.quantisation else 0.0

    @property
    def repeats(self) -> float:
        """Mean number of samples for which the sensor repeats a value."""
        return self.hold.factor if self.hold else 1.0

    @cached_property
    def noisy(self) -> bool:
        """Whether noise moves the channel from sample to sample even at rest.

        Noise shows in slopes that rise and fall in turn more often than not.
        """
        sigma = self.noise_std or 0.0
        if sigma == 0.0 or sigma < NOISE_STEPS * self.step:
            return False
        runs = Runs.of(self.values)
        slopes = np.diff(runs.value) / np.diff(self.time_s[runs.start])
        bends = np.diff(slopes)
        bends = bends[np.abs(bends) > ROUNDING * float(np.ptp(slopes))]
        return bends.size > 1 and float(np.mean((bends[1:] > 0) != (bends[:-1] > 0))) >= REVERSALS


@dataclass(frozen=True, eq=False)
class Runs:
    """Runs of equal finite values.

    Attributes
    ----------
    start, stop
        Half-open ranges of samples, each of shape (r,).
    value
        Their values, shape (r,).
    """

    start: IntArray
    stop: IntArray
    value: Array

    @property
    def length(self) -> IntArray:
        """Number of samples, shape (r,)."""
        lengths: IntArray = self.stop - self.start
        return lengths

    @classmethod
    def of(cls, values: Array) -> Runs:
        """Cut samples, some of which may be NaN, into runs."""
        finite = np.isfinite(values)
        changed = np.ones(values.size, bool)
        changed[1:] = (values[1:] != values[:-1]) | (finite[1:] != finite[:-1])
        start = np.flatnonzero(changed)
        stop = np.append(start[1:], values.size)
        kept = finite[start]
        return cls(start[kept], stop[kept], values[start[kept]])


def find_dropouts(trace: Trace) -> tuple[Dropout, ...]:
    """Find samples at which the sensor or its line failed.

    These are NaN, and isolated excursions: a value that lies off both neighbours on the same
    side, by more than 6 times what 95 % of the samples do and than the channel moves nearby, by
    more than 3 % of the range and 5 quantisation steps, while the neighbours agree. It may last 3
    samples (or holds), longer only when it is an exact sentinel: 0, the extreme value, or one that
    returns elsewhere. In a command they are changes of level for up to 4 samples.
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

    It needs no more than the range and the excursions, whatever the noise, the quantisation and the
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
    low, high = np.quantile(values, (0.005, 0.995))
    return bool(_depth(runs).max() > SPIKE_OF_RANGE * float(high - low))


def may_be_stuck(values: Array) -> bool:
    """Whether `find_saturation` or `find_frozen` can find anything, as `may_drop_out` says."""
    runs = Runs.of(values)
    return runs.start.size >= MIN_DISTINCT and int(runs.length.max()) >= FLAT_SAMPLES


def _depth(runs: Runs) -> Array:
    """How far each inner run lies off both neighbours on the same side, shape (r − 2,)."""
    before = runs.value[1:-1] - runs.value[:-2]
    after = runs.value[1:-1] - runs.value[2:]
    depth: Array = np.where(before * after > 0, np.minimum(np.abs(before), np.abs(after)), 0.0)
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
    before = runs.value[1:-1] - runs.value[:-2]
    after = runs.value[1:-1] - runs.value[2:]
    depth = _depth(runs)
    low, high = np.quantile(trace.values[np.isfinite(trace.values)], (0.005, 0.995))
    threshold = max(
        SPIKE_OVER_USUAL * float(np.quantile(depth, 0.95)),
        SPIKE_OF_RANGE * float(high - low),
        SPIKE_STEPS * trace.step,
    )
    nearby = _moves_nearby(runs.value)
    returns = np.abs(before - after) <= RETURNS_WITHIN * depth
    limit_s = 4.0 * max(
        float(np.median(np.diff(trace.time_s))), trace.hold.hold_s if trace.hold else 0
    )
    near = (trace.time_s[runs.start[1:-1]] - trace.time_s[runs.start[1:-1] - 1] <= limit_s) & (
        trace.time_s[runs.stop[1:-1]] - trace.time_s[runs.stop[1:-1] - 1] <= limit_s
    )
    deep = (depth > threshold) & (depth > SPIKE_OVER_USUAL * nearby)
    candidates = np.flatnonzero(deep & returns & near) + 1
    found = []
    for k in candidates:
        cause = _cause(trace, runs, int(k), candidates)
        short = runs.length[k] <= SHORT_SPIKE * trace.repeats
        lasting_s = trace.time_s[runs.stop[k] - 1] - trace.time_s[runs.start[k]]
        told = cause == "sentinel" and (trace.noisy or trace.kind == "output")
        if short or (told and lasting_s <= LONGEST_SENTINEL_S):
            value = float(runs.value[k])
            found.append(_dropout(trace, int(runs.start[k]), int(runs.stop[k]), value, cause))
    return found


def _moves_nearby(values: Array) -> Array:
    """Median size of the moves near each inner run, its own two left out, shape (r − 2,)."""
    moves = np.abs(np.diff(values))
    padded = np.pad(moves, NEARBY, mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * NEARBY)[1:-1]
    others = np.delete(windows, [NEARBY - 1, NEARBY], axis=1)
    nearby: Array = np.median(others, axis=1)
    return nearby


def _cause(trace: Trace, runs: Runs, k: int, candidates: IntArray) -> DropoutCause:
    value = float(runs.value[k])
    shown = round(value * trace.display_factor, 9)
    neighbour = round(float(runs.value[k - 1]) * trace.display_factor, 9)
    if _lost_first_digit(neighbour, shown):
        return "lost digit"
    extreme = value in (np.nanmin(trace.values), np.nanmax(trace.values))
    again = int(np.sum(runs.value[candidates] == value)) > 1
    if shown == 0.0 or again or (extreme and runs.length[k] > 1):
        return "sentinel"
    return "spike"


def _lost_first_digit(before: float, value: float) -> bool:
    """Whether a value is its neighbour without the leading digit: 31.37 → 1.37, −152.5 → −52.5."""
    if abs(before) < 10.0 or before * value < 0.0:
        return False
    power = 10.0 ** math.floor(math.log10(abs(before)))
    return math.isclose(abs(value), math.fmod(abs(before), power), abs_tol=1e-3 * power / 10.0)


def _glitches(trace: Trace, runs: Runs) -> list[Dropout]:
    """Samples of another level in a channel that otherwise holds its levels, as commands do."""
    lengths = runs.length
    usual = _weighted_median(lengths)
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


def find_frozen(trace: Trace, input_values: Array | None) -> tuple[Frozen, ...]:
    """Find stretches on which a channel that is alive elsewhere repeats one value exactly.

    Parameters
    ----------
    trace
        The channel.
    input_values
        What drives it, shape (n,); None for the input itself and for commands.
    """
    runs = Runs.of(trace.values)
    if runs.start.size < MIN_DISTINCT:
        return ()
    held_s = trace.time_s[runs.stop - 1] - trace.time_s[runs.start]
    found = []
    usual = _weighted_median(runs.length[runs.length < FROZEN_SAMPLES * trace.repeats])
    least = max(FROZEN_SAMPLES * trace.repeats, FROZEN_OVER_USUAL * usual)
    extremes = (float(runs.value.min()), float(runs.value.max()))
    for k in np.flatnonzero((runs.length >= FROZEN_SAMPLES) & (held_s >= FROZEN_S)):
        span = slice(int(runs.start[k]), int(runs.stop[k]))
        value = float(runs.value[k])
        reason: Literal["noise vanishes", "input moves"]
        if trace.noisy and runs.length[k] >= least and value not in extremes:
            reason = "noise vanishes"
        elif input_values is not None and value not in extremes and _moves(input_values, span):
            reason = "input moves"
        else:
            continue
        found.append(
            Frozen(
                span.start,
                span.stop,
                float(trace.time_s[span.start]),
                float(held_s[k]),
                value,
                reason,
            )
        )
    return tuple(found)


def _moves(input_values: Array, span: slice) -> bool:
    """Whether the input spends most of a range far from where it was at its start."""
    travel = np.abs(input_values[span] - input_values[span.start])
    return float(np.median(travel)) >= FROZEN_INPUT_MOVE * float(np.ptp(input_values))


def find_saturation(trace: Trace) -> tuple[Saturation, ...]:
    """Find flat tops and bottoms at an exact extreme value.

    Noise cannot repeat an extreme value many times in a row. An output without visible noise is
    saturated when it runs into the extreme at full speed and stops there at once; an input may do
    that on purpose.

    Parameters
    ----------
    trace
        The channel.
    """
    runs = Runs.of(trace.values)
    if runs.start.size < MIN_DISTINCT:
        return ()
    found = []
    for side, value in (("low", runs.value.min()), ("high", runs.value.max())):
        flat = np.flatnonzero(runs.value == value)
        long = flat[runs.length[flat] >= FLAT_SAMPLES * trace.repeats]
        usual = _weighted_median(runs.length[runs.value != value])
        caught = long[runs.length[long] >= FLAT_OVER_USUAL * usual]
        if not trace.noisy:
            stops = [
                k for k in caught if trace.kind == "output" and _stops_dead(trace, runs, int(k))
            ]
            caught = np.array(stops, dtype=np.intp)
        if not caught.size:
            continue
        held_s = trace.time_s[runs.stop[caught] - 1] - trace.time_s[runs.start[caught]]
        found.append(
            Saturation(
                side,  # type: ignore[arg-type]
                float(value),
                int(caught.size),
                float(runs.length[flat].sum() / runs.length.sum()),
                float(trace.time_s[runs.start[caught[0]]]),
                float(held_s.max()),
            )
        )
    return tuple(found)


def _stops_dead(trace: Trace, runs: Runs, k: int) -> bool:
    """Whether the channel runs into a flat as quickly as it moved a little before.

    The very last move is cut short by the limit, so the one before it may speak.
    """
    moves = np.diff(runs.value[max(k - ARRIVING, 0) : k + 1])
    if moves.size < ARRIVING or not (np.all(moves > 0) or np.all(moves < 0)):
        return False
    sizes = np.abs(moves)
    usual = float(np.median(sizes[:-2]))
    return bool(sizes[-2:].max() >= ARRIVAL_SPEED * usual and usual > 2.0 * trace.step)


def _weighted_median(lengths: IntArray) -> float:
    """Length of the run in which the middle sample lies."""
    if not lengths.size:
        return 1.0
    ordered = np.sort(lengths)
    passed = np.cumsum(ordered)
    return float(ordered[int(np.searchsorted(passed, 0.5 * passed[-1]))])
