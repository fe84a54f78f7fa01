"""Cut an input into stretches of one kind of excitation each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.excitation.holds import SettledWindow, bounds_of, distinct_levels, windows_of
from softid.excitation.motion import Motion, describe_motion
from softid.excitation.shapes import Piece, Shape, recognise_shapes
from softid.excitation.waves import holds_between_waves

Array = npt.NDArray[np.float64]
Kind = Literal["step", "staircase", "sine", "sweep", "rest", "free"]

KIND_OF_SHAPE: dict[Shape, Kind] = {
    "sine": "sine",
    "triangle": "sweep",
    "ramp": "sweep",
    "chirp": "sweep",
    "free": "free",
}
SLOW_TRANSITION = 0.5
"""A change of level that takes longer than this share of the shorter hold beside it is a step only
if it has no shape of its own, as a ramp or a wave has."""

LONGEST_TRANSITION = 1.5
"""A change that takes longer than so many times the longer hold beside it is no step."""

LONGEST_CUT_TRANSITION = 1.0
"""Longest change in which the log begins or ends that may be a step, in times the longer hold
beside it: a part of the change is missing."""

SAME_LEVEL = 2.0
"""Tolerances up to which two levels are one: each may be one tolerance off."""

BRIEF_LEVEL = 0.2
"""A level at which the input is held in all for less than this share of a usual hold is none of a
staircase's, but a place where it halted on its way."""


@dataclass(frozen=True)
class Stretch:
    """A part of a log on which the input is excited in one way.

    Attributes
    ----------
    kind
        ``"step"`` (two levels), ``"staircase"`` (more), ``"sine"``, ``"sweep"``, ``"rest"`` or
        ``"free"`` (anything else).
    start, stop
        Half-open range of the samples.
    start_s, stop_s
        Times of its first and last sample.
    low, high
        Smallest and largest input, glitches aside, in the input's unit.
    shape
        Of a sweep: ``"ramp"``, ``"triangle"`` or ``"chirp"``.
    levels
        Of steps and staircases: the distinct levels, rising.
    transitions
        Of steps and staircases: the number of changes of level.
    hold_s, shortest_hold_s, longest_hold_s
        Of steps, staircases and rests: median, smallest and largest time for which a level is
        held.
    frequency_hz, frequency_end_hz
        Of sines, triangles and chirps; the latter is a chirp's last frequency.
    amplitude, offset
        Of sines and sweeps: half of peak to peak, and the middle.
    cycles
        Of sines, triangles and chirps.
    rate
        Of ramps and triangles: speed in the input's unit per second.
    """

    kind: Kind
    start: int
    stop: int
    start_s: float
    stop_s: float
    low: float
    high: float
    shape: Literal["ramp", "triangle", "chirp"] | None = None
    levels: tuple[float, ...] = ()
    transitions: int | None = None
    hold_s: float | None = None
    shortest_hold_s: float | None = None
    longest_hold_s: float | None = None
    frequency_hz: float | None = None
    frequency_end_hz: float | None = None
    amplitude: float | None = None
    offset: float | None = None
    cycles: float | None = None
    rate: float | None = None

    @property
    def duration_s(self) -> float:
        """Time from the first to the last sample."""
        return self.stop_s - self.start_s


def segment_excitation(time_s: Array, input_values: Array) -> tuple[Stretch, ...]:
    """Recognise how a log is excited, from its input alone.

    Holds are found first (`softid.excitation.settled_windows`); those joined by quick changes of
    level are steps or staircases, single ones rests. What moves between them is cut at its turning
    points into parts with equal cycles (sine or triangle, whichever fits better), with steadily
    changing cycles (chirp), single ramps, and the rest, which is called free.

    Parameters
    ----------
    time_s, input_values
        Samples, shape (n,), finite; the sampling may be irregular.

    Returns
    -------
    tuple of Stretch
        In order of time, without overlap.

    Examples
    --------
    >>> time_s = np.arange(2000) * 0.01
    >>> (found,) = segment_excitation(time_s, 30.0 + 20.0 * np.sin(2 * np.pi * 0.5 * time_s))
    >>> found.kind, round(found.frequency_hz, 3), round(found.amplitude, 2)
    ('sine', 0.5, 20.0)
    """
    return excitation_and_holds(time_s, input_values)[0]


