"""What a moving input does between two holds: sine, triangle, ramp, chirp, or anything else."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
Shape = Literal["sine", "triangle", "ramp", "chirp", "free"]

CYCLE_SPREAD = 0.2
"""Difference of a cycle from the usual one, as a share of it, up to which they are equally long:
the time of a crossing is blurred by noise and by a few samples a cycle."""

HEIGHT_SPREAD = 0.25
"""Difference of a cycle's height from the usual one, as a share of it, up to which cycles are
equally high; the first and the last are often smaller."""

TREND = 0.15
"""Change of the length of the cycles, over all of them and as a share, up to which they are equally
long and no slow chirp."""

CHIRP_RATIO = 1.4
"""Ratio of the longest to the shortest cycle from which a drift is meant."""

CHIRP_STEP = 0.08
"""Share of a cycle by which the next may go against the drift: blurred crossings."""

CHIRP_SAMPLES = 2.5
"""Samples by which a cycle may go against the drift as well: either crossing of a short cycle may
be one sample off."""

CHIRP_HEIGHT = 1.8
"""Largest ratio of the heights of neighbouring half cycles of a chirp; a valve follows its fast end
less and less, but not by halves from one to the next."""

CHIRP_JUMP = 1.8
"""Largest ratio of neighbouring cycles of a chirp: an octave at once is another motion."""

MIN_CHIRP_CYCLES = 8
"""Fewer cycles grow or shrink one after the other by chance."""

MIN_SAMPLES_PER_CYCLE = 5.0
"""Cycles of fewer samples have lengths that are known to no better than `CYCLE_SPREAD`."""

STEADY_CYCLES = 4
"""Twice as many even cycles are a sine though they seem to go on in a drift; fewer are the slow
beginning of a chirp."""

SINE_R2 = 0.95
"""Share of the variance that a sine explains at least; it is 0.985 of a triangle, which must then
fit worse itself."""

TRIANGLE_R2 = 0.97
"""Share of the variance that straight lines between the turning points of a triangle explain at
least; it is 0.95 of a sine."""

RAMP_R2 = 0.985
"""Share of the variance that one straight line explains of a ramp at least; it is 0.96 of a quarter
of a cosine, which bends one way; half of one, with 0.9855, is a ramp with rounded ends."""

SHORT_SINE_R2 = 0.98
"""Share of the variance that a sine through less than two cycles explains at least: it has three
unknowns for few bends."""

SHORT_TRIANGLE_R2 = 0.98
"""Share of the variance that straight lines between the turning points of less than two cycles
explain at least."""

MIN_TURNS = 4
"""Turning points from which there is a whole cycle between two crossings."""

MIN_SAMPLES = 8
"""Fewer samples have no shape: a sine through them has half as many unknowns."""

LEAST_OF_A_CYCLE = 0.75
"""A sine of which less is there is any smooth bend."""

SHORT_SPREAD = 0.4
"""Share by which the frequency of a short sine may differ from that of its turning points."""

LONG_SPREAD = 0.05
"""Share by which the frequency of a long sine may differ from that of its crossings, whose mean is
better known than that of a few turning points."""

MOST_FITTED = 1000
"""Samples that a sine is fitted to: more cost time and tell its shape no better."""

FREQUENCY_GRID = 25
"""Frequencies tried on either grid; the second one spans two intervals of the first to
either side."""


@dataclass(frozen=True)
class Piece:
    """A moving range of one shape, positions in the reduced input.

    Attributes
    ----------
    shape
        What it looks like.
    start, stop
        Half-open range.
    frequency_hz, frequency_end_hz
        Frequency, of a chirp at its first and its last cycle.
    amplitude, offset
        Half of peak to peak, and the middle, in the input's unit.
    cycles
        Number of cycles.
    rate
        Speed of a ramp or triangle, in the input's unit per second.
    """

    shape: Shape
    start: int
    stop: int
    frequency_hz: float | None = None
    frequency_end_hz: float | None = None
    amplitude: float | None = None
    offset: float | None = None
    cycles: float | None = None
    rate: float | None = None


def recognise_shapes(time_s: Array, values: Array, turns: IntArray) -> tuple[Piece, ...]:
    """Cut a moving input into pieces of one shape each.

    Parameters
    ----------
    time_s, values
        Samples of the moving range, shape (n,).
    turns
        Positions of its turning points, shape (m,), ends not included.
    """
    if turns.size < MIN_TURNS:
        return (_short_piece(time_s, values, turns),)
    pieces: list[Piece] = []
    first = 0
    crossing_s = _crossings(time_s, values, turns)
    heights = np.abs(np.diff(values[turns]))
    period_s = float(np.median(np.diff(time_s)))
    while first <= turns.size - MIN_TURNS:
        steady, last = _steady_cycles(crossing_s[first:], heights[first:], period_s)
        last += first
        if not steady and last == first:
            first += 1
            continue
        pieces.append(_cycling_piece(time_s, values, turns, (first, last), steady=steady))
        first = last
    return tuple(_with_leftovers(pieces, values))


def _short_piece(time_s: Array, values: Array, turns: IntArray) -> Piece:
    """A range with too few turning points to speak of cycles."""
    n = values.size
    if n >= MIN_SAMPLES and turns.size == 0:
        slope, r2 = _line(time_s, values)
        if r2 >= RAMP_R2:
            span = 0.5 * float(values.max() - values.min())
            middle = 0.5 * float(values.max() + values.min())
            return Piece("ramp", 0, n, amplitude=span, offset=middle, rate=abs(slope))
        return Piece("free", 0, n)
    if n < MIN_SAMPLES:
        return Piece("free", 0, n)
    corners = np.concatenate([[0], turns, [n - 1]])
    r2_triangle = _r2(values, np.interp(time_s, time_s[corners], values[corners]))
    guess_hz = _half_cycles_hz(time_s, turns)
    fit = _fit_sine(time_s, values, guess_hz, spread=SHORT_SPREAD)
    enough = fit.frequency_hz * float(time_s[-1] - time_s[0]) >= LEAST_OF_A_CYCLE
    if fit.r2 >= SHORT_SINE_R2 and fit.r2 >= r2_triangle and enough:
        return _sine_piece(fit, time_s, (0, n))
    if r2_triangle >= SHORT_TRIANGLE_R2:
        return _triangle_piece(time_s, values, corners, (0, n))
    return Piece("free", 0, n)


def _half_cycles_hz(time_s: Array, turns: IntArray) -> float:
    if turns.size >= 2:
        return 0.5 / float(np.diff(time_s[turns]).mean())
    longer = max(time_s[turns[0]] - time_s[0], time_s[-1] - time_s[turns[0]])
    return 0.5 / float(longer)


def _crossings(time_s: Array, values: Array, turns: IntArray) -> Array:
    """Times at which the input passes halfway from one turning point to the next, shape (m − 1,).

    They suffer far less from noise than the times of the turning points themselves.
    """
    times = np.empty(turns.size - 1)
    for k, (a, b) in enumerate(pairwise(turns.tolist())):
        rising = 1.0 if values[b] > values[a] else -1.0
        above = rising * (values[a : b + 1] - 0.5 * (values[a] + values[b]))
        after = a + int(np.argmax(above >= 0.0))
        gain = values[after] - values[after - 1]
        share = (0.5 * (values[a] + values[b]) - values[after - 1]) / gain
        times[k] = time_s[after - 1] + share * (time_s[after] - time_s[after - 1])
    return times


def _steady_cycles(crossing_s: Array, heights: Array, period_s: float) -> tuple[bool, int]:
    """Whether the leading cycles are equally long, and the turning point up to which they go.

    Returns (False, last) for a chirp and (False, 0) for neither.
    """
    cycle_s = crossing_s[2:] - crossing_s[:-2]
    resolved = cycle_s >= MIN_SAMPLES_PER_CYCLE * period_s
    usable = cycle_s.size if resolved.all() else int(np.argmin(resolved))
    if usable == 0:
        return False, 0
    cycle_s, heights = cycle_s[:usable], heights[: usable + 2]
    even = _count_even(cycle_s, heights)
    drifting = _count_drifting(cycle_s, heights, period_s)
    outlasted = drifting > even and even < 2 * STEADY_CYCLES
    if even >= 1 and not outlasted and _relative_trend(cycle_s[:even]) <= TREND:
        return True, even + 2
    return False, drifting + 2 if drifting else 0


def _count_even(cycle_s: Array, heights: Array) -> int:
    """Length of the leading part whose cycles are equally long and high."""
    if heights[:3].max() > (1.0 + HEIGHT_SPREAD) * heights[:3].min():
        return 0
    count = 1
    while count < cycle_s.size:
        usual, high = float(np.median(cycle_s[:count])), float(np.median(heights[: count + 2]))
        if abs(cycle_s[count] - usual) > CYCLE_SPREAD * usual:
            break
        if abs(heights[count + 2] - high) > HEIGHT_SPREAD * high:
            break
        count += 1
    return count


def _count_drifting(cycle_s: Array, heights: Array, period_s: float) -> int:
    """Length of the leading part whose cycles grow or shrink steadily; 0 when too short."""
    if cycle_s.size < MIN_CHIRP_CYCLES:
        return 0
    longest = 0
    for sign in (1.0, -1.0):
        growth = sign * np.diff(cycle_s)
        uneven = np.maximum(heights[3:] / heights[2:-1], heights[2:-1] / heights[3:])
        jump = np.maximum(cycle_s[1:] / cycle_s[:-1], cycle_s[:-1] / cycle_s[1:])
        steady = growth >= -CHIRP_STEP * cycle_s[:-1] - CHIRP_SAMPLES * period_s
        steady &= jump <= CHIRP_JUMP
        steady &= uneven <= CHIRP_HEIGHT
        stops = np.flatnonzero(~steady)
        count = int(stops[0]) + 1 if stops.size else cycle_s.size
        part = cycle_s[:count]
        if count >= MIN_CHIRP_CYCLES and sign * np.log(part[-1] / part[0]) >= np.log(CHIRP_RATIO):
            longest = max(longest, count)
    return longest


def _relative_trend(cycle_s: Array) -> float:
    if cycle_s.size < 3:
        return 0.0
    place = np.arange(cycle_s.size) - 0.5 * (cycle_s.size - 1)
    slope = float(place @ cycle_s) / float(place @ place)
    return abs(slope) * (cycle_s.size - 1) / float(cycle_s.mean())


def _cycling_piece(
    time_s: Array, values: Array, turns: IntArray, span: tuple[int, int], *, steady: bool
) -> Piece:
    first, last = span
    corners = turns[first : last + 1]
    whole = (
        0 if first == 0 else int(corners[0]),
        values.size if last == turns.size - 1 else int(corners[-1]),
    )
    inside = slice(int(corners[0]), int(corners[-1]) + 1)
    t, v = time_s[inside], values[inside]
    crossing_s = _crossings(time_s, values, corners)
    cycle_s = crossing_s[2:] - crossing_s[:-2]
    if not steady:
        tops = values[corners]
        return Piece(
            "chirp",
            *whole,
            frequency_hz=1.0 / float(cycle_s[0]),
            frequency_end_hz=1.0 / float(cycle_s[-1]),
            amplitude=0.5 * float(np.median(np.abs(np.diff(tops)))),
            offset=0.5 * float(tops.max() + tops.min()),
            cycles=0.5 * (corners.size - 1),
        )
    fit = _fit_sine(t, v, 1.0 / float(cycle_s.mean()), spread=LONG_SPREAD)
    r2_triangle = _r2(v, np.interp(t, time_s[corners], values[corners]))
    if fit.r2 >= SINE_R2 and fit.r2 >= r2_triangle:
        return _sine_piece(fit, time_s, whole)
    if r2_triangle >= TRIANGLE_R2:
        return _triangle_piece(time_s, values, corners, whole)
    return Piece("free", *whole)


def _sine_piece(fit: _SineFit, time_s: Array, span: tuple[int, int]) -> Piece:
    seconds = float(time_s[span[1] - 1] - time_s[span[0]])
    return Piece(
        "sine",
        *span,
        frequency_hz=fit.frequency_hz,
        amplitude=fit.amplitude,
        offset=fit.offset,
        cycles=fit.frequency_hz * seconds,
    )


def _triangle_piece(
    time_s: Array, values: Array, corners: IntArray, span: tuple[int, int]
) -> Piece:
    heights, durations = np.abs(np.diff(values[corners])), np.diff(time_s[corners])
    seconds = float(time_s[span[1] - 1] - time_s[span[0]])
    frequency_hz = 0.5 / float(durations.mean())
    return Piece(
        "triangle",
        *span,
        frequency_hz=frequency_hz,
        amplitude=0.5 * float(np.median(heights)),
        offset=0.5 * float(values[corners].max() + values[corners].min()),
        cycles=frequency_hz * seconds,
        rate=float(np.median(heights / durations)),
    )


def _with_leftovers(pieces: list[Piece], values: Array) -> list[Piece]:
    """Fill what lies between the recognised pieces with free ones."""
    filled: list[Piece] = []
    reached = 0
    for piece in pieces:
        if piece.start > reached:
            filled.append(Piece("free", reached, piece.start))
        filled.append(piece)
        reached = piece.stop
    if reached < values.size:
        filled.append(Piece("free", reached, values.size))
    joined: list[Piece] = []
    for piece in filled:
        if joined and joined[-1].shape == piece.shape == "free":
            joined[-1] = Piece("free", joined[-1].start, piece.stop)
        else:
            joined.append(piece)
    return joined


@dataclass(frozen=True)
class _SineFit:
    frequency_hz: float
    amplitude: float
    offset: float
    r2: float


def _fit_sine(time_s: Array, values: Array, guess_hz: float, *, spread: float) -> _SineFit:
    """Least-squares sine on a grid of frequencies about a guess, then on a finer one."""
    stride = -(-values.size // MOST_FITTED)
    t, v = time_s[::stride] - time_s[0], values[::stride]
    best = _SineFit(guess_hz, 0.0, float(v.mean()), -np.inf)
    for width in (spread, spread / (0.25 * FREQUENCY_GRID)):
        for frequency in best.frequency_hz * np.linspace(1 - width, 1 + width, FREQUENCY_GRID):
            angle = 2.0 * np.pi * frequency * t
            basis = np.column_stack([np.ones(t.size), np.sin(angle), np.cos(angle)])
            solution = np.linalg.lstsq(basis, v, rcond=None)[0]
            r2 = _r2(v, basis @ solution)
            if r2 > best.r2:
                amplitude = float(np.hypot(solution[1], solution[2]))
                best = _SineFit(float(frequency), amplitude, float(solution[0]), r2)
    return best


def _line(time_s: Array, values: Array) -> tuple[float, float]:
    centred = time_s - time_s.mean()
    slope = float(centred @ values) / float(centred @ centred)
    return slope, _r2(values, values.mean() + slope * centred)


def _r2(values: Array, fitted: Array) -> float:
    total = float(np.sum((values - values.mean()) ** 2))
    if total == 0.0:
        return 0.0
    return 1.0 - float(np.sum((values - fitted) ** 2)) / total
