"""Laws in no catalogue, for which a cause of the catalogue may stand.

They are in no race: beside every other effect they would make ties of what a log tells apart.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.diagnosis.verdict.unlisted_curves import (
    FineCurve,
    FreeSpring,
    PowerSpring,
    PressureStiffness,
)
from softid.diagnosis.verdict.unlisted_drifts import (
    DampingDrift,
    LoadDrift,
    PressureDrift,
    PressureGainDrift,
    RecoveringSoftening,
    SettlingGain,
    SettlingPressure,
    SettlingStiffness,
    one_parameter,
)
from softid.diagnosis.verdict.unlisted_loads import SwingingLoad
from softid.diagnosis.verdict.unlisted_memories import (
    OwnBranches,
    PositionHysteresis,
    ReadingHysteresis,
    SecondCreep,
    SecondHysteresis,
)
from softid.diagnosis.verdict.unlisted_pneumatics import (
    InputLimit,
    RateLimit,
    ReliefLeak,
    UnevenDelay,
)
from softid.diagnosis.verdict.unlisted_positions import (
    PositionDamping,
    PositionFriction,
    PositionInertia,
)
from softid.diagnosis.verdict.unlisted_readings import (
    EarlyReading,
    Feedthrough,
    LateGauge,
    SmoothedInput,
    SwingingPart,
    UnevenReading,
)
from softid.effects.base import Effect, InputEffect, OutputEffect, StateEffect
from softid.effects.scale import Scale
from softid.kernels.way_memory import play
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

MOST_BENT = 0.9
"""Bound of what a bend adds to the slope of a reading at the ends of its range: it still rises."""

START_BENT = 0.03
"""Start of the first bend, either way, as a share of the range."""

MOST_PLAY, START_PLAY = 0.6, (0.04, 0.16)
"""Bound and starts of a play, as a share of the range."""

START_SIDES = (0.0, -0.8, 0.8)
"""Starts of the side of a play on which a log begins; at its very end it could move but one way."""


@dataclass(frozen=True)
class BentReading(OutputEffect):
    """A nonlinear sensor, y + y_span Σ bₖ sin(kπξ), k from 1 to 3.

    ξ is y within its range, from 0 to 1: the ends stay, for the model takes up zero and gain.
    """

    name: ClassVar[str] = "bent_reading"
    title: ClassVar[str] = "Nonlinear sensor"
    law: ClassVar[str] = (
        "recorded y = x + y_span (b1 sin(pi xi) + b2 sin(2 pi xi) + b3 sin(3 pi xi)), xi x within "
        "the range of y"
    )
    meaning: ClassVar[str] = (
        "The gain of the sensor differs from one end of its range to the other."
    )
    signature: ClassVar[str] = "The residual is a function of the position, at rest and in motion."
    shown_by: ClassVar[str] = "the sensor beside another one, by hand"
    source: ClassVar[str] = "Doebelin, Measurement Systems, 5th ed. 2004, §3.2"
    amplitude: ClassVar[str] = "b1"
    changes_sign: ClassVar[bool] = True

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """All vanish together."""
        return ("b1", "b2", "b3")

    def parameters(self, scale: Scale) -> ParameterSet:
        """The waves; each alone leaves a reading that still rises."""
        del scale

        def wave(k: int, name: str) -> Parameter:
            bound = MOST_BENT / (k * np.pi)
            return Parameter(
                name, 0.0, "1", -bound, bound, meaning="share of the range", source=self.source
            )

        return ParameterSet(tuple(wave(k, name) for k, name in enumerate(self.amplitudes, 1)))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Two starts: the reading bends to either side."""
        del scale
        straight = dict.fromkeys(self.amplitudes, 0.0)
        return tuple({**straight, "b1": bend} for bend in (START_BENT, -START_BENT))

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Bend the reading between the ends of its range."""
        del time_s
        phase = np.pi * (y - scale.y_low) / scale.y_span
        waves = sum(eta[k] * np.sin((k + 1) * phase) for k in range(len(self.amplitudes)))
        recorded: Array = y + scale.y_span * waves
        return recorded


@dataclass(frozen=True)
class Play(Effect):
    """Play of the width w, from one side to the other, as a share of the range.

    A log that begins in motion, or after one, begins on a side of the play.
    """

    law: ClassVar[str] = "it follows only when it is w/2 away, and begins side w/2 away"
    shown_by: ClassVar[str] = "small moves up and down"
    signature: ClassVar[str] = "The residual is flat for a while after every turn."
    source: ClassVar[str] = "Tao and Kokotović, Adaptive Control of Systems, Wiley 1996"
    amplitude: ClassVar[str] = "w"
    plain_at: ClassVar[tuple[str, float] | None] = ("side", 0.0)

    def parameters(self, scale: Scale) -> ParameterSet:
        """The width as a share of the range, and the side."""
        del scale
        width = one_parameter("w", START_PLAY[0], "1", 0.0, MOST_PLAY, "the play", self.source)
        side = one_parameter(
            "side", 0.0, "1", -1.0, 1.0, "its lead as a log begins, in halves of w", self.source
        )
        return ParameterSet((*width.values(), *side.values()))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Small and large, in the middle and on either side."""
        del scale
        return tuple({"w": width, "side": side} for width in START_PLAY for side in START_SIDES)