def excitation_and_holds(
    time_s: Array, input_values: Array
) -> tuple[tuple[Stretch, ...], tuple[SettledWindow, ...]]:
    """Both `segment_excitation` and `settled_windows` for the work of one.

    Parameters
    ----------
    time_s, input_values
        Samples, shape (n,), finite.
    """
    motion = describe_motion(time_s, input_values)
    spans = holds_between_waves(motion)
    stretches = _Assembly(motion, time_s, input_values, spans).stretches()
    return stretches, windows_of(motion, spans, input_values)


def settled_windows(
    time_s: Array, input_values: Array, *, tail: float = 1.0
) -> tuple[SettledWindow, ...]:
    """Windows on which the input stands still, between the transitions of steps and staircases.

    The input counts as still while it stays within its noise and quantisation, or 1.5 % of its
    range, of one level, for at least 8 samples; the slow extremes of a sine or a triangle do not
    count.

    Parameters
    ----------
    time_s, input_values
        Samples, shape (n,), finite.
    tail
        Share of each window to keep, counted from its end, so that the output has settled too.

    Examples
    --------
    >>> time_s = np.arange(400) * 0.01
    >>> levels = np.repeat([0.0, 20.0, 40.0, 0.0], 100)
    >>> [(w.start, w.stop, w.level) for w in settled_windows(time_s, levels)]
    [(0, 100, 0.0), (100, 200, 20.0), (200, 300, 40.0), (300, 400, 0.0)]
    """
    motion = describe_motion(time_s, input_values)
    return windows_of(motion, holds_between_waves(motion), input_values, tail=tail)


