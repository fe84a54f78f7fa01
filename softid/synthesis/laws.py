"""The textbook laws of the actuators as sums of named force terms, written apart from the fitter's.

A motion is M(p)·ẍ = Σ terms. Terms are plain functions of time, pressure, position and velocity, so
that a further physical effect is one more entry of the sum.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp, pi

import numpy as np
import numpy.typing as npt

from softid.errors import InputError
from softid.synthesis.tables import Checked, Positive

Array = npt.NDArray[np.float64]

Term = Callable[[float, float, float, float], float]
"""A force: (time_s, pressure_kpa, x, v) → force in the scale of its law."""

KPA_PER_BAR = 100.0
"""b1 and b2 are per bar, as in the paper; pressures are in kPa."""

MUSCLE_PARAMETERS = ("M", "a1", "b1", "c1", "a2", "b2", "c2")
OSCILLATOR_PARAMETERS = ("M", "N", "Q", "G", "offset")
POLYNOMIAL_PARAMETERS = ("p1", "p2", "p3", "p4", "p5")


@dataclass(frozen=True)
class Motion:
    """A second-order law of motion, ready to be integrated.

    Attributes
    ----------
    inertia
        Pressure in kPa → M.
    inertia_at
        Position → factor on that M; 1 everywhere unless the mass moves with the position.
    terms
        Name → force term; the acceleration is their sum divided by the inertia.
    rest
        Pressure in kPa → position at which the terms cancel without velocity.
    """

    inertia: Callable[[float], float]
    terms: Mapping[str, Term]
    rest: Callable[[float], float]
    inertia_at: Callable[[float], float] = lambda x: 1.0


def muscle_motion(values: Mapping[str, float]) -> Motion:
    """Ru's muscle: M·ẍ = e^{b1 p} − (a1·e^{b1 p} + c1)·x − (a2·e^{b2 p} + c2)·ẋ, p in bar.

    Parameters
    ----------
    values
        M, a1, b1, c1, a2, b2, c2; x in the unit that they imply.

    Source: Ru et al. 2019, Eq 7, with M constant.

    Examples
    --------
    >>> law = muscle_motion(dict(M=1, a1=0.01, b1=3, c1=0.09, a2=0, b2=0, c2=1))
    >>> round(law.rest(0.0), 9)
    10.0
    """
    inertia, a1, b1, c1, a2, b2, c2 = (values[name] for name in MUSCLE_PARAMETERS)

    def drive(time_s: float, pressure_kpa: float, x: float, v: float) -> float:
        return exp(b1 * pressure_kpa / KPA_PER_BAR)

    def spring(time_s: float, pressure_kpa: float, x: float, v: float) -> float:
        return -(a1 * exp(b1 * pressure_kpa / KPA_PER_BAR) + c1) * x

    def damping(time_s: float, pressure_kpa: float, x: float, v: float) -> float:
        return -(a2 * exp(b2 * pressure_kpa / KPA_PER_BAR) + c2) * v

    return Motion(
        inertia=lambda pressure_kpa: inertia,
        terms={"drive": drive, "spring": spring, "damping": damping},
        rest=lambda pressure_kpa: 1.0 / (a1 + c1 * exp(-b1 * pressure_kpa / KPA_PER_BAR)),
    )


def oscillator_motion(values: Mapping[str, float]) -> Motion:
    """The conventional oscillator: M·ẍ = G·(p − offset) − Q·x − N·ẋ, p in kPa.

    Parameters
    ----------
    values
        M, N, Q, G, offset.

    Examples
    --------
    >>> oscillator_motion(dict(M=1, N=1, Q=4, G=1, offset=2)).rest(10.0)
    2.0
    """
    inertia, damping_n, stiffness, gain, offset_kpa = (values[k] for k in OSCILLATOR_PARAMETERS)

    def drive(time_s: float, pressure_kpa: float, x: float, v: float) -> float:
        return gain * (pressure_kpa - offset_kpa)

    def spring(time_s: float, pressure_kpa: float, x: float, v: float) -> float:
        return -stiffness * x

    def damping(time_s: float, pressure_kpa: float, x: float, v: float) -> float:
        return -damping_n * v

    return Motion(
        inertia=lambda pressure_kpa: inertia,
        terms={"drive": drive, "spring": spring, "damping": damping},
        rest=lambda pressure_kpa: gain * (pressure_kpa - offset_kpa) / stiffness,
    )


def quartic(coefficients: tuple[float, ...], pressure_kpa: Array) -> Array:
    """Zhao's empirical curve f(p) = p1·p⁴ + p2·p³ + p3·p² + p4·p + p5, p in kPa.

    Parameters
    ----------
    coefficients
        p1 (highest power) to p5.
    pressure_kpa
        Shape (n,).

    Source: Zhao et al. 2021, Eq 23.

    Examples
    --------
    >>> float(quartic((0.0, 0.0, 1.0, 0.0, 2.0), np.array([3.0]))[0])
    11.0
    """
    total = np.zeros_like(pressure_kpa)
    for coefficient in coefficients:
        total = total * pressure_kpa + coefficient
    return total


@dataclass(frozen=True)
class Arc(Checked):
    """A muscle bent to a circular arc.

    θ = x/d and D = (L0 − x/2)·sin(θ/2)/(θ/2), x = L0 − L the contraction of the deformable side.

    Attributes
    ----------
    fixed_length_mm
        L0, length of the side that keeps its length.
    diameter_mm
        d, distance between the fixed and the deformable side.

    Source: Ru et al. 2019, Eq 1 and 2; d is a distance, though the paper calls it a radius.
    """

    fixed_length_mm: Positive
    diameter_mm: Positive

    def angle_rad(self, contraction_mm: Array) -> Array:
        """Bending angle θ, shape (n,)."""
        return contraction_mm / self.diameter_mm

    def distance_mm(self, contraction_mm: Array) -> Array:
        """Distance D between the two ends, shape (n,).

        Raises
        ------
        InputError
            The contraction leaves the range in which D falls with it.

        Examples
        --------
        >>> Arc(150.0, 20.0).distance_mm(np.array([10.0, 30.0, 60.0])).round(6).tolist()
        [143.494296, 122.694977, 79.799599]
        """
        largest_mm = min(2.0 * pi * self.diameter_mm, 2.0 * self.fixed_length_mm)
        if contraction_mm.min() <= 0.0 or contraction_mm.max() >= largest_mm:
            worst = contraction_mm.max() if contraction_mm.max() >= largest_mm else 0.0
            raise InputError(
                "the distance says nothing about this contraction",
                value=float(worst or contraction_mm.min()),
                remedy=f"keep the contraction between 0 and {largest_mm:.6g} mm",
            )
        half_angle = 0.5 * self.angle_rad(contraction_mm)
        chord_share: Array = np.sin(half_angle) / half_angle
        return (self.fixed_length_mm - 0.5 * contraction_mm) * chord_share


def parameter_units(model: str, x_unit: str) -> dict[str, str]:
    """Unit of each parameter of a dynamic model, for x in ``x_unit`` and pressure in kPa."""
    if model == "muscle":
        x = x_unit
        units = (f"s²/{x}", f"1/{x}", "1/bar", f"1/{x}", f"s/{x}", "1/bar", f"s/{x}")
        return dict(zip(MUSCLE_PARAMETERS, units, strict=True))
    per = f"kPa/{x_unit}"
    return dict(zip(OSCILLATOR_PARAMETERS, (f"{per}·s²", f"{per}·s", per, "1", "kPa"), strict=True))


def polynomial_units(output_unit: str) -> dict[str, str]:
    """Unit of each coefficient of the quartic."""
    units = [f"{output_unit}/kPa^{power}" for power in (4, 3, 2)]
    return dict(
        zip(POLYNOMIAL_PARAMETERS, (*units, f"{output_unit}/kPa", output_unit), strict=True)
    )
