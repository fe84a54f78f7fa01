"""Creep: part of the material keeps yielding after the motion has settled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import LEAST_AMPLITUDE, OutputEffect, StateEffect
from softid.effects.scale import Scale
from softid.effects.time_constants import SETTLING_PERIODS, start_times, time_bounds
from softid.kernels.filters import lag
from softid.kernels.terms import FORCE, RATE
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

SHARE = 0.2
"""Start of the stiffness that relaxes, in those of the actuator."""

STIFFEST = 30.0
"""Largest stiffness that relaxes, in those of the actuator: a thirtieth of what a sudden force
meets is then left at rest."""

LONGEST_SHARE = 1.0
"""Longest relaxation as a share of the log: one that takes longer is a drift in it."""

TIMES = (0.03, 0.1, 0.3)
"""Starts of the time, as shares of the log."""

SERIES_SHARE = 0.1
"""Start of the share by which a reading creeps on."""

SERIES_SHARES = (1e-4, 3.0)
"""Bounds of that share: less is lost in any noise, and what creeps three times as far as it jumped
did not settle at all."""


@dataclass(frozen=True)
class Creep(StateEffect):
    r"""Creep of a standard linear solid, + k (x − z) with τ ż = x − z.

    A second spring stands in series with a damper beside the first: a fast motion feels both
    springs, and after a time τ only the first is left.

    Source: standard linear solid (Zener); Christensen, *Theory of Viscoelasticity*, §1.
    """

    name: ClassVar[str] = "creep"
    title: ClassVar[str] = "Creep of the material"
    law: ClassVar[str] = "+ k (x - z),  tau z' = x - z"
    meaning: ClassVar[str] = (
        "After a change the actuator settles quickly to most of its new position and then creeps "
        "on for seconds or minutes, because part of its elastic force relaxes."
    )
    signature: ClassVar[str] = (
        "The residual decays exponentially after every change of level. Its size is proportional "
        "to the change, and its time constant is the same at every level and in both directions."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("sensor_warmup", "hysteresis", "sensor_drift")
    remedy: ClassVar[str] = "precondition the actuator, or use a less viscoelastic elastomer"
    shown_by: ClassVar[str] = "a hold of 20 s followed by a rest of 20 s"
    source: ClassVar[str] = "Christensen, Theory of Viscoelasticity, 1 (standard linear solid)"
    amplitude: ClassVar[str] = "k"
    essential: ClassVar[tuple[str, ...]] = ("tau",)
    has_state: ClassVar[bool] = True
    follows_position: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """Stiffness k that relaxes, and the time τ in which it does."""
        stiffness = scale.force / scale.x_span
        shortest, longest = time_bounds(scale, periods=SETTLING_PERIODS, share=LONGEST_SHARE)
        return ParameterSet(
            (
                Parameter(
                    "k",
                    SHARE * stiffness,
                    f"{scale.force_unit}/{scale.x_unit}",
                    LEAST_AMPLITUDE * stiffness,
                    STIFFEST * stiffness,
                    "log",
                    meaning="part of the stiffness that relaxes",
                    source=self.source,
                ),
                Parameter(
                    "tau",
                    (shortest * longest) ** 0.5,
                    "s",
                    shortest,
                    longest,
                    "log",
                    meaning="relaxation time",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Times from a thirtieth to a third of the log."""
        declared = self.parameters(scale)
        times = start_times(declared["tau"], scale, TIMES)
        return tuple({"k": declared["k"].value, "tau": tau} for tau in times)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force k (x − z), and ż = (x − z)/τ."""
        out[FORCE] += eta[0] * (x - z)
        out[RATE] += (x - z) / eta[1]


@dataclass(frozen=True)
class SeriesCreep(OutputEffect):
    r"""Creep by the same share of every deflection, y = x + c z with τ ż + z = x.

    A spring and a damper side by side stand in series with the actuator (Kelvin and Voigt), or a
    strain sensor creeps. In an actuator whose stiffness does not depend on the pressure it is
    nearly the creep of a standard linear solid; in others that one creeps less where they are
    stiff.

    Source: Kelvin–Voigt element of Burgers' model; Christensen, *Theory of Viscoelasticity*, §1.
    """

    name: ClassVar[str] = "creep"
    variant: ClassVar[str] = "series"
    title: ClassVar[str] = "Creep in proportion to the deflection"
    law: ClassVar[str] = "y = x + c z,  tau z' + z = x"
    meaning: ClassVar[str] = (
        "After a change the reading settles quickly to most of its new value and then creeps on "
        "for seconds or minutes, by a fraction of the change that is the same at every pressure, "
        "because the body, or a strain sensor on it, keeps yielding."
    )
    signature: ClassVar[str] = (
        "After every change of level the residual approaches, exponentially, a fixed fraction of "
        "the change of deflection, with one time constant at every level and in both directions."
    )
    neighbours: ClassVar[tuple[str, ...]] = Creep.neighbours
    remedy: ClassVar[str] = (
        "precondition the actuator, use a less viscoelastic elastomer, or a sensor that does not "
        "creep"
    )
    shown_by: ClassVar[str] = "a hold of 20 s followed by a rest of 20 s, at two levels"
    source: ClassVar[str] = "Christensen, Theory of Viscoelasticity, 1 (Kelvin-Voigt element)"
    amplitude: ClassVar[str] = "c"
    before_sensor: ClassVar[bool] = True
    begins_with_log: ClassVar[bool] = True
    essential: ClassVar[tuple[str, ...]] = ("tau",)
    ceilings: ClassVar[tuple[str, ...]] = ("c",)

    def parameters(self, scale: Scale) -> ParameterSet:
        """Share c by which the reading creeps on, and the time τ in which it does."""
        share = Parameter(
            "c",
            SERIES_SHARE,
            "1",
            *SERIES_SHARES,
            "log",
            meaning="fraction of a change by which the reading creeps on",
            source=self.source,
        )
        return ParameterSet((share, settling_time(scale, "time constant of the creep")))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Times from a thirtieth to a third of the log."""
        return settling_starts(self.parameters(scale), scale)

    def apply(self, eta: Array, time_s: Array, y: Array, scale: Scale) -> Array:
        """The reading with what creeps on, settled at the first sample."""
        del scale
        crept: Array = y + float(eta[0]) * settling(time_s, y, float(eta[1]))
        return crept


def settling_time(scale: Scale, meaning: str) -> Parameter:
    """The time constant τ of what goes on after the motion has settled, in s.

    Parameters
    ----------
    scale
        Sizes of the base fit.
    meaning
        What it is the time of.
    """
    return replace(Creep().parameters(scale)["tau"], meaning=meaning)


def settling_starts(declared: ParameterSet, scale: Scale) -> tuple[Mapping[str, float], ...]:
    """Starts of a share c and a time τ: times from a thirtieth to a third of the log.

    Parameters
    ----------
    declared
        The parameters, with the start of the share.
    scale
        Sizes of the base fit.
    """
    times = start_times(declared["tau"], scale, TIMES)
    return tuple({"c": declared["c"].value, "tau": tau} for tau in times)


def settling(time_s: Array, y: Array, tau_s: float) -> Array:
    """What follows a course by τ ż + z = y, settled at the first sample, shape (n,).

    Parameters
    ----------
    time_s, y
        The course, straight between its samples, each of shape (n,).
    tau_s
        The time constant.
    """
    late = np.array(y, np.float64)
    lag(np.diff(time_s), late, tau_s, tau_s)
    return late