def _lasting_levels(
    windows: Sequence[SettledWindow], held_s: Sequence[float], margin: float
) -> tuple[float, ...]:
    """Distinct levels, without those of which the log has next to nothing.

    The lower median of the holds is the measure, so that a long hold cannot belittle a second one.
    """
    levels = np.array(distinct_levels([w.level for w in windows], margin))
    nearest = [int(np.abs(levels - w.level).argmin()) for w in windows]
    lasting = np.bincount(nearest, weights=held_s, minlength=levels.size)
    usual = sorted(held_s)[(len(held_s) - 1) // 2]
    return tuple(levels[lasting >= BRIEF_LEVEL * usual].tolist())


class _Assembly:
    """Turns holds and the pieces between them into stretches of the original samples."""

    def __init__(
        self,
        motion: Motion,
        time_s: Array,
        input_values: Array,
        spans: list[tuple[int, int]],
    ) -> None:
        self.motion = motion
        self.time_s = time_s
        self.input = input_values
        self.spans = spans
        self.edges = np.append(motion.index, input_values.size)
        for span in spans:
            self.edges[[span[0], span[1]]] = bounds_of(motion, span, input_values.size)

    def stretches(self) -> tuple[Stretch, ...]:
        found: list[Stretch] = []
        group: list[tuple[int, int]] = []
        reached, entry = 0, 0
        for span in self.spans:
            pieces = self._moving(reached, span[0])
            before = group[-1] if group else None
            if not self._is_transition(before, span, pieces):
                found += self._held(group, entry, reached)
                found += [self._moved(piece) for piece in pieces]
                group, entry = [], span[0]
            group.append(span)
            reached = span[1]
        pieces = self._moving(reached, self.motion.values.size)
        if group and self._is_transition(group[-1], None, pieces):
            reached, pieces = self.motion.values.size, ()
        found += self._held(group, entry, reached)
        found += [self._moved(piece) for piece in pieces]
        return tuple(found)

    def _moving(self, start: int, stop: int) -> tuple[Piece, ...]:
        """The pieces of a moving range, which takes in the ends of the holds beside it."""
        if stop - start < 1:
            return ()
        turns = self.motion.turns
        inside = turns[(turns > start) & (turns < stop - 1)] - start
        part = slice(start, stop)
        pieces = recognise_shapes(self.motion.time_s[part], self.motion.values[part], inside)
        return tuple(replace(p, start=p.start + start, stop=p.stop + start) for p in pieces)

    def _is_transition(
        self,
        before: tuple[int, int] | None,
        after: tuple[int, int] | None,
        pieces: tuple[Piece, ...],
    ) -> bool:
        """Whether the input changes level quickly and simply, as a step does.

        Without a hold before or after, the log begins or ends in the middle of a change.
        """
        times = self.motion.time_s
        held = [float(times[s[1] - 1] - times[s[0]]) for s in (before, after) if s is not None]
        since = before[1] - 1 if before is not None else 0
        until = after[0] if after is not None else times.size - 1
        lasting = float(times[until] - times[since])
        most = LONGEST_TRANSITION
        if before is None or after is None:
            turns = self.motion.turns
            if np.any((turns > since) & (turns < until)):
                return False
            most = LONGEST_CUT_TRANSITION
        if lasting > most * max(held):
            return False
        slow = lasting > SLOW_TRANSITION * min(held)
        return not (slow and any(p.shape in ("ramp", "sine", "triangle", "chirp") for p in pieces))

    def _held(self, group: list[tuple[int, int]], entry: int, leave: int) -> list[Stretch]:
        if not group:
            return []
        windows = windows_of(self.motion, group, self.input)
        margin = SAME_LEVEL * self.motion.tolerance
        held = [float(self.time_s[w.stop - 1] - self.time_s[w.start]) for w in windows]
        levels = _lasting_levels(windows, held, margin)
        lasting = [min(abs(w.level - level) for level in levels) <= margin for w in windows]
        held = [h for h, kept in zip(held, lasting, strict=True) if kept]
        visited = [w.level for w, kept in zip(windows, lasting, strict=True) if kept]
        if entry < group[0][0]:
            visited.insert(0, float(self.motion.values[entry]))
        if leave > group[-1][1]:
            visited.append(float(self.motion.values[leave - 1]))
        changes = int(np.count_nonzero(np.abs(np.diff(visited)) > margin))
        kind: Kind = "staircase" if len(levels) > 2 else "step" if changes else "rest"
        base = self._stretch(kind, int(self.edges[entry]), int(self.edges[leave]))
        return [
            replace(
                base,
                levels=levels,
                transitions=None if kind == "rest" else changes,
                hold_s=float(np.median(held)),
                shortest_hold_s=min(held),
                longest_hold_s=max(held),
            )
        ]

    def _moved(self, piece: Piece) -> Stretch:
        base = self._stretch(
            KIND_OF_SHAPE[piece.shape], int(self.edges[piece.start]), int(self.edges[piece.stop])
        )
        return replace(
            base,
            shape=piece.shape if piece.shape in ("ramp", "triangle", "chirp") else None,
            frequency_hz=piece.frequency_hz,
            frequency_end_hz=piece.frequency_end_hz,
            amplitude=piece.amplitude,
            offset=piece.offset,
            cycles=piece.cycles,
            rate=piece.rate,
        )

    def _stretch(self, kind: Kind, start: int, stop: int) -> Stretch:
        first, last = np.searchsorted(self.motion.index, [start, stop])
        seen = self.motion.values[first : max(last, first + 1)]
        return Stretch(
            kind,
            start,
            stop,
            float(self.time_s[start]),
            float(self.time_s[stop - 1]),
            float(seen.min()),
            float(seen.max()),
        )
