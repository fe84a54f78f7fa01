"""The dynamic equilibrium of a bending actuator by plain quadrature, apart from the fitter's.

Every integral over the length and over the wall is summed by Gauss points at every evaluation, in
forms that do not cancel near θ = 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi

import numpy as np
import numpy.typing as npt

from softid.errors import InputError
from softid.synthesis.laws import Motion
from softid.synthesis.tables import Checked, Count, Positive

Array = npt.NDArray[np.float64]

EQUILIBRIUM_PARAMETERS = ("C_d", "a", "b", "c", "stiffness", "drive", "rest_torque", "drift")
LARGEST_ANGLE_RAD = 2.0 * pi
"""A full circle, at which the actuator would meet itself."""

_POINTS_PER_PART = 8
_POINTS_OF_WALL = 24
"""Gauss points over a chamber or a rib and over the height of a wall, more than the fitted model
takes: the truth shares no error with it."""

_PA_PER_KPA = 1000.0
_SMALLEST_HALF = 1e-8
"""Angle below which D, in proportion to it, is rounding beside the other terms."""

_BRACKET_RAD = 0.02
"""Step to the smallest angle at which the torques are equal: too small to pass over two of them."""


@dataclass(frozen=True)
class Bender(Checked):
    """Section, length and material of the bi-directional actuator, lengths in mm.

    Attributes
    ----------
    chamber_width_mm, chamber_height_mm, wall_mm, layer_mm, rib_mm, chamber_length_mm, chambers
        B, h0, t_w, t_n, t_r, a and N of DEE 2022, Figure 1.
    rubber_density_kg_m3, layer_density_kg_m3
        ρ and ρ_abs.
    layer_modulus_gpa, c10_kpa, c20_kpa
        E of the neutral layer, Yeoh coefficients of the walls.
    """

    chamber_width_mm: Positive
    chamber_height_mm: Positive
    wall_mm: Positive
    layer_mm: Positive
    rib_mm: Positive
    chamber_length_mm: Positive
    chambers: Count
    rubber_density_kg_m3: Positive
    layer_density_kg_m3: Positive
    layer_modulus_gpa: Positive
    c10_kpa: Positive
    c20_kpa: float


class _Sums:
    """Points along the length and across the wall with what each of them weighs."""

    def __init__(self, bender: Bender) -> None:
        mm = 1e-3
        width, height = bender.chamber_width_mm * mm, bender.chamber_height_mm * mm
        wall, layer, rib = bender.wall_mm * mm, bender.layer_mm * mm, bender.rib_mm * mm
        chamber, n = bender.chamber_length_mm * mm, bender.chambers
        rubber, plate = bender.rubber_density_kg_m3, bender.layer_density_kg_m3
        outer = width + 2.0 * wall
        hollow = outer * layer * plate + 2.0 * wall * (width + 2.0 * height + 2.0 * wall) * rubber
        solid = outer * (2.0 * rubber * (height + wall) + plate * layer)
        # Second moments of the section by bands: neutral layer, side walls, top walls.
        inner, top = layer / 2.0, layer / 2.0 + height
        core = plate * outer * layer**3 / 12.0
        sides = 2.0 * 2.0 * wall * rubber * _cubes(inner, top)
        tops = 2.0 * outer * rubber * _cubes(top, top + wall)
        full = core + 2.0 * outer * rubber * _cubes(inner, top + wall)
        self.length_m = n * chamber + (n + 1) * rib
        nodes, weights = np.polynomial.legendre.leggauss(_POINTS_PER_PART)
        places, masses, self.rotation = [], [], 0.0
        for i in range(2 * n + 1):
            start = (i // 2) * (chamber + rib) + (rib if i % 2 else 0.0)
            span = chamber if i % 2 else rib
            density, turn = (hollow, core + sides + tops) if i % 2 else (solid, full)
            places.append(start + 0.5 * span * (nodes + 1.0))
            masses.append(0.5 * span * weights * density)
            self.rotation += turn * span * (start + 0.5 * span) / self.length_m
        self.place_m, self.mass_kg = np.concatenate(places), np.concatenate(masses)
        nodes, weights = np.polynomial.legendre.leggauss(_POINTS_OF_WALL)
        y = np.append(0.5 * height * (nodes + 1.0), height + 0.5 * wall)
        areas = np.append(0.5 * height * weights * 2.0 * wall, wall * outer)
        self.lever_m3, self.stretch = y * areas, y / (n * chamber)
        self.layer_nm = bender.layer_modulus_gpa * 1e9 * outer * layer**3 / 12.0 / self.length_m
        self.drive_nm_per_kpa = _PA_PER_KPA * width * height**2 / 2.0
        self.yeoh_pa = 2.0 * _PA_PER_KPA * bender.c10_kpa, 4.0 * _PA_PER_KPA * bender.c20_kpa

    def inertia(self, angle: float) -> float:
        """M(θ): ∫ρ·l0·r·(1 − cos u)/θ² dr with 1 − cos u = 2·sin²(u/2), and the rotation."""
        share = np.sinc(self.place_m * angle / (2.0 * self.length_m * pi))
        bending = self.mass_kg @ (self.place_m**3 * share**2) / (2.0 * self.length_m)
        return float(bending) + self.rotation

    def velocity(self, angle: float) -> float:
        """D(θ): u·sin u + 2·(cos u − 1) = 4·sin h·(h·cos h − sin h) with h = u/2, safe near 0."""
        if abs(angle) < _SMALLEST_HALF:
            return 0.0
        half = self.place_m * angle / (2.0 * self.length_m)
        sine = np.sin(half)
        missing = np.where(
            np.abs(half) < 0.05,
            -(half**3)
            / 3.0
            * (1.0 - half**2 / 10.0 * (1.0 - half**2 / 28.0 * (1.0 - half**2 / 54.0))),
            half * np.cos(half) - sine,
        )
        return float(self.mass_kg @ (self.place_m * 4.0 * sine * missing)) * (
            self.length_m / angle**3
        )

    def elastic(self, angle: float) -> float:
        """K(θ): plane-strain Yeoh walls on both sides, and the neutral layer."""
        total = self.layer_nm * angle
        for side in (1.0, -1.0):
            stretch = 1.0 + side * self.stretch * angle
            nominal = (stretch**4 - 1.0) / stretch**3
            stress = nominal * (self.yeoh_pa[0] + self.yeoh_pa[1] * (stretch - 1.0 / stretch) ** 2)
            total += side * float(self.lever_m3 @ stress)
        return total


def equilibrium_motion(values: Mapping[str, float], bender: Bender) -> Motion:
    """Dynamic equilibrium: C_m·(M·θ̈ + D·θ̇²) + C_d·θ̇ + s·K + τ0 = d·F(p), root-moment inertia.

    Parameters
    ----------
    values
        C_d, a, b, c, stiffness s, drive d, rest_torque τ0 and drift; the drift is the sensor's.
    bender
        Geometry and material.

    Source: DEE 2022, Eq 14 with C_m = a·θ² + b·|θ| + c, corrected; wall stress of softid.
    """
    damping, a, b, c, scale, drive, rest_torque, _ = (values[k] for k in EQUILIBRIUM_PARAMETERS)
    sums = _Sums(bender)

    def compensated(x: float) -> float:
        found = a * x * x + b * abs(x) + c
        if not found > 0.0 or abs(x) > LARGEST_ANGLE_RAD:
            raise InputError(
                "the compensated mass is not positive, or the actuator passes a full circle",
                where="parameters",
                value=x,
                remedy="choose other a, b and c, or a smaller pressure",
            )
        return found

    def pressing(time_s: float, pressure_kpa: float, x: float, v: float) -> float:
        return drive * sums.drive_nm_per_kpa * pressure_kpa

    def resisting(time_s: float, pressure_kpa: float, x: float, v: float) -> float:
        return -scale * sums.elastic(x) - rest_torque

    def fading(time_s: float, pressure_kpa: float, x: float, v: float) -> float:
        return -damping * v

    def turning(time_s: float, pressure_kpa: float, x: float, v: float) -> float:
        return -compensated(x) * sums.velocity(x) * v * v

    def rest(pressure_kpa: float) -> float:
        load = drive * sums.drive_nm_per_kpa * pressure_kpa - rest_torque
        return _rest(sums, scale, load)

    return Motion(
        inertia=lambda pressure_kpa: 1.0,
        terms={"drive": pressing, "spring": resisting, "damping": fading, "inertial": turning},
        rest=rest,
        inertia_at=lambda x: compensated(x) * sums.inertia(x),
    )


def equilibrium_units() -> dict[str, str]:
    """Unit of each parameter of the dynamic equilibrium."""
    units = ("N·m·s/rad", "1/rad²", "1/rad", "1", "1", "1", "N·m", "rad/s")
    return dict(zip(EQUILIBRIUM_PARAMETERS, units, strict=True))


def _rest(sums: _Sums, scale: float, load: float) -> float:
    """Smallest angle at which s·K equals a torque."""
    from scipy.optimize import brentq  # 0.2 s, and `softid --help` needs none of it

    side, high = (1.0 if load >= 0.0 else -1.0), _BRACKET_RAD
    while scale * sums.elastic(high) < abs(load):
        high += _BRACKET_RAD
        if high > LARGEST_ANGLE_RAD or high * float(sums.stretch.max()) >= 1.0:
            raise InputError(
                "the walls cannot hold this torque at any angle",
                where="parameters",
                value=load,
                remedy="choose a smaller pressure or a larger stiffness",
            )
    missing = brentq(lambda x: scale * sums.elastic(x) - abs(load), 0.0, high, xtol=1e-15)
    return side * float(missing)


def _cubes(low: float, high: float) -> float:
    """∫ y² dy."""
    return (high**3 - low**3) / 3.0
