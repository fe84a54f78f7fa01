"""Commanded pressure as analytic pieces: the kinds of excitation that a recipe may ask for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi, sin
from typing import Annotated, ClassVar

import numpy as np

from softid.errors import InputError
from softid.synthesis.tables import Checked, Count, Positive, Range, read_record, require_table

Level = Annotated[float, Range(lower=-100.0, upper=2000.0)]
"""Gauge pressure in kPa: not below vacuum, not above what a laboratory regulator gives."""


@dataclass(frozen=True)
class Piece:
    """A stretch on which the command is one analytic function; the solver restarts at its ends.

    Attributes
    ----------
    start_s, stop_s
        Half-open range of time.
    command_kpa
        Command as a function of the time in s.
    """

    start_s: float
    stop_s: float
    command_kpa: Callable[[float], float]


@dataclass(frozen=True)
class Waveform(Checked, ABC):
    """A command over time; a subclass is one kind of the recipe's ``[excitation]``."""

    kind: ClassVar[str]

    @abstractmethod
    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """The command from ``start_s`` on; ``rng`` is drawn from only by random kinds."""


def _line(start_s: float, stop_s: float, from_kpa: float, to_kpa: float) -> Piece:
    slope = (to_kpa - from_kpa) / (stop_s - start_s)

    def ramp(time_s: float) -> float:
        return from_kpa + slope * (time_s - start_s)

    def level(time_s: float) -> float:
        del time_s
        return from_kpa

    return Piece(start_s, stop_s, ramp if slope else level)


def _levels(
    start_s: float, levels_kpa: tuple[float, ...], holds_s: tuple[float, ...]
) -> tuple[Piece, ...]:
    edges = [start_s]
    for hold in holds_s:
        edges.append(edges[-1] + hold)
    spans = zip(pairwise(edges), levels_kpa, strict=True)
    return tuple(_line(begin, end, level, level) for (begin, end), level in spans)


@dataclass(frozen=True)
class Hold(Waveform):
    """One constant level."""

    kind: ClassVar[str] = "hold"
    level_kpa: Level
    duration_s: Positive

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        return _levels(start_s, (self.level_kpa,), (self.duration_s,))


@dataclass(frozen=True)
class Rest(Waveform):
    """No pressure."""

    kind: ClassVar[str] = "rest"
    duration_s: Positive

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        return _levels(start_s, (0.0,), (self.duration_s,))


@dataclass(frozen=True)
class Steps(Waveform):
    """Jumps from level to level, each held equally long."""

    kind: ClassVar[str] = "steps"
    levels_kpa: tuple[Level, ...]
    hold_s: Positive

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        return _levels(start_s, self.levels_kpa, (self.hold_s,) * len(self.levels_kpa))


@dataclass(frozen=True)
class Staircase(Waveform):
    """Equal steps from the first to the last level and, if asked, back."""

    kind: ClassVar[str] = "staircase"
    first_kpa: Level
    last_kpa: Level
    steps: Count
    hold_s: Positive
    back: bool = False

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        rise = (self.last_kpa - self.first_kpa) / self.steps
        levels = [self.first_kpa + rise * k for k in range(self.steps + 1)]
        if self.back:
            levels += levels[-2::-1]
        return _levels(start_s, tuple(levels), (self.hold_s,) * len(levels))


@dataclass(frozen=True)
class Square(Waveform):
    """Low and high level in turn, low first."""

    kind: ClassVar[str] = "square"
    low_kpa: Level
    high_kpa: Level
    frequency_hz: Positive
    cycles: Count

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        half_s = 0.5 / self.frequency_hz
        count = 2 * self.cycles
        return _levels(start_s, (self.low_kpa, self.high_kpa) * self.cycles, (half_s,) * count)


@dataclass(frozen=True)
class Sine(Waveform):
    """low + (high − low)/2 · (1 − cos 2πft): starts at its lowest point without a jump."""

    kind: ClassVar[str] = "sine"
    low_kpa: Level
    high_kpa: Level
    frequency_hz: Positive
    cycles: Positive

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        half_kpa = 0.5 * (self.high_kpa - self.low_kpa)
        middle_kpa = self.low_kpa + half_kpa
        omega = 2.0 * pi * self.frequency_hz

        def command(time_s: float) -> float:
            return middle_kpa - half_kpa * cos(omega * (time_s - start_s))

        return (Piece(start_s, start_s + self.cycles / self.frequency_hz, command),)


@dataclass(frozen=True)
class Triangle(Waveform):
    """Straight up and straight down, starting low."""

    kind: ClassVar[str] = "triangle"
    low_kpa: Level
    high_kpa: Level
    period_s: Positive
    cycles: Count

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        half_s = 0.5 * self.period_s
        edges = [start_s + k * half_s for k in range(2 * self.cycles + 1)]
        ends = (self.low_kpa, self.high_kpa)
        return tuple(
            _line(begin, end, ends[k % 2], ends[(k + 1) % 2])
            for k, (begin, end) in enumerate(pairwise(edges))
        )


@dataclass(frozen=True)
class Sweep(Waveform):
    """One straight line from level to level."""

    kind: ClassVar[str] = "sweep"
    first_kpa: Level
    last_kpa: Level
    duration_s: Positive

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        return (_line(start_s, start_s + self.duration_s, self.first_kpa, self.last_kpa),)


