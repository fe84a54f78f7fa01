"""Laws in no catalogue of what goes with the position or the input: forces, rests, coefficients."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from softid.diagnosis.verdict.unlisted_drifts import one_parameter
from softid.effects.base import StateEffect
from softid.effects.scale import Scale
from softid.kernels.terms import DAMPING, FORCE, SHIFT, STIFFNESS
from softid.parameters import ParameterSet

KNOTS = 11
"""Positions at which the force is known, of which the first and the last have none."""

INNER = KNOTS - 2
NAMES = tuple(f"f{k}" for k in range(1, INNER + 1))
"""The knots that have a force."""

MOST_FALLEN, MOST_RISEN = -0.9, 20.0
"""Bounds of what a stiffness or a damping gains over the range of the input, as a share of it."""

STIFFER = (0.5, -0.3)
"""Starts of that gain of the stiffness."""

MARGIN = 0.05
"""Share of the range of positions by which the knots reach beyond either end of it, for the model
goes a little further than the record."""

MOST = 1.0
"""Bound of the force at a knot, as a share of what moves the actuator through its range, and of the
shift at one, as a share of that range."""

LEAST_POWER, MOST_POWER = 1.5, 15.0
"""Bounds of the power with which a spring stiffens: straighter is the model's own, and steeper a
wall."""

POWERS, SHARES = (2.0, 5.0, 9.0), (-0.1, 0.2)
"""Starts of the power, and of the force at the end of the range."""

BENDS = 12
"""Intervals of a curve in the input, of which the catalogue's has five."""

SHIFTS = tuple(f"s{k}" for k in range(1, BENDS + 1))
"""The knots behind the first."""

CUBICS = (
    (0.0, -0.5, 1.0, -0.5),
    (1.0, 0.0, -2.5, 1.5),
    (0.0, 0.5, 2.0, -1.5),
    (0.0, 0.0, -0.5, 0.5),
)
"""What each of four knots weighs between the two in the middle: coefficients of the powers 0 to 3
of the share of the way between them."""


@dataclass(frozen=True)
class PowerSpring(StateEffect):
    """A force that grows with a power of the position, + F share |x/X|ⁿ sign x.

    X is the largest position. A wall of fibres or folds that come to their full length stiffens
    later, and more steeply, than with the cube.

    Source: Kovacic and Brennan, *The Duffing Equation*, 2011, ch. 2 (purely nonlinear springs).
    """

    name: ClassVar[str] = "power_spring"
    title: ClassVar[str] = "Stiffening with another power"
    law: ClassVar[str] = "+ F share |x/X|^n sign(x), X the largest position"
    meaning: ClassVar[str] = "The wall stiffens later and more steeply than with the cube."
    signature: ClassVar[str] = "The residual at rest grows steeply towards the largest positions."
    remedy: ClassVar[str] = "work in the middle of the range"
    shown_by: ClassVar[str] = "held levels up to the largest position, in fine steps up and down"
    source: ClassVar[str] = "Kovacic and Brennan, The Duffing Equation, 2011, ch. 2"
    amplitude: ClassVar[str] = "share"
    essential: ClassVar[tuple[str, ...]] = ("n",)
    counts_position: ClassVar[bool] = True
    changes_sign: ClassVar[bool] = True

    def parameters(self, scale: Scale) -> ParameterSet:
        """The force at the largest position, and the power."""
        del scale
        declared = (
            one_parameter("share", SHARES[1], "1", -MOST, MOST, "force there", self.source),
            one_parameter("n", POWERS[1], "1", LEAST_POWER, MOST_POWER, "power", self.source),
        )
        return ParameterSet(tuple(p for one in declared for p in one.values()))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Several powers, of a spring that gives way and of one that stiffens."""
        del scale
        return tuple({"share": share, "n": n} for n in POWERS for share in SHARES)

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """The unit of the force, and the largest position."""
        return scale.force, max(abs(scale.x_low), abs(scale.x_high))

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force F share |x/X|ⁿ sign x."""
        out[FORCE] += eta[2] * eta[0] * math.copysign(abs(x / eta[3]) ** eta[1], x)


