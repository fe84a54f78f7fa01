"""Changes of an actuator and its rig that would be parameters of a model if no log differed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import Effect, InputEffect, OutputEffect, StateEffect
from softid.effects.scale import Scale
from softid.kernels.terms import DAMPING, FORCE, STIFFNESS
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

LARGEST_DIFFERENCE = 0.6
"""Bound of a difference as a share of what it changes."""

LATEST_S = 0.5
"""Bound of a delay, either way."""

SETTLES_IN = 0.25
"""Time constant with which the reading of a sensor that warms up settles, as a share of the longest
log: what is twice as fast or slow leaves a tenth of it."""


@dataclass(frozen=True)
class Probe(Effect):
    """Changes that would be parameters of the model if all logs had them alike."""

    law: ClassVar[str] = "one size for each log"
    meaning: ClassVar[str] = "Something was changed between the logs."
    signature: ClassVar[str] = "The residual differs from log to log."
    shown_by: ClassVar[str] = "the same path before and after"
    source: ClassVar[str] = "a constant"
    amplitude: ClassVar[str | None] = None
    kinds: ClassVar[Mapping[str, tuple[str, float]]]

    def parameters(self, scale: Scale) -> ParameterSet:
        """Sizes of the changes, with bounds that are symmetric about zero."""
        del scale
        return ParameterSet(
            tuple(
                Parameter(kind, 0.0, unit, -bound, bound, meaning=self.meaning, source=self.source)
                for kind, (unit, bound) in self.kinds.items()
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """One start, at which nothing is changed."""
        del scale
        return (dict.fromkeys(self.kinds, 0.0),)


@dataclass(frozen=True)
class MotionProbe(Probe, StateEffect):
    """Relative change of stiffness and damping, and a resisting force as a share of the range's.

    Attributes
    ----------
    begins_s
        The time of a log from which on the force resists; at the start without one.
    """

    begins_s: float = -np.inf
    name: ClassVar[str] = "motion_probe"
    title: ClassVar[str] = "Change in the motion"
    kinds: ClassVar[Mapping[str, tuple[str, float]]] = {
        "load": ("1", LARGEST_DIFFERENCE),
        "stiffness": ("1", LARGEST_DIFFERENCE),
        "damping": ("1", LARGEST_DIFFERENCE),
    }

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """The elastic force within the log, and when the load begins."""
        return scale.force, self.begins_s

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Put all three into the equation of motion."""
        if t > eta[4]:
            out[FORCE] += eta[0] * eta[3]
        out[STIFFNESS] += eta[1]
        out[DAMPING] += eta[2]


@dataclass(frozen=True)
class InputProbe(Probe, InputEffect):
    """Another gain and zero of the input."""

    name: ClassVar[str] = "input_probe"
    title: ClassVar[str] = "Change of the input"
    kinds: ClassVar[Mapping[str, tuple[str, float]]] = {
        "pressure_gain": ("1", LARGEST_DIFFERENCE),
        "pressure_zero": ("1", LARGEST_DIFFERENCE),
    }

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """Gain, and a zero as a share of the range."""
        del time_s
        arriving: Array = u * (1.0 + eta[0]) + eta[1] * scale.u_span
        return arriving


@dataclass(frozen=True)
class ReadingProbe(Probe, OutputEffect):
    """Another gain of the output, a clock that is late against that of the input, and a drift.

    A drift goes on evenly or settles; both are shares of the range over the longest log.
    """

    name: ClassVar[str] = "reading_probe"
    title: ClassVar[str] = "Change of the reading"
    kinds: ClassVar[Mapping[str, tuple[str, float]]] = {
        "gain": ("1", LARGEST_DIFFERENCE),
        "delay": ("s", LATEST_S),
        "drift": ("1", LARGEST_DIFFERENCE),
        "settling_drift": ("1", LARGEST_DIFFERENCE),
    }

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """Gain, delay and drifts."""
        part = time_s / scale.duration_s
        drift = eta[2] * part - eta[3] * np.expm1(-part / SETTLES_IN)
        recorded: Array = np.interp(time_s - eta[1], time_s, y) * (1.0 + eta[0])
        recorded += drift * scale.y_span
        return recorded


PROBES: tuple[type[MotionProbe | InputProbe | ReadingProbe], ...] = (
    MotionProbe,
    ReadingProbe,
    InputProbe,
)
"""Laws of the differences between logs that are neither a zero nor a parameter of the model; of two
that are the same on some logs the first stands for both."""
