"""What a hidden effect is to the generator: laws of three stages, and an entry of the table."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import exp, log
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.synthesis.actuators import Sizes

Array = npt.NDArray[np.float64]
Stage = Literal["input", "state", "output"]
Relation = Literal["catalogue", "other_form", "outside"]
Values = Mapping[str, float]
States = Sequence[float]
Rates = tuple[float, ...]

NO_RATES: Rates = ()
JUMP_S = 0.02
"""Time within which something sudden happens: short for a log, smooth for a solver."""


class Parts:
    """Changes of the law of motion, inertia·a = drive + spring(x − shift) + damping − force.

    Attributes
    ----------
    force
        Resisting force.
    inertia, drive, spring, damping
        Factors of the terms of the law.
    shift
        Shift of the position at which the spring is at ease.
    """

    __slots__ = ("damping", "drive", "force", "inertia", "shift", "spring")

    def __init__(self) -> None:
        self.force = 0.0
        self.inertia = 1.0
        self.drive = 1.0
        self.spring = 1.0
        self.damping = 1.0
        self.shift = 0.0


def _no_start(_: float) -> Rates:
    return NO_RATES


@dataclass(frozen=True)
class InputLaw:
    """From the recorded pressure to the one that arrives.

    Attributes
    ----------
    act
        (time_s, pressure_kpa, own states) → arriving pressure in kPa, rates of the own states.
    start
        Settled pressure → own states.
    delay_s
        Pure delay before everything else.
    """

    act: Callable[[float, float, States], tuple[float, Rates]]
    start: Callable[[float], Rates] = _no_start
    delay_s: float = 0.0


@dataclass(frozen=True)
class MotionLaw:
    """A part of the equation of motion.

    Attributes
    ----------
    act
        (time_s, arriving pressure_kpa, x, v, own states, parts to change) → rates of own states.
    start
        Position at rest → own states.
    """

    act: Callable[[float, float, float, float, States, Parts], Rates]
    start: Callable[[float], Rates] = _no_start


def _same(time_s: Array, y: Array) -> Array:
    del time_s
    return y


@dataclass(frozen=True)
class OutputLaw:
    """From the motion to the reading.

    Attributes
    ----------
    read
        Readings at times, each of shape (n,) → changed readings; n is dense in time.
    follow
        None, or (reading, own states) → changed reading, rates; integrated with the motion, before
        every ``read``.
    start
        Settled reading → own states.
    clock_rate
        The motion is read at (1 + rate)·t.
    pickup
        What a kPa of the recorded pressure adds to the reading.
    afterwards
        None, or recorded times, and what was recorded with its noise, each of shape (n,) → what the
        file holds.
    """

    read: Callable[[Array, Array], Array] = _same
    follow: Callable[[float, States], tuple[float, Rates]] | None = None
    start: Callable[[float], Rates] = _no_start
    clock_rate: float = 0.0
    pickup: float = 0.0
    afterwards: Callable[[Array, Array], Array] | None = None


Law = InputLaw | MotionLaw | OutputLaw


@dataclass(frozen=True)
class Occasion:
    """One recording.

    Attributes
    ----------
    duration_s
        Its length.
    seed
        Of what is random in this recording alone.
    later
        Whether it was recorded after another one, so that what breaks once is broken already.
    """

    duration_s: float
    seed: int
    later: bool = False


@dataclass(frozen=True)
class Hidden:
    """An effect that can be hidden in a log.

    Attributes
    ----------
    name
        As in the catalogue of effects where it is one of them.
    stage
        Where it acts.
    relation
        A law of the catalogue, another form of such a law, or none of them.
    names
        Effects of the catalogue that name it rightly; empty for one outside.
    law
        The law in one line.
    units
        Parameter → unit, in which {x} and {f} stand for the units of position and force.
    draw
        (sizes, generator, size) → parameters; size 1 is moderate.
    build
        (parameters, sizes, occasion) → law.
    """

    name: str
    stage: Stage
    relation: Relation
    names: tuple[str, ...]
    law: str
    units: Mapping[str, str]
    draw: Callable[[Sizes, np.random.Generator, float], dict[str, float]]
    build: Callable[[Values, Sizes, Occasion], Law]

    def units_for(self, sizes: Sizes) -> dict[str, str]:
        """Unit of each parameter for an actuator.

        Parameters
        ----------
        sizes
            Those of the actuator.
        """
        told = {k: u.format(x=sizes.x_unit, f=sizes.force_unit) for k, u in self.units.items()}
        return {k: u.removeprefix("1·") for k, u in told.items()}  # a number is no factor


def entry(
    name: str,
    stage: Stage,
    law: str,
    units: str,
    draw: Callable[[Sizes, np.random.Generator, float], dict[str, float]],
    build: Callable[[Values, Sizes, Occasion], Law],
    *,
    relation: Relation = "catalogue",
    names: tuple[str, ...] = (),
) -> Hidden:
    """An entry from units written as ``"tau s, ratio 1"``; see `Hidden` for the arguments."""
    pairs = [part.split() for part in units.split(", ")]
    if relation == "catalogue":
        names = (name.partition(".")[0],)
    found = {pair[0]: pair[1] for pair in pairs}
    return Hidden(name, stage, relation, names, law, found, draw, build)


def about(rng: np.random.Generator, value: float) -> float:
    """A value within a factor of 1.4 either way.

    Parameters
    ----------
    rng
        Generator to draw from.
    value
        Middle of the range.
    """
    return value * exp(rng.uniform(-log(1.4), log(1.4)))


def between(rng: np.random.Generator, low: float, high: float) -> float:
    """A positive value, its logarithm evenly distributed.

    Parameters
    ----------
    rng
        Generator to draw from.
    low, high
        Ends of the range.
    """
    return exp(rng.uniform(log(low), log(high)))


def either(rng: np.random.Generator) -> float:
    """+1 or −1.

    Parameters
    ----------
    rng
        Generator to draw from.
    """
    return 1.0 if rng.random() < 0.5 else -1.0


def passed(time_s: float, event_s: float) -> float:
    """0 before an event and 1 after it, smooth within `JUMP_S`.

    Parameters
    ----------
    time_s
        Now.
    event_s
        Beginning of the event.
    """
    share = min(max((time_s - event_s) / JUMP_S, 0.0), 1.0)
    return share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
