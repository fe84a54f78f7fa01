"""Valve flow: the pressure follows as fast as a restriction lets air pass."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.effects.base import InputEffect
from softid.effects.pneumatic_lag import RATIOS, ratio_of_times
from softid.effects.scale import Scale
from softid.effects.shared_laws.time_constants import lag_time, lag_times
from softid.kernels.valve import valve_flow
from softid.parameters import Parameter, ParameterSet

Array = npt.NDArray[np.float64]

ATMOSPHERE_KPA = 101.325
"""Standard atmosphere, to which a recorded pressure is added."""

LOWEST_SHARE = 0.01
"""Lowest absolute pressure, in atmospheres: noise below a vacuum is no pressure."""

TOLERANCE = 1e-8
"""Error allowed per step of the integration, as a share of the input's range."""

AS_A_LAG = 3.0
"""Times the time constant of a lag: a choked flow would take a time of τ for all of the upstream
pressure, and moves change it by a third, more or less."""

CRITICAL = (0.1, 0.3, 0.528)
"""Bounds and start of the critical ratio: 0.528 is an ideal nozzle's, and a long tube or several
restrictions in a row come down to a tenth."""


@dataclass(frozen=True)
class ValveFlow(InputEffect):
    r"""Flow through a valve after ISO 6358, ṗa = C p_u ψ(p_d/p_u).

    ψ(r) = 1 for r ≤ b and √(1 − ((r − b)/(1 − b))²) above. The recorded pressure is that of the
    regulator: air flows between it and the actuator in the direction of the difference, so the
    upstream pressure p_u is the recorded one while filling and the actuator's while venting. C is
    written as 1/τ, so that τ = 0 is no restriction. Above r = 0.999 the flow is laminar.

    Pressures are absolute, above an atmosphere of 101.325 kPa; an input in another unit than kPa
    counts as a pressure whose range runs from one atmosphere to two.

    Source: ISO 6358-1:2013.
    """

    name: ClassVar[str] = "valve_flow"
    title: ClassVar[str] = "Flow through a valve"
    law: ClassVar[str] = (
        "pa' = C pu psi(pd/pu),  C = 1/tau,  psi(r) = sqrt(1 - (max(r - b, 0)/(1 - b))^2);  pu, pd "
        "absolute pressure upstream and downstream (for a pressure input, recorded + 101.325 kPa)"
    )
    meaning: ClassVar[str] = (
        "A narrow valve limits the flow of air, so after a large step the pressure changes at a "
        "constant rate at first, and the times of filling and venting depend on the level."
    )
    signature: ClassVar[str] = (
        "The residual after a step is larger and lasts longer for larger steps; what a lag with "
        "one time constant leaves differs from level to level."
    )
    neighbours: ClassVar[tuple[str, ...]] = ("pneumatic_lag", "delay")
    remedy: ClassVar[str] = (
        "use a valve with a larger sonic conductance, or record the pressure inside the actuator"
    )
    shown_by: ClassVar[str] = "steps up and down at several levels and of several sizes"
    source: ClassVar[str] = "ISO 6358-1:2013"
    amplitude: ClassVar[str] = "tau"
    slowness: ClassVar[float] = AS_A_LAG

    def parameters(self, scale: Scale) -> ParameterSet:
        """The time τ = 1/C, and the critical ratio b within those of real valves."""
        choked = (
            "time in which choked flow would raise the actuator's pressure by the upstream pressure"
        )
        return ParameterSet(
            (
                lag_time(scale, choked, self.source),
                Parameter(
                    "b",
                    CRITICAL[1],
                    "1",
                    CRITICAL[0],
                    CRITICAL[2],
                    meaning="critical pressure ratio, downstream over upstream, below which the "
                    "flow is choked",
                    source=self.source,
                ),
            )
        )

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """From two samples to the motion's own time."""
        return tuple({"tau": tau, "b": CRITICAL[1]} for tau in lag_times(scale))

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The pressure behind the valve."""
        return behind_valve(float(eta[0]), float(eta[1]), 1.0, time_s, u, scale)


@dataclass(frozen=True)
class SeparateValveFlow(ValveFlow):
    r"""Flow through a valve that vents through another opening than it fills.

    ṗa = p_u ψ(p_d/p_u)/τ with τ while filling and ρ τ while venting: valves have a seat for each
    way, and an exhaust has a silencer. The critical ratio b is that of both.

    Source: ISO 6358-1:2013.
    """

    variant: ClassVar[str] = "separate"
    title: ClassVar[str] = "Flow through a valve that differs by direction"
    law: ClassVar[str] = (
        "pa' = pu psi(pd/pu)/tau while filling, pu psi(pd/pu)/(ratio tau) while venting,  psi(r) = "
        "sqrt(1 - (max(r - b, 0)/(1 - b))^2);  pu, pd absolute pressure upstream and downstream "
        "(for a pressure input, recorded + 101.325 kPa)"
    )
    meaning: ClassVar[str] = (
        "A narrow valve limits the flow of air, and lets it out through another opening than in, "
        "so after a large step the pressure changes at a constant rate at first, by another one "
        "down than up; a supply that sags while it fills the actuator does the same."
    )
    signature: ClassVar[str] = (
        "The residual after a step is larger and lasts longer for larger steps, and differs "
        "between filling and venting by more than the pressures explain."
    )
    shown_by: ClassVar[str] = "steps up and down between the same levels, of several sizes"
    essential: ClassVar[tuple[str, ...]] = ("ratio",)
    plain_at: ClassVar[tuple[str, float] | None] = ("ratio", 1.0)

    def parameters(self, scale: Scale) -> ParameterSet:
        """The time τ of filling, the critical ratio b, and the time of venting over τ."""
        tau, b = super().parameters(scale).values()
        ratio = ratio_of_times("time of venting over that of filling", self.source)
        return ParameterSet((tau, b, ratio))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Two times, each with faster and with slower venting."""
        times = lag_times(scale)[1:]
        return tuple(
            {"tau": tau, "b": CRITICAL[1], "ratio": ratio} for tau in times for ratio in RATIOS
        )

    def apply(self, eta: Array, time_s: Array, u: Array, scale: Scale) -> Array:
        """The pressure behind the valve."""
        tau, b, ratio = eta.tolist()
        return behind_valve(tau, b, ratio, time_s, u, scale)


def behind_valve(
    tau_s: float, b: float, ratio: float, time_s: Array, u: Array, scale: Scale
) -> Array:
    """The pressure behind a valve, above an atmosphere as the recorded one is, shape (n,).

    Parameters
    ----------
    tau_s, b, ratio
        Time of filling, critical ratio, and time of venting over that of filling.
    time_s, u
        The recorded pressure, straight between its samples, each of shape (n,).
    scale
        Sizes of the base fit: unit and range of the input.
    """
    arriving = np.array(u, np.float64)
    if tau_s <= 0.0:
        return arriving
    if scale.u_unit == "kPa":
        atmosphere, added = ATMOSPHERE_KPA, ATMOSPHERE_KPA
    else:
        atmosphere, added = scale.u_span, scale.u_span - scale.u_low
    absolute = np.maximum(arriving + added, LOWEST_SHARE * atmosphere)
    valve_flow(np.diff(time_s), absolute, tau_s, b, ratio, TOLERANCE * scale.u_span)
    passed: Array = absolute - added
    return passed
