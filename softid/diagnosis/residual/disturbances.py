"""Marks of what no law of motion brings: a line in the spectrum, short events and slow wander.

All are looked for in what the last model leaves, and told beside the verdict: a pump, a supply
that swings or a cable that is touched are no effects of an actuator.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import log

import numpy as np
import numpy.typing as npt

from softid.diagnosis.residual.noise_floor import LOOK_S, input_span, still_spans
from softid.diagnosis.residual.slow_noise import CODE, slow_noise_issues
from softid.diagnosis.residual.structure import ResidualContext
from softid.diagnosis_results import Remainder
from softid.errors import Issue
from softid.even_times import even_interval_s

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

LEAST_SAMPLES = 256
"""Fewer have too few bins to hold a line against."""

LEAST_CYCLES = 6.0
"""A line goes round so often in a log at least; what is slower may be a wander."""

NEIGHBOURING_BINS = 25
"""A line is held against so many bins of the spectrum on either side, where noise is as loud."""

LINE_CHANCE = 1e-4
"""Chance of a line anywhere in the spectrum of noise that is as loud as the bins beside it: one log
in 10,000."""

OF_THE_INPUT = 0.02
"""The input has a line of its own where a bin holds so much of the power of its strongest one: then
the motion brings it, and a nonlinear law makes of it and of others up to the third harmonic, their
sums and their differences."""

FEWEST_PERIODS = 10
"""A periodic input goes round so often that half of the bins lie away from its multiples."""

MIXED_LINES = 5
"""Most lines of the input, the strongest, whose sums and differences count; those of more are
everywhere."""

MIXED_ORDERS = ((1, 1), (1, 2), (2, 1))
"""How often two lines count in a sum or a difference up to the third order."""

ABOVE_BESIDE = 12.0
"""Times the power of the bins beside it that a line of the input holds at least."""

QUARTERS = 4
"""Parts of a log, in all but one of which a line must be as strong as on the whole."""

AS_STRONG = 0.5
"""Share of a line's amplitude on the whole log that it has in a quarter which shows it as
strong."""

LEAST_SHARE = 0.02
"""Share of the rest's power that a line holds at least."""

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

BETWEEN_BINS = np.linspace(-1.0, 1.0, 41)
"""Places about the best bin, in bins, among which the line has its largest amplitude."""

WINDOW_SAMPLES = 5
"""Samples of a window in which an event is looked for: a few, for a bump or a spike is short."""

LOUD_WINDOW = 16.0
"""Windows count as events when their power is so many times the median one."""

MOST_EVENTS = 0.05
"""Largest share of the windows that are events: where more are so loud, that is how the rest is."""

EVENTS_SHARE = 0.2
"""Least share of the rest's power at rest that all events hold together."""

MOST_TOLD = 3
"""Moments that are told; of more their number is."""

SPECTRAL_LINE, SHORT_EVENTS = "spectral-line", "short-events"
"""Codes of the remarks on a line and on events."""

CODES = (SPECTRAL_LINE, SHORT_EVENTS, CODE)
"""Codes of the remarks on a line, on events and on a slow wander."""


@dataclass(frozen=True)
class Line:
    """A line in the spectrum.

    Attributes
    ----------
    frequency_hz
        Its frequency.
    amplitude
        Its amplitude, in the unit of the residual.
    share
        Share of the residual's power that it holds.
    """

    frequency_hz: float
    amplitude: float
    share: float


def line_in(parts: Sequence[ResidualContext]) -> Line | None:
    """A steady line in the longest part of a residual, at a frequency that the input lacks.

    Parameters
    ----------
    parts
        Residuals with their input.
    """
    part = max(parts, key=lambda p: p.time_s.size)
    time_s, residual, u = _regular(part)
    n = time_s.size
    if n < LEAST_SAMPLES:
        return None
    power, driven = _power(residual), _power(u)
    frequency = np.fft.rfftfreq(n, time_s[1] - time_s[0])
    usable = np.arange(power.size) * 1.0 > LEAST_CYCLES
    usable &= ~_harmonics_of(driven)
    places = np.flatnonzero(usable)
    if places.size < 2 * NEIGHBOURING_BINS:
        return None
    chance = log(places.size) - log(LINE_CHANCE)
    in_input = _height(driven, places) > chance
    in_input |= np.append(in_input[1:], False) | np.append(False, in_input[:-1])
    height = np.where(in_input, 0.0, _height(power, places))
    best = int(np.argmax(height))
    if height[best] <= chance:
        return None
    near_hz = float(frequency[places[best]]) + frequency[1] * BETWEEN_BINS
    line_hz = float(max(near_hz, key=lambda hz: _amplitude(time_s, residual, hz)))
    whole = _amplitude(time_s, residual, line_hz)
    quarters = [
        _amplitude(t, r, line_hz)
        for t, r in zip(
            np.array_split(time_s, QUARTERS), np.array_split(residual, QUARTERS), strict=True
        )
    ]
    steady = sorted(quarters)[1] >= AS_STRONG * whole
    share = 0.5 * whole**2 / max(float(np.mean(residual**2)), np.finfo(float).tiny)
    return Line(line_hz, whole, min(share, 1.0)) if steady and share >= LEAST_SHARE else None


