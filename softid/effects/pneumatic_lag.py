"""Pneumatic lag: the pressure in the actuator follows the recorded one as a first-order lag."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import InputEffect
from softid.effects.scale import Scale
from softid.effects.shared_laws.time_constants import lag_time, lag_times
from softid.kernels.filters import lag, lag_by_level
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

RATIOS = (0.4, 2.5)
"""Ratios of two time constants at which a search begins, either way."""

RATIO_BOUNDS = (0.05, 20.0)
"""Bounds of such a ratio: with one time so much shorter than the other, the shorter one is none."""


@dataclass(frozen=True)
class PneumaticLag(InputEffect):
    """First-order lag of the pressure, τ ṗa + pa = p, exact for a straight input.

    Source: Andersen, *The Analysis and Design of Pneumatic Systems*, Wiley 1967.
    """

    name: ClassVar[str] = "pneumatic_lag"
    title: ClassVar[str] = "Lag of the pneumatics"
    law: ClassVar[str] = "tau pa' + pa = p"
    meaning: ClassVar[str] = (
        "The pressure in the actuator follows the recorded one exponentially, because air has to "
        "flow through a tube or a valve to fill and vent it."
    )
    signature: ClassVar[str] = (
        "After every change of the input the residual has a pulse, which decays in the same time "
        "at every level."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("delay", "sensor_lag", "valve_flow", "line_resonance")
    remedy: ClassVar[str] = (
        "record the pressure inside the actuator, shorten or widen the tube, use a larger valve"
    )
    shown_by: ClassVar[str] = "a chirp up to the bandwidth of the actuator"
    source: ClassVar[str] = "Andersen, The Analysis and Design of Pneumatic Systems, Wiley 1967"
    amplitude: ClassVar[str] = "tau"
    is_linear: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The time constant τ, up to a quarter of the log."""
        meaning = "time constant with which the pressure follows"
        return ParameterSet((lag_time(scale, meaning, self.source),))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """From two samples to the motion's own time."""
        return tuple({"tau": tau} for tau in lag_times(scale))

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The lagged input."""
        del scale
        arriving = np.array(u, np.float64)
        lag(np.diff(time_s), arriving, float(eta[0]), float(eta[0]))
        return arriving

    def bends_in_s(self, eta: Array) -> float:
        """The time constant."""
        return float(eta[0])


@dataclass(frozen=True)
class SeparatePneumaticLag(PneumaticLag):
    """First-order lag with one time constant while pa < p and another while pa > p.

    The sign of p − pa decides, and where it changes between two times the instant is found
    exactly. A supply that sags by s of what it fills and recovers in a time T is such a lag,
    T ṗa + s T max(ṗa, 0) + pa = p: τ = (1 + s) T while filling, T while venting.

    Source: Andersen, *The Analysis and Design of Pneumatic Systems*, Wiley 1967.
    """

    variant: ClassVar[str] = "separate"
    is_linear: ClassVar[bool] = False
    title: ClassVar[str] = "Lag of the pneumatics that differs by direction"
    law: ClassVar[str] = "tau pa' + pa = p while filling, ratio tau pa' + pa = p while venting"
    meaning: ClassVar[str] = (
        "Filling and venting take different times, because the air takes different paths, is "
        "driven by different pressure differences, or a small supply sags during filling."
    )
    signature: ClassVar[str] = (
        "After every change of the input the residual has a pulse, which decays in one time on the "
        "way up and in another on the way down."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("valve_flow", "asymmetric_damping", "delay")
    remedy: ClassVar[str] = (
        "record the pressure inside the actuator and at the supply, use a larger reservoir, or "
        "vent through a separate path"
    )
    shown_by: ClassVar[str] = "steps up and down between the same levels"
    essential: ClassVar[tuple[str, ...]] = ("ratio",)
    plain_at: ClassVar[tuple[str, float] | None] = ("ratio", 1.0)

    def parameters(self, scale: Scale) -> ParameterSet:
        """The time constant of filling, and that of venting as a multiple of it."""
        (tau,) = super().parameters(scale).values()
        filling = replace(tau, meaning="time constant of filling")
        ratio = ratio_of_times("time constant of venting over that of filling", self.source)
        return ParameterSet((filling, ratio))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Two times, each with faster and with slower venting."""
        return _starts_either_way(scale)

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The input lagged by the time constant of its direction."""
        del scale
        arriving = np.array(u, np.float64)
        lag(np.diff(time_s), arriving, float(eta[0]), float(eta[0] * eta[1]))
        return arriving

    def differs_within(self, values: Mapping[str, float]) -> float:
        """By how much the two times differ."""
        return values["tau"] * abs(values["ratio"] - 1.0)

    def bends_in_s(self, eta: Array) -> float:
        """The shorter time constant; where one takes over from the other nothing moves."""
        return float(eta[0] * min(eta[1], 1.0))


@dataclass(frozen=True)
class LevelPneumaticLag(PneumaticLag):
    r"""First-order lag whose time constant depends on the pressure in the actuator.

        τ(pa) ṗa + pa = p,   τ(pa) = τ ρ^((pa − p_m)/(p_h − p_l))

    with p_l and p_h the lowest and the highest recorded pressure and p_m half way between them,
    where the time constant is τ: so τ is that of the plain lag, whatever the ratio ρ. A chamber or
    a tube that swells takes longer the fuller it is, air in a line that is driven by a liquid
    shorter, for it is compressed.

    Source: Andersen, *The Analysis and Design of Pneumatic Systems*, Wiley 1967.
    """

    variant: ClassVar[str] = "level"
    is_linear: ClassVar[bool] = False
    title: ClassVar[str] = "Lag of the pneumatics that differs by level"
    law: ClassVar[str] = (
        "tau ratio^((pa - pm)/(ph - pl)) pa' + pa = p, pl lowest, ph highest, pm middle of p"
    )
    meaning: ClassVar[str] = (
        "The actuator fills and vents at a rate that depends on its pressure, because its chamber "
        "and tube swell, or because the air in it is compressed."
    )
    signature: ClassVar[str] = (
        "After every change of the input the residual has a pulse, which decays in one time at low "
        "pressures and in another at high ones, both upward and downward."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("valve_flow", "delay", "sensor_lag")
    shown_by: ClassVar[str] = "steps of one size, up and down, at several levels"
    essential: ClassVar[tuple[str, ...]] = ("ratio",)
    plain_at: ClassVar[tuple[str, float] | None] = ("ratio", 1.0)

    def parameters(self, scale: Scale) -> ParameterSet:
        """The time constant in the middle, and that at the highest over that at the lowest."""
        (tau,) = super().parameters(scale).values()
        ratio = ratio_of_times(
            "time constant at the highest pressure over that at the lowest", self.source
        )
        middle = replace(tau, meaning="time constant half way between the pressures' ends")
        return ParameterSet((middle, ratio))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Two times, growing and shrinking with the pressure."""
        return _starts_either_way(scale)

    def law_at(self, scale: Scale) -> str:
        """With the ends of the pressure."""
        ends = f"pl = {scale.u_low:.5g}, ph = {scale.u_high:.5g} {scale.u_unit}, pm half way"
        return self.law.replace("pl lowest, ph highest, pm middle of p", ends)

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The input lagged by the time constant of its level."""
        arriving = np.array(u, np.float64)
        growth = float(np.log(eta[1])) / scale.u_span
        middle = 0.5 * (scale.u_low + scale.u_high)
        lag_by_level(np.diff(time_s), arriving, float(eta[0]), growth, middle)
        return arriving

    def differs_within(self, values: Mapping[str, float]) -> float:
        """By how much the times at the ends of the pressures differ."""
        return values["tau"] * abs(values["ratio"] - 1.0) / math.sqrt(values["ratio"])

    def bends_in_s(self, eta: Array) -> float:
        """The time constant at that end of the pressures where it is shortest."""
        return float(eta[0] * min(eta[1], 1.0 / eta[1]) ** 0.5)


def ratio_of_times(meaning: str, source: str) -> Parameter:
    """The ratio of two times of which none is much longer than the other.

    Parameters
    ----------
    meaning, source
        Of which two, and where that is found.
    """
    return Parameter("ratio", RATIOS[1], "1", *RATIO_BOUNDS, "log", meaning=meaning, source=source)


def _starts_either_way(scale: Scale) -> tuple[Mapping[str, float], ...]:
    """Two times, each with either of `RATIOS`."""
    times = lag_times(scale)[1:]
    return tuple({"tau": tau, "ratio": ratio} for tau in times for ratio in RATIOS)