@dataclass(frozen=True)
class FreeSpring(StateEffect):
    """A force that goes with the position along any smooth curve, + F f(ξ), ξ from 0 to 1.

    f is a cubic between `KNOTS` values at equal distances, with the slope of the chord of its
    neighbours at each. It is zero at both ends and beyond: a straight line is the model's own.

    Source: Catmull and Rom, *A class of local interpolating splines*, 1974.
    """

    name: ClassVar[str] = "free_spring"
    title: ClassVar[str] = "Spring of a shape of its own"
    law: ClassVar[str] = "+ F f(xi), xi the position within its range, f through f1 … f9"
    meaning: ClassVar[str] = "Folds, walls or a weight pull with another force at every position."
    signature: ClassVar[str] = "The residual is a function of the position, at rest and in motion."
    remedy: ClassVar[str] = "none is needed: use the measured curve for control"
    shown_by: ClassVar[str] = "held levels over the full range, in fine steps up and down"
    source: ClassVar[str] = "Catmull and Rom, A class of local interpolating splines, 1974"
    amplitude: ClassVar[str] = "f1"
    changes_sign: ClassVar[bool] = True

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """All vanish together."""
        return NAMES

    def parameters(self, scale: Scale) -> ParameterSet:
        """The force at each inner knot, as a share of what moves the actuator."""
        del scale
        declared = (
            one_parameter(name, 0.0, "1", -MOST, MOST, "force there", self.source)[name]
            for name in NAMES
        )
        return ParameterSet(tuple(declared))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """One start: no force at any position."""
        del scale
        return (dict.fromkeys(NAMES, 0.0),)

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """The unit of the force, where the knots begin, and their distance."""
        low, span = scale.x_low - MARGIN * scale.x_span, (1.0 + 2.0 * MARGIN) * scale.x_span
        return scale.force, low, span / (KNOTS - 1)

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Force F f(ξ)."""
        place = min(max((x - eta[INNER + 1]) / eta[INNER + 2], 0.0), KNOTS - 1.0)
        left = min(int(place), KNOTS - 2)
        b = place - left
        force = 0.0
        for j in range(4):
            inner = left + j - 2
            if 0 <= inner < INNER:
                w = CUBICS[j]
                force += (w[0] + b * (w[1] + b * (w[2] + b * w[3]))) * eta[inner]
        out[FORCE] += eta[INNER] * force


@dataclass(frozen=True)
class FineCurve(StateEffect):
    """Shift of the spring's rest by a curve in the input with twice the knots, q(x − s(u)).

    s is a cubic between values at equal distances over the range of the input, with the slope of
    the chord of its neighbours at each; it is zero at the first, and level outside.

    Source: Catmull and Rom, *A class of local interpolating splines*, 1974.
    """

    name: ClassVar[str] = "fine_curve"
    title: ClassVar[str] = "Static curve with finer bends"
    law: ClassVar[str] = "x - s(u) in place of x in the spring; s through s1 … s12"
    meaning: ClassVar[str] = "The settled positions jump or bend within a small part of the range."
    signature: ClassVar[str] = "The residual at rest depends only on the level of the input."
    remedy: ClassVar[str] = "none is needed: use the measured curve for control"
    shown_by: ClassVar[str] = "held levels over the full range, in fine steps up and down"
    source: ClassVar[str] = "Catmull and Rom, A class of local interpolating splines, 1974"
    amplitude: ClassVar[str] = "s1"
    changes_sign: ClassVar[bool] = True

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """All vanish together."""
        return SHIFTS

    def parameters(self, scale: Scale) -> ParameterSet:
        """The shift at each knot but the first, as a share of the range of positions."""
        del scale
        declared = (
            one_parameter(name, 0.0, "1", -MOST, MOST, "shift there", self.source)[name]
            for name in SHIFTS
        )
        return ParameterSet(tuple(declared))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """One start: no shift at any input."""
        del scale
        return (dict.fromkeys(SHIFTS, 0.0),)

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """The unit of the shift, where the knots begin, and their distance."""
        return scale.x_span, scale.u_low, scale.u_span / BENDS

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Shift s(u)."""
        place = min(max((u - eta[BENDS + 1]) / eta[BENDS + 2], 0.0), float(BENDS))
        left = min(int(place), BENDS - 1)
        b = place - left
        shift = 0.0
        for j in range(4):
            knot = min(max(left + j - 1, 0), BENDS)
            if knot > 0:
                w = CUBICS[j]
                shift += (w[0] + b * (w[1] + b * (w[2] + b * w[3]))) * eta[knot - 1]
        out[SHIFT] += eta[BENDS] * shift


@dataclass(frozen=True)
class PressureStiffness(StateEffect):
    """Stiffness and damping that go with the input, (1 + k ξ) and (1 + d ξ) times the model's.

    ξ is the input within its range, from 0 to 1. A linear model has neither, and a law that bends
    the motion in another way, such as an inertia that falls with the input, follows them in part.

    Source: Ru et al. 2019, doi 10.1007/s11432-018-9709-x, Eq 4, where both depend on pressure.
    """

    name: ClassVar[str] = "pressure_stiffness"
    title: ClassVar[str] = "Stiffness and damping that go with the pressure"
    law: ClassVar[str] = "stiffness (1 + k xi), damping (1 + d xi), xi the input within its range"
    meaning: ClassVar[str] = "An inflated chamber is stiffer than an empty one, and damps more."
    signature: ClassVar[str] = "Small steps ring faster at a high pressure than at a low one."
    remedy: ClassVar[str] = "take the muscle model (--model muscle)"
    shown_by: ClassVar[str] = "small steps about a low and about a high pressure"
    source: ClassVar[str] = "Ru et al. 2019, doi 10.1007/s11432-018-9709-x, Eq 4"
    amplitude: ClassVar[str] = "k"
    changes_sign: ClassVar[bool] = True

    @property
    def amplitudes(self) -> tuple[str, ...]:
        """Both vanish together."""
        return ("k", "d")

    def parameters(self, scale: Scale) -> ParameterSet:
        """What stiffness and damping gain over the range of the input, as a share."""
        del scale
        declared = (
            one_parameter(name, 0.0, "1", MOST_FALLEN, MOST_RISEN, "gain", self.source)[name]
            for name in self.amplitudes
        )
        return ParameterSet(tuple(declared))

    def starts(self, scale: Scale) -> tuple[Mapping[str, float], ...]:
        """Two starts: a stiffness that rises, and one that falls."""
        del scale
        return tuple({"k": k, "d": 0.0} for k in STIFFER)

    def constants(self, scale: Scale) -> tuple[float, ...]:
        """Lower end of the range of the input, and the range."""
        return scale.u_low, scale.u_span

    @staticmethod
    def step(x: float, v: float, z: float, u: float, t: float, eta: Any, out: Any) -> None:
        """Relative changes k ξ and d ξ; beyond the range both stay what they are at its ends."""
        share = min(max((u - eta[2]) / eta[3], 0.0), 1.0)
        out[STIFFNESS] += eta[0] * share
        out[DAMPING] += eta[1] * share
