"""Pneumatic lag: the actuator fills and vents in a time of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import InputEffect, Scale
from softid.effects.time_constants import lag_bounds, lag_times
from softid.kernels.filters import lag
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

RATIOS = (0.4, 2.5)


@dataclass(frozen=True)
class PneumaticLag(InputEffect):
    """First-order lag of the pressure, τ ṗa + pa = p, exact for a straight input."""

    name: ClassVar[str] = "pneumatic_lag"
    title: ClassVar[str] = "Lag of the pneumatics"
    law: ClassVar[str] = "tau pa' + pa = p"
    meaning: ClassVar[str] = (
        "The pressure in the actuator follows the recorded one exponentially, because air has to "
        "flow through a tube or a valve to fill and vent it."
    )
    signature: ClassVar[str] = (
        "The residual is a pulse after every change of the input that dies out in the same time at "
        "every level."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("delay", "sensor_lag", "valve_flow", "line_resonance")
    remedy: ClassVar[str] = (
        "record the pressure inside the actuator, shorten or widen the tube, use a larger valve"
    )
    shown_by: ClassVar[str] = "a chirp up to the bandwidth of the actuator"
    source: ClassVar[str] = "Andersen, The Analysis and Design of Pneumatic Systems, Wiley 1967"
    amplitude: ClassVar[str] = "tau"

    def parameters(self, scale: Scale) -> ParameterSet:
        """The time constant τ, up to a quarter of the log."""
        shortest, longest = lag_bounds(scale)
        return ParameterSet(
            (
                Parameter(
                    "tau",
                    lag_times(scale)[1],
                    "s",
                    shortest,
                    longest,
                    "log",
                    meaning="time constant with which the pressure follows",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """From two samples to the motion's own time."""
        return tuple({"tau": tau} for tau in lag_times(scale))

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The lagged input."""
        del scale
        arriving = np.array(u, np.float64)
        lag(np.diff(time_s), arriving, float(eta[0]), float(eta[0]))
        return arriving


@dataclass(frozen=True)
class SeparatePneumaticLag(PneumaticLag):
    """First-order lag with one time constant while pa < p and another while pa > p.

    The sign of p − pa decides, and where it changes between two times the instant is found
    exactly.
    """

    variant: ClassVar[str] = "separate"
    title: ClassVar[str] = "Lag of the pneumatics that differs by direction"
    law: ClassVar[str] = "tau pa' + pa = p while filling, ratio tau pa' + pa = p while venting"
    meaning: ClassVar[str] = (
        "The actuator fills in another time than it vents, because the air takes different ways or "
        "different pressure differences drive it."
    )
    signature: ClassVar[str] = (
        "The residual is a pulse after every change of the input that dies out in one time on the "
        "way up and in another on the way down."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("valve_flow", "asymmetric_damping", "delay")
    remedy: ClassVar[str] = (
        "record the pressure inside the actuator, or vent through a wider way than the filling one"
    )
    shown_by: ClassVar[str] = "steps up and down between the same levels"
    plain_at: ClassVar[tuple[str, float] | None] = ("ratio", 1.0)

    def parameters(self, scale: Scale) -> ParameterSet:
        """The time constant of filling, and that of venting as a multiple of it."""
        (tau,) = super().parameters(scale).values()
        filling = replace(tau, meaning="time constant of filling")
        ratio = Parameter(
            "ratio",
            RATIOS[1],
            "1",
            0.05,
            20.0,
            "log",
            meaning="time constant of venting over that of filling",
            source=self.source,
        )
        return ParameterSet((filling, ratio))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Two times, each with faster and with slower venting."""
        times = lag_times(scale)[1:]
        return tuple({"tau": tau, "ratio": ratio} for tau in times for ratio in RATIOS)

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The input lagged by the time constant of its direction."""
        del scale
        arriving = np.array(u, np.float64)
        lag(np.diff(time_s), arriving, float(eta[0]), float(eta[0] * eta[1]))
        return arriving