@dataclass(frozen=True)
class Chirp(Waveform):
    """A sine whose frequency grows evenly from the first to the last, from its lowest point on."""

    kind: ClassVar[str] = "chirp"
    low_kpa: Level
    high_kpa: Level
    first_hz: Positive
    last_hz: Positive
    duration_s: Positive

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        half_kpa = 0.5 * (self.high_kpa - self.low_kpa)
        middle_kpa = self.low_kpa + half_kpa
        growth = 0.5 * (self.last_hz - self.first_hz) / self.duration_s
        first_hz = self.first_hz

        def command(time_s: float) -> float:
            passed_s = time_s - start_s
            return middle_kpa - half_kpa * cos(2.0 * pi * (first_hz + growth * passed_s) * passed_s)

        return (Piece(start_s, start_s + self.duration_s, command),)


@dataclass(frozen=True)
class RandomWaveform(Waveform):
    """Evenly distributed levels, each with an evenly distributed time, from the seed."""

    low_kpa: Level
    high_kpa: Level
    count: Count
    shortest_s: Positive
    longest_s: Positive

    def drawn(self, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """Levels in kPa and times in s, each of shape (count,)."""
        draws = rng.random((2, self.count))
        levels = self.low_kpa + (self.high_kpa - self.low_kpa) * draws[0]
        return levels, self.shortest_s + (self.longest_s - self.shortest_s) * draws[1]


@dataclass(frozen=True)
class RandomLevels(RandomWaveform):
    """Jumps to evenly distributed levels, held for evenly distributed times, from the seed."""

    kind: ClassVar[str] = "random_levels"

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        levels, holds = self.drawn(rng)
        # Whole 0.1 kPa and 0.01 s, as somebody would set them.
        return _levels(
            start_s,
            tuple(np.round(levels, 1).tolist()),
            tuple(np.maximum(np.round(holds, 2), 0.01).tolist()),
        )


@dataclass(frozen=True)
class RandomRamps(RandomWaveform):
    """Straight from one evenly distributed level to the next, as a hand moves a lever.

    It starts and ends low; how long each ramp takes is evenly distributed, too, from the seed.
    """

    kind: ClassVar[str] = "random_ramps"

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        drawn, ramps = self.drawn(rng)
        levels = [self.low_kpa, *drawn[:-1].tolist(), self.low_kpa]
        edges = (start_s + np.concatenate(([0.0], np.cumsum(ramps)))).tolist()
        spans = zip(pairwise(edges), pairwise(levels), strict=True)
        return tuple(_line(*between, *ends) for between, ends in spans)


@dataclass(frozen=True)
class Multisine(Waveform):
    """Sines of the whole multiples of one frequency, of equal size, with phases from the seed.

    The sum is scaled to nearly reach the level that it comes closer to.
    """

    kind: ClassVar[str] = "multisine"
    low_kpa: Level
    high_kpa: Level
    frequency_hz: Positive
    tones: Count
    cycles: Count

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        omega = 2.0 * pi * self.frequency_hz
        phases = (2.0 * pi * rng.random(self.tones)).tolist()
        middle_kpa = 0.5 * (self.low_kpa + self.high_kpa)
        grid = np.linspace(0.0, 2.0 * pi, 50 * self.tones)
        whole = sum(np.sin((k + 1) * grid + phase) for k, phase in enumerate(phases))
        size_kpa = 0.49 * (self.high_kpa - self.low_kpa) / float(np.abs(whole).max())

        def command(time_s: float) -> float:
            angle = omega * (time_s - start_s)
            tones = (sin((k + 1) * angle + phase) for k, phase in enumerate(phases))
            return middle_kpa + size_kpa * sum(tones)

        return (Piece(start_s, start_s + self.cycles / self.frequency_hz, command),)


@dataclass(frozen=True)
class Sequence(Waveform):
    """Other kinds, one after the other."""

    kind: ClassVar[str] = "sequence"
    parts: tuple[Waveform, ...]

    def pieces(self, start_s: float, rng: np.random.Generator) -> tuple[Piece, ...]:
        """See `Waveform.pieces`."""
        found: list[Piece] = []
        for part in self.parts:
            found.extend(part.pieces(found[-1].stop_s if found else start_s, rng))
        return tuple(found)


WAVEFORMS: dict[str, type[Waveform]] = {
    kind.kind: kind
    for kind in (
        Hold,
        Rest,
        Steps,
        Staircase,
        Square,
        Sine,
        Triangle,
        Sweep,
        Chirp,
        RandomLevels,
        RandomRamps,
        Multisine,
        Sequence,
    )
}


def read_waveform(table: object, *, where: str) -> Waveform:
    """Read the ``[excitation]`` table, or one part of a sequence.

    Raises
    ------
    InputError
        An unknown kind, or a key that is missing, unknown, of another type or out of range.

    Examples
    --------
    >>> read_waveform({"kind": "rest", "duration_s": 2}, where="a.toml, [excitation]")
    Rest(duration_s=2.0)
    """
    given = dict(require_table(table, where=where))
    kind = given.pop("kind", None)
    if not isinstance(kind, str) or kind not in WAVEFORMS:
        raise InputError(
            "the kind of excitation is unknown" if kind is not None else "the key kind is missing",
            where=where,
            value=kind,
            remedy=f"choose kind from {', '.join(WAVEFORMS)}",
        )
    if kind != Sequence.kind:
        return read_record(WAVEFORMS[kind], given, where=where)
    parts = given.pop("parts", None)
    if not isinstance(parts, list) or not parts:
        raise InputError(
            "a sequence has no parts", where=where, remedy="add [[excitation.parts]] tables"
        )
    read = tuple(read_waveform(p, where=f"{where}, part {k + 1}") for k, p in enumerate(parts))
    return read_record(Sequence, given, where=where, known={"parts": read})
