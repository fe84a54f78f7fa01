"""Random actuators of each model, with the sizes by which a hidden effect is scaled."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp, log
from types import MappingProxyType

import numpy as np

from softid.errors import entry_named
from softid.synthesis.bending_law import Bender, equilibrium_motion, equilibrium_units
from softid.synthesis.laws import Motion, muscle_motion, oscillator_motion, parameter_units
from softid.synthesis.random_truth import random_muscle_truth

RAD_PER_MM = 1.0 / 20.0
"""A muscle's angle per contraction: an arc of 20 mm between its sides."""

_SMALL = 1e-4
"""Step of the central differences, as a share of the position or of one unit: near enough for a
slope, and far above rounding."""


@dataclass(frozen=True)
class Kind:
    """A model that an actuator may follow.

    Attributes
    ----------
    draw
        Generator → parameters with x in mm.
    motion
        Parameters → law of motion.
    per_x
        Parameters that are divided by the unit of x.
    force_unit
        Unit of the terms of the law.
    top_kpa
        Highest pressure that a protocol commands.
    column
        Name of the output column without its unit, for x in mm.
    gauge
        Noise of its pressure gauge over that of the rig's.
    is_angle
        Whether x is an angle in rad whatever the rig.
    """

    draw: Callable[[np.random.Generator], dict[str, float]]
    motion: Callable[[Mapping[str, float]], Motion]
    per_x: tuple[str, ...]
    force_unit: str
    top_kpa: float
    column: str
    gauge: float = 1.0
    is_angle: bool = False