@dataclass(frozen=True)
class InputPlay(Play, InputEffect):
    """Play before the actuator."""

    name: ClassVar[str] = "input_play"
    title: ClassVar[str] = "Play of the valve or the regulator"
    meaning: ClassVar[str] = "The pressure follows only when it has to move a little way."
    remedy: ClassVar[str] = "the pressure at the actuator itself, in small moves up and down"

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The input with play."""
        del time_s
        arriving = np.array(u, np.float64)
        play(arriving, 0.5 * max(float(eta[0]), 0.0) * scale.u_span, float(eta[1]))
        return arriving


@dataclass(frozen=True)
class OutputPlay(Play, OutputEffect):
    """Play behind the actuator."""

    name: ClassVar[str] = "output_play"
    title: ClassVar[str] = "Play between actuator and sensor"
    meaning: ClassVar[str] = "The sensor follows only when the actuator has moved a little way."
    remedy: ClassVar[str] = "the sensor beside another one, in small moves up and down"

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """The reading with play."""
        del time_s
        recorded = np.array(y, np.float64)
        play(recorded, 0.5 * max(float(eta[0]), 0.0) * scale.y_span, float(eta[1]))
        return recorded


Law = StateEffect | InputEffect | OutputEffect

UNLISTED_LAWS: tuple[type[Law], ...] = (
    LoadDrift,
    PressureGainDrift,
    PressureDrift,
    SettlingPressure,
    RateLimit,
    InputLimit,
    ReliefLeak,
    UnevenDelay,
    BentReading,
    DampingDrift,
    SettlingStiffness,
    SettlingGain,
    RecoveringSoftening,
    PositionDamping,
    PositionInertia,
    PowerSpring,
    FreeSpring,
    FineCurve,
    PressureStiffness,
    EarlyReading,
    LateGauge,
    SmoothedInput,
    UnevenReading,
    Feedthrough,
    SwingingPart,
    SwingingLoad,
    InputPlay,
    OutputPlay,
    ReadingHysteresis,
)
"""All laws of no catalogue that may stand in the place of all causes."""

LAWS_BESIDE: tuple[type[Law], ...] = (
    SecondCreep,
    SecondHysteresis,
    OwnBranches,
    PositionFriction,
    PositionHysteresis,
)
"""Laws of no catalogue that only stand beside a cause, or in the place of one."""

NEAR_ONE = (ReliefLeak, UnevenDelay, UnevenReading, SwingingPart, SwingingLoad, OwnBranches)
"""Laws of no catalogue that a single cause may do as well: a leak may be next to none, and is a lag
then, a valve or a sensor may be late up and down alike, what swings fast enough is late as a lag
is, and logs may all begin on one branch."""

NEAR_TWO = (PowerSpring, FreeSpring, FineCurve, ReliefLeak)
"""Laws of no catalogue that two causes may do as well: a spring of any shape may be one that
stiffens up to a wall, a curve at rest one with a dead zone, and a leak a lag and a curve."""

BEYOND_ONE = tuple(law for law in UNLISTED_LAWS if law not in NEAR_ONE)
"""Laws of no catalogue that no single cause can do as well, but for the plain shapes of a curve."""

OF_LINEAR = (PressureStiffness,)
"""Laws that a model which is not linear has itself, or makes up for; their remedy is that model."""


def suiting(laws: Sequence[type[Law]], *, is_linear: bool) -> tuple[type[Law], ...]:
    """Those of some laws that a base can be told from.

    Parameters
    ----------
    laws
        Laws in no catalogue.
    is_linear
        Whether the base is linear.
    """
    return tuple(law for law in laws if is_linear or law not in OF_LINEAR)
