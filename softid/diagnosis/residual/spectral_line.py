"""A line in the spectrum of what a model leaves, at a frequency that the input lacks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import log

import numpy as np
import numpy.typing as npt

from softid.diagnosis.residual.structure import ResidualContext
from softid.diagnosis_results import Remainder
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

SHARPER = 30.0
"""A line that stands out of the bins beside it so many times as far as any of the input's does is
made of none: chance makes weak lines of random steps, whose multiples are everywhere."""

QUARTERS = 4
"""Parts of a log, in all but one of which a line must be as strong as on the whole."""

AS_STRONG = 0.5
"""Share of a line's amplitude on the whole log that it has in a quarter which shows it as
strong."""

HARMONICS, WIDTH = 6, 3
"""Multiples of the rate at which the input moves that are of it, for of what begins at once and
settles a higher one holds less than `LEAST_SHARE`; and bins that a line is wide on either side."""

CYCLES_OF_A_PART, MOST_PARTS, IN_STEP = 2.0, 16, 0.75
"""Cycles that a part of a log holds at least, most such parts, and the least share of their mean
power that a line has on the whole log whose phase is the same in all: each move of the input sets
off a swing of its own. Those of swings have 0.3 to 0.6 of it."""

LEAST_SHARE = 0.02
"""Share of the rest's power that a line holds at least."""

BETWEEN_BINS = np.linspace(-1.0, 1.0, 41)
"""Places about the best bin, in bins, among which the line has its largest amplitude."""


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
    in_step
        Whether its phase is the same all along, as that of a pump.
    """

    frequency_hz: float
    amplitude: float
    share: float
    in_step: bool = True


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
    lines = _lines_of(driven)
    sharpest = float(np.max(_height(driven, lines), initial=0.0))
    stands_out = _height(power, np.arange(power.size)) > SHARPER * sharpest
    usable &= ~_harmonics_of(driven, lines) | stands_out
    places = np.flatnonzero(usable)
    if places.size < 2 * NEIGHBOURING_BINS:
        return None
    chance = log(places.size) - log(LINE_CHANCE)
    in_input = _height(driven, places) > chance
    in_input |= _of_moves(u, places, chance)
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
    if not (steady and share >= LEAST_SHARE):
        return None
    return Line(line_hz, whole, min(share, 1.0), _is_in_step(time_s, residual, line_hz))


def _of_moves(u: Array, places: npt.NDArray[np.intp], chance: float) -> BoolArray:
    """Whether bins are of the rate at which the input moves, either way, or of a low harmonic.

    A staircase that goes up and down again has no line at the rate of its steps, but what it does
    to the motion at each of them has.
    """
    heights = _height(_power(np.abs(np.gradient(u))), places)
    tall = heights > chance
    if not tall.any():
        return tall
    lowest = tall & (places <= places[tall][0] + WIDTH)
    rate = int(places[lowest][np.argmax(heights[lowest])])
    found: BoolArray = tall & (places <= HARMONICS * rate + WIDTH)
    return found


def _is_in_step(time_s: Array, residual: Array, line_hz: float) -> bool:
    """Whether a line is hardly weaker on the whole log than in its parts, but for white noise."""
    cycles = line_hz * (time_s[-1] - time_s[0])
    count = int(np.clip(cycles / CYCLES_OF_A_PART, QUARTERS, MOST_PARTS))
    split = zip(np.array_split(time_s, count), np.array_split(residual, count), strict=True)
    of_parts = float(np.mean([_amplitude(t, r, line_hz) ** 2 for t, r in split]))
    whole = _amplitude(time_s, residual, line_hz) ** 2
    of_noise = 4.0 * count / time_s.size * max(float(np.mean(residual**2)) - 0.5 * whole, 0.0)
    return whole > IN_STEP * (of_parts - of_noise)


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


def _lines_of(driven: Array) -> npt.NDArray[np.intp]:
    """Bins in which the input has a line."""
    strong = np.flatnonzero(driven > OF_THE_INPUT * driven.max(initial=0.0))
    return strong[driven[strong] > ABOVE_BESIDE * _beside(driven, strong)]


def _harmonics_of(driven: Array, lines: npt.NDArray[np.intp]) -> BoolArray:
    """Bins in which the input has a line, or a nonlinear law makes one of its lines."""
    taken = np.zeros(driven.size, bool)

    def take(place: int, order: int) -> None:
        taken[max(place - 2 * order, 0) : max(place + 2 * order + 1, 0)] = True

    for k in lines.tolist():
        for multiple in (1, 2, 3):
            take(multiple * k, multiple)
    peaks = _strongest_of_each(driven, lines)
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
