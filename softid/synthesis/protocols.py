"""Protocols: what is commanded while a log is recorded, and while its hold-out is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from softid.errors import entry_named
from softid.synthesis.waveforms import (
    Chirp,
    Hold,
    Multisine,
    RandomLevels,
    RandomRamps,
    Rest,
    Sequence,
    Sine,
    Staircase,
    Steps,
    Triangle,
    Waveform,
)


@dataclass(frozen=True)
class Protocol:
    """Excitations of a pair of logs, for a highest pressure.

    Attributes
    ----------
    title
        One line for people.
    train, hold_out
        Highest pressure in kPa → parts of the command, one after the other.
    """

    title: str
    train: Callable[[float], tuple[Waveform, ...]]
    hold_out: Callable[[float], tuple[Waveform, ...]]

    def excitation(self, top_kpa: float, *, hold_out: bool, rest_s: float = 0.0) -> Waveform:
        """The command.

        Parameters
        ----------
        top_kpa
            Highest pressure.
        hold_out
            Whether that of the hold-out is wanted.
        rest_s
            Rest added at the end, for an estimate of the noise.
        """
        parts = (self.hold_out if hold_out else self.train)(top_kpa)
        return Sequence((*parts, Rest(rest_s)) if rest_s > 0.0 else parts)


def _rich(top: float) -> tuple[Waveform, ...]:
    return (
        Staircase(0.0, top, steps=4, hold_s=1.5, back=True),
        Sine(0.0, top, frequency_hz=0.5, cycles=4.0),
        Chirp(0.2 * top, 0.8 * top, first_hz=0.1, last_hz=4.0, duration_s=12.0),
        Hold(0.7 * top, 8.0),
        Rest(6.5),
    )


def _rich_hold_out(top: float) -> tuple[Waveform, ...]:
    return (
        Sine(0.05 * top, 0.95 * top, frequency_hz=0.25, cycles=3.0),
        RandomLevels(0.05 * top, 0.95 * top, count=10, shortest_s=1.2, longest_s=1.2),
    )


def _paper(top: float) -> tuple[Waveform, ...]:
    levels = tuple(share * top for share in (0.0, 0.4, 0.8, 0.6, 1.0, 0.3, 0.0))
    return (Steps(levels, 2.0), Sine(0.0, top, frequency_hz=0.5, cycles=5.0))


def _levels(top: float) -> tuple[Waveform, ...]:
    return (
        Rest(2.0),
        RandomLevels(0.0, top, count=40, shortest_s=0.3, longest_s=2.0),
        Rest(3.0),
    )


def _lever(top: float) -> tuple[Waveform, ...]:
    return (
        Rest(2.0),
        RandomRamps(0.0, top, count=45, shortest_s=0.3, longest_s=2.0),
        Rest(3.0),
    )


def _triangles(top: float) -> tuple[Waveform, ...]:
    return (
        Triangle(0.0, top, period_s=12.0, cycles=2),
        Triangle(0.0, 0.7 * top, period_s=4.0, cycles=3),
        Triangle(0.2 * top, top, period_s=1.2, cycles=8),
        Rest(6.0),
    )


def _multisine(top: float) -> tuple[Waveform, ...]:
    return (
        Multisine(0.0, top, frequency_hz=0.1, tones=25, cycles=4),
        Hold(0.6 * top, 6.0),
        Rest(6.0),
    )


def _mixed_hold_out(top: float) -> tuple[Waveform, ...]:
    return (
        RandomLevels(0.05 * top, 0.95 * top, count=8, shortest_s=0.5, longest_s=2.0),
        RandomRamps(0.0, 0.95 * top, count=14, shortest_s=0.4, longest_s=2.0),
    )


PROTOCOLS: dict[str, Protocol] = {
    "rich": Protocol(
        "staircase up and down, 0.5 Hz, chirp 0.1 to 4 Hz, hold, rest; 48 s", _rich, _rich_hold_out
    ),
    "paper": Protocol(
        "steps and 0.5 Hz, 24 s; hold-out 0.25 Hz",
        _paper,
        lambda top: (Sine(0.0, top, frequency_hz=0.25, cycles=4.0),),
    ),
    "levels": Protocol(
        "40 random levels, about 50 s; hold-out levels and ramps", _levels, _mixed_hold_out
    ),
    "lever": Protocol(
        "45 random ramps, about 57 s; hold-out levels and ramps", _lever, _mixed_hold_out
    ),
    "triangles": Protocol(
        "triangles of 12, 4 and 1.2 s, rest; 52 s; hold-out levels and ramps",
        _triangles,
        _mixed_hold_out,
    ),
    "multisine": Protocol(
        "25 tones of 0.1 to 2.5 Hz, hold, rest; 52 s; hold-out levels and ramps",
        _multisine,
        _mixed_hold_out,
    ),
    "sine": Protocol(
        "one sine of 0.5 Hz, 20 s; hold-out 0.25 Hz",
        lambda top: (Sine(0.0, top, frequency_hz=0.5, cycles=10.0),),
        lambda top: (Sine(0.0, top, frequency_hz=0.25, cycles=4.0),),
    ),
    "step": Protocol(
        "one step, 6 s; hold-out a lower one",
        lambda top: (Rest(1.0), Hold(0.8 * top, 5.0)),
        lambda top: (Rest(1.0), Hold(0.6 * top, 5.0)),
    ),
    "slow": Protocol(
        "a triangle of 0.04 Hz, 50 s; hold-out one of 0.02 Hz",
        lambda top: (Triangle(0.0, top, period_s=25.0, cycles=2),),
        lambda top: (Triangle(0.0, 0.9 * top, period_s=50.0, cycles=1),),
    ),
}


def protocol_named(name: str) -> Protocol:
    """The protocol of a name.

    Raises
    ------
    UsageError
        There is no such protocol.
    """
    return entry_named(name, PROTOCOLS, unknown="there is no such protocol")