@dataclass(frozen=True)
class Actuator:
    """An actuator with known parameters.

    Attributes
    ----------
    model
        Name in `ACTUATORS`.
    values
        Parameter → true value.
    x_unit
        ``"mm"`` or ``"rad"``.
    """

    model: str
    values: Mapping[str, float]
    x_unit: str = "mm"

    def __post_init__(self) -> None:
        if kind_of(self.model).is_angle:
            object.__setattr__(self, "x_unit", "rad")
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))

    @property
    def kind(self) -> Kind:
        """What is common to all actuators of the model."""
        return ACTUATORS[self.model]

    @property
    def motion(self) -> Motion:
        """The law of motion."""
        return self.kind.motion(self.values)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each parameter."""
        if self.model == "equilibrium":
            return equilibrium_units()
        return parameter_units(self.model, self.x_unit)


@dataclass(frozen=True)
class Sizes:
    """What a hidden effect is scaled by.

    Attributes
    ----------
    p_low, p_high
        Range of the command in kPa.
    x_low, x_high
        Range of the positions at rest.
    force
        Stiffness times the range of positions.
    stiffness, damping
        −∂F/∂x and −∂F/∂ẋ in the middle of the pressures.
    motion_s
        Their ratio, damping over stiffness.
    v_max
        Speed exceeded in one per cent of the time without the effect.
    travel
        ∫|v| dt without the effect.
    duration_s
        Length of the log from which the effect is to be found.
    x_unit, force_unit
        Units.
    """

    p_low: float
    p_high: float
    x_low: float
    x_high: float
    force: float
    stiffness: float
    damping: float
    motion_s: float
    v_max: float
    travel: float
    duration_s: float
    x_unit: str
    force_unit: str

    @property
    def x_span(self) -> float:
        """Range of the positions."""
        return self.x_high - self.x_low

    @property
    def p_span(self) -> float:
        """Range of the pressures."""
        return self.p_high - self.p_low


def random_oscillator_truth(rng: np.random.Generator) -> dict[str, float]:
    """Five parameters of an oscillator; all are assumptions.

    Drawn: travel 40 to 80 mm at 200 kPa, time constant N/Q 50 to 300 ms, damping ratio 0.5 to 3.

    Parameters
    ----------
    rng
        Generator to draw from.

    Returns
    -------
    dict
        M, N, Q, G, offset with x in mm and p in kPa.

    Examples
    --------
    >>> random_oscillator_truth(np.random.default_rng(1))["G"]
    1.0
    """
    stiffness = 200.0 / rng.uniform(40.0, 80.0)
    damping = stiffness * exp(rng.uniform(log(0.05), log(0.3)))
    ratio = exp(rng.uniform(log(0.5), log(3.0)))
    inertia = (damping / (2.0 * ratio)) ** 2 / stiffness
    return {"M": inertia, "N": damping, "Q": stiffness, "G": 1.0, "offset": 0.0}


BENDER = Bender(
    chamber_width_mm=20.0,
    chamber_height_mm=12.0,
    wall_mm=2.0,
    layer_mm=0.5,
    rib_mm=3.0,
    chamber_length_mm=8.0,
    chambers=10,
    rubber_density_kg_m3=1070.0,
    layer_density_kg_m3=1040.0,
    layer_modulus_gpa=2.0,
    c10_kpa=17.0,
    c20_kpa=-0.2,
)
"""The geometry that the equilibrium model takes when none is given."""


def random_equilibrium_truth(rng: np.random.Generator) -> dict[str, float]:
    """Eight parameters of a dynamic equilibrium of `BENDER`; all are assumptions.

    Drawn: damping 2 to 20 × 10⁻⁴ N·m·s/rad, half to one and a half times the elastic torque, a mass
    compensation c of 0.7 to 2 at rest that a and b change by a third at most within 1 rad.

    Parameters
    ----------
    rng
        Generator to draw from.

    Returns
    -------
    dict
        C_d, a, b, c, stiffness, drive, rest_torque, drift in SI units.

    Examples
    --------
    >>> random_equilibrium_truth(np.random.default_rng(1))["drive"]
    1.0
    """
    c = rng.uniform(0.7, 2.0)
    return {
        "C_d": exp(rng.uniform(log(2e-4), log(2e-3))),
        "a": c * rng.uniform(-0.1, 0.2),
        "b": c * rng.uniform(-0.2, 0.1),
        "c": c,
        "stiffness": rng.uniform(0.6, 1.5),
        "drive": 1.0,
        "rest_torque": 0.0,
        "drift": 0.0,
    }


def _bender_motion(values: Mapping[str, float]) -> Motion:
    return equilibrium_motion(values, BENDER)


ACTUATORS: dict[str, Kind] = {
    "muscle": Kind(
        random_muscle_truth, muscle_motion, ("M", "a1", "c1", "a2", "c2"), "1", 240.0, "contraction"
    ),
    "oscillator": Kind(
        random_oscillator_truth, oscillator_motion, ("M", "N", "Q"), "kPa", 200.0, "position"
    ),
    "equilibrium": Kind(
        random_equilibrium_truth, _bender_motion, (), "N·m", 20.0, "angle", gauge=0.1, is_angle=True
    ),
}


def kind_of(model: str) -> Kind:
    """The entry of a model.

    Raises
    ------
    UsageError
        The model has no law of motion here.
    """
    return entry_named(model, ACTUATORS, unknown="there is no generator for this model")


def random_actuator(model: str, rng: np.random.Generator, *, x_unit: str = "mm") -> Actuator:
    """Draw an actuator that somebody could have built.

    Parameters
    ----------
    model
        Name in `ACTUATORS`.
    rng
        Generator to draw from.
    x_unit
        ``"mm"``, or ``"rad"`` for the same actuator by its bending angle, 1/20 rad per mm.

    Raises
    ------
    UsageError
        There is no such model.
    """
    kind = kind_of(model)
    values = kind.draw(rng)
    if x_unit == "rad":
        values = {k: v / RAD_PER_MM if k in kind.per_x else v for k, v in values.items()}
    return Actuator(model, values, x_unit)


def slopes(motion: Motion, pressure_kpa: float) -> tuple[float, float]:
    """Stiffness −∂F/∂x and damping −∂F/∂ẋ at rest.

    Parameters
    ----------
    motion
        Law of motion.
    pressure_kpa
        Pressure of the rest.
    """
    x = motion.rest(pressure_kpa)
    step = _SMALL * max(abs(x), 1.0)

    def force(x: float, v: float) -> float:
        return sum(term(0.0, pressure_kpa, x, v) for term in motion.terms.values())

    by_x = (force(x - step, 0.0) - force(x + step, 0.0)) / (2.0 * step)
    by_v = (force(x, -step) - force(x, step)) / (2.0 * step)
    return by_x, by_v