def with_line(remainder: Remainder, line: Line | None, motion_s: float) -> Remainder:
    """What is left with a line that a motion could follow: what a sensor picks up is faster.

    Parameters
    ----------
    remainder
        What is left.
    line
        From `line_in`.
    motion_s
        Time constant of the motion.
    """
    if line is None or line.frequency_hz * motion_s > 1.0:
        return remainder
    return replace(remainder, line_hz=line.frequency_hz, line_share=line.share)


def _height(power: Array, places: npt.NDArray[np.intp]) -> Array:
    """Power at some places of a spectrum over the mean of noise as loud as their neighbours."""
    found: Array = power[places] / (_beside(power, places) / log(2.0))
    return found


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
        found.append(
            Issue(
                SPECTRAL_LINE,
                "warning",
                f"what is left of {channel} holds a steady line at {line.frequency_hz:.3g} Hz, "
                f"{factor * line.amplitude:.3g} {unit} high, which the input does not have",
                "look for a pump, a fan, the mains or a supply that swings",
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


def _regular(part: ResidualContext) -> tuple[Array, Array, Array]:
    """Times at equal distances with the residual, its gaps bridged, and the input."""
    known = np.isfinite(part.residual)
    if int(known.sum()) < LEAST_SAMPLES:
        return part.time_s[:0], part.time_s[:0], part.time_s[:0]
    time_s = np.arange(part.time_s[0], part.time_s[-1], even_interval_s(part.time_s))
    residual = np.interp(time_s, part.time_s[known], part.residual[known])
    return time_s, residual - residual.mean(), np.interp(time_s, part.time_s, part.u)


def _power(values: Array) -> Array:
    window = np.hanning(values.size)
    found: Array = np.abs(np.fft.rfft((values - values.mean()) * window)) ** 2
    return found


def _beside(power: Array, places: npt.NDArray[np.intp]) -> Array:
    """Median power of the bins around each place, the mean's left out."""
    known = np.pad(power[1:], (1 + NEIGHBOURING_BINS, NEIGHBOURING_BINS), constant_values=np.nan)
    around = np.lib.stride_tricks.sliding_window_view(known, 2 * NEIGHBOURING_BINS + 1)[places]
    found: Array = np.maximum(np.nanmedian(around, axis=1), np.finfo(float).tiny)
    return found


def _harmonics_of(driven: Array) -> BoolArray:
    """Bins in which the input has a line, or a nonlinear law makes one of its lines."""
    strong = np.flatnonzero(driven > OF_THE_INPUT * driven.max(initial=0.0))
    strong = strong[driven[strong] > ABOVE_BESIDE * _beside(driven, strong)]
    taken = np.zeros(driven.size, bool)

    def take(place: int, order: int) -> None:
        taken[max(place - 2 * order, 0) : max(place + 2 * order + 1, 0)] = True

    for k in strong.tolist():
        for multiple in (1, 2, 3):
            take(multiple * k, multiple)
    peaks = _strongest_of_each(driven, strong)
    for place in _overtones(driven, peaks):
        take(place, 1)
    for one, other in combinations(peaks, 2):
        for m, n in MIXED_ORDERS:
            take(m * one + n * other, m + n)
            take(abs(m * one - n * other), m + n)
    return taken


def _overtones(power: Array, peaks: Sequence[int]) -> list[int]:
    """Bins of all multiples of the frequency at which a periodic input repeats.

    Dry friction or a dead zone brings them however high they are. None where the input has other
    lines, or too few periods for bins between its multiples.
    """
    first = min(peaks, default=0)
    if not FEWEST_PERIODS <= first < power.size - 1:
        return []
    place = first + _peak_within(np.log(power[first - 1 : first + 2]))
    if any(abs(peak / place - round(peak / place)) * place > 1.0 for peak in peaks):
        return []
    return [round(k * place) for k in range(1, int(power.size / place) + 1)]


def _peak_within(heights: Array) -> float:
    """Where the parabola through three neighbours is highest, from the middle one."""
    before, at, after = heights.tolist()
    return float(0.5 * (before - after) / (before - 2.0 * at + after))


def _strongest_of_each(power: Array, places: npt.NDArray[np.intp]) -> list[int]:
    """The strongest place of each run of neighbours, of the strongest runs."""
    runs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1) if places.size else []
    peaks = [int(run[np.argmax(power[run])]) for run in runs]
    return sorted(peaks, key=lambda place: -power[place])[:MIXED_LINES]


def _amplitude(time_s: Array, residual: Array, frequency_hz: float) -> float:
    phase = 2.0 * np.pi * frequency_hz * time_s
    columns = np.column_stack((np.cos(phase), np.sin(phase), np.ones(phase.size)))
    cosine, sine, _ = np.linalg.lstsq(columns, residual, rcond=None)[0].tolist()
    return float(np.hypot(cosine, sine))


def _at_rest(part: ResidualContext, since_s: float, least: float) -> BoolArray:
    """Samples before which the input has not moved by more than ``least`` for a while."""
    least_s = FEWEST_LOOKED_AT * even_interval_s(part.time_s)
    look_s = max(min(LOOK_S, LOOKED_AT * since_s), least_s)
    still = np.zeros(part.time_s.size, np.bool_)
    for span in still_spans(part.u, part.time_s, least, look_s=look_s):
        still[span] = part.time_s[span] - part.time_s[span.start] >= since_s
    return still
