"""The deformation theory of Zhao et al., repaired: angle from pressure, with a fitted width."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from softid.errors import UsageError
from softid.models.base import Model, Response
from softid.models.bulge import (
    LARGEST_BULGE_RAD,
    BulgeGeometry,
    pressure_terms,
    tabulated_terms,
)
from softid.models.division import Division
from softid.parameters import Parameter, ParameterSet
from softid.segment import Segment

Array = npt.NDArray[np.float64]

NAMES = ("w", "C10", "C20")
WIDTH_MM = 14.7
"""Width that brings the theory closest to Table 2 of the paper. FITTED: the paper prints none."""

_ZHAO = "Zhao et al. 2021"
_STARTING_SAMPLES = 400
"""Samples, evenly spread, from which the width is guessed: one number needs no more."""

_NEWTON_STEPS = 3
"""Newton's steps from the table, which starts them 1e-5 from the solution; each squares the
error."""


@dataclass(frozen=True)
class Yeoh(Model):
    """2N·P·dA/dΦ = dV/dΦ + dE/dΦ + dS/dΦ: walls that bulge, a column that bends, a spring.

    V is the strain energy of the bulging walls, E that of the column bent about its far face,
    S = ½·(k/w)·(a·Φ/2)² that of the spring, all per unit width, with the Yeoh material in plane
    strain. The paper's energies as printed do not reproduce its Table 2 (see
    `softid.models.zhao2021_theory.printed_energy_pressure`); this closure does to 12.8 % with a
    width w that is FITTED, for the paper prints none. Only k/w enters, so a wrong k shows as a
    wrong w.

    The pressure is linear in C10, C20 and k/w. C10 and C20 are held at the paper's values; freeing
    them asks for a range of angles over which wall and column stiffen. Below zero pressure the
    curve is continued by its tangent, for noise about zero. It ends where the walls are half
    circles, or before, where the pressure would fall as the bulge grows.

    Attributes
    ----------
    height_mm, foot_mm, wall_mm, column_mm, length_mm, chambers
        Dimensions, see `BulgeGeometry`; by default Table 1 of the paper.
    spring_n_per_mm
        k of the spring in the column. The paper prints 1.1 without unit; N/mm is an ASSUMPTION.

    Raises
    ------
    UsageError
        The number of chambers is not whole, the spring not positive, or the dimensions impossible.

    Source: Zhao et al. 2021, doi 10.1155/2021/6623059, §3, with the repairs told above.

    Examples
    --------
    >>> model = Yeoh()
    >>> angle = model.static_output(np.array([14.7, 0.09, 0.02]), np.array([0.0, 40.0]), "angle")
    >>> angle.round(3).tolist()
    [0.0, 1.531]
    """

    height_mm: float = 35.0
    foot_mm: float = 8.0
    wall_mm: float = 2.0
    column_mm: float = 16.0
    length_mm: float = 160.0
    chambers: int = 13
    spring_n_per_mm: float = 1.1

    name: ClassVar[str] = "yeoh"
    title: ClassVar[str] = "Bulging chambers on a column, Yeoh material, fitted width"
    equation: ClassVar[str] = (
        "2N P dA/dPhi = d(V + E)/dPhi + k a^2 Phi/(4 w),  V and E sums of C10 e^2 + C20 e^4, "
        "e = stretch - 1/stretch"
    )
    source: ClassVar[str] = "Zhao et al. 2021, doi 10.1155/2021/6623059, Eq 5 to 21, repaired"
    inputs: ClassVar[tuple[str, ...]] = ("pressure", "pressure_command")
    outputs: ClassVar[tuple[str, ...]] = ("angle",)
    identified_by: ClassVar[Mapping[str, str]] = {
        "w": "settled levels of pressure and angle; only spring over width is seen",
        "C10": "settled levels at small angles, with the width known",
        "C20": "settled levels at the largest angles, where the walls stretch",
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "chambers", int(self.chambers))
        if not (np.isfinite(self.spring_n_per_mm) and self.spring_n_per_mm > 0):
            raise UsageError(
                "spring_n_per_mm is not positive",
                where="option spring_n_per_mm",
                value=self.spring_n_per_mm,
                remedy="give the stiffness of the spring in N/mm",
            )
        _ = self.geometry

    @property
    def geometry(self) -> BulgeGeometry:
        """The dimensions, checked."""
        return BulgeGeometry(
            self.height_mm,
            self.foot_mm,
            self.wall_mm,
            self.column_mm,
            self.length_mm,
            self.chambers,
        )

    def variants(self, input_name: str) -> tuple[Model, ...]:
        """None: dimensions belong to one actuator, so the model is taken only when it is named."""
        del input_name
        return ()

    def parameters(self) -> ParameterSet:
        """The fitted width, and the two Yeoh constants held at the paper's values."""
        return ParameterSet(
            (
                Parameter(
                    "w",
                    WIDTH_MM,
                    "mm",
                    lower=0.1,
                    upper=1e4,
                    scale="log",
                    meaning="effective width; fitted, the paper prints none",
                    source="fitted to Zhao et al. 2021, Table 2",
                ),
                Parameter(
                    "C10",
                    0.09,
                    "MPa",
                    lower=1e-4,
                    upper=100.0,
                    scale="log",
                    fixed=True,
                    meaning="first Yeoh constant",
                    source=f"{_ZHAO}, Eq 5; the unit is not printed",
                ),
                Parameter(
                    "C20",
                    0.02,
                    "MPa",
                    lower=0.0,
                    upper=100.0,
                    fixed=True,
                    meaning="second Yeoh constant",
                    source=f"{_ZHAO}, Eq 5; the unit is not printed",
                ),
            )
        )

    def guess(self, segments: Sequence[Segment], output: str) -> tuple[ParameterSet, ...]:
        """The width whose pressures are closest to those measured: linear in 1/w at known angles.

        The fitted width of the paper's actuator is the second start.
        """
        declared = self.parameters()
        pressure = np.concatenate([s.input[s.used[output]] for s in segments])
        angle = np.concatenate([s.outputs[output][s.used[output]] for s in segments])
        chosen = np.linspace(0, pressure.size - 1, min(pressure.size, _STARTING_SAMPLES)).astype(
            int
        )
        # A sensor may have any zero; the angle of the model is zero at no pressure.
        order = np.argsort(pressure[chosen], kind="stable")
        p, phi = pressure[chosen][order], angle[chosen][order]
        bulge = self.geometry.bulge_of_angle(phi - phi[0])
        inside = (bulge > 0.0) & (bulge < LARGEST_BULGE_RAD)
        if not inside.any():
            return (declared,)
        terms, _ = pressure_terms(self.geometry, bulge[inside])
        constants = declared.values_dict()
        rest = p[inside] - constants["C10"] * terms[0] - constants["C20"] * terms[1]
        stiffness = float(rest @ terms[2] / (terms[2] @ terms[2]))
        if stiffness <= 0.0:
            return (declared,)
        return (declared.with_values({"w": self.spring_n_per_mm / stiffness}), declared)

    def response(
        self,
        theta: Array,
        segment: Segment,
        outputs: Sequence[str],
        *,
        start: Array | None,
        derivatives: bool,
        relative: bool = False,
        plan: Division | None = None,
    ) -> Response:
        """The angle at every sample, NaN past the end of the curve; see `Model.response`."""
        del start, relative, plan
        bulge = self._bulge(theta, segment.input)
        angle, by_theta = self._angle(theta, segment.input, bulge)
        values = dict.fromkeys(outputs, angle)
        empty = np.empty(0)
        if not derivatives:
            return Response(values, None, None, empty)
        none = np.empty((segment.input.size, 0))
        return Response(
            values, dict.fromkeys(outputs, by_theta), dict.fromkeys(outputs, none), empty
        )

    def static_output(self, theta: Array, input_values: Array, output: str) -> Array:
        """The angle in rad at pressures in kPa, shape (m,); NaN past the end of the curve."""
        del output
        pressure = np.asarray(input_values, dtype=np.float64)
        return self._angle(theta, pressure, self._bulge(theta, pressure))[0]

    def derived(
        self, values: Mapping[str, float], input_range: tuple[float, float]
    ) -> dict[str, tuple[float, str]]:
        """k/w, the combination that the logs see."""
        del input_range
        return {"k/w": (self.spring_n_per_mm / values["w"], "N/mm²")}

    def _weights(self, theta: Array) -> Array:
        """C10, C20 and k/w: what `pressure_terms` are multiplied by."""
        width, first, second = (float(v) for v in theta)
        return np.array([first, second, self.spring_n_per_mm / width])

    def _bulge(self, theta: Array, pressure_kpa: Array) -> Array:
        """δ of pressures, 0 below zero and NaN past the end of the curve, shape (m,)."""
        weights, geometry = self._weights(theta), self.geometry
        grid, grid_terms, grid_slopes = tabulated_terms(geometry)
        rising = np.logical_and.accumulate(weights @ grid_slopes > 0.0)
        grid, levels = grid[rising], (weights @ grid_terms)[rising]
        bulge = np.full(pressure_kpa.shape, np.nan)
        bulge[pressure_kpa <= 0.0] = 0.0
        inside = (pressure_kpa > 0.0) & (pressure_kpa <= levels[-1])
        target = pressure_kpa[inside]
        found = np.interp(target, levels, grid)
        for _ in range(_NEWTON_STEPS):
            terms, slopes = pressure_terms(geometry, found)
            found = np.clip(found - (weights @ terms - target) / (weights @ slopes), 0.0, grid[-1])
        bulge[inside] = found
        return bulge

    def _angle(self, theta: Array, pressure_kpa: Array, bulge: Array) -> tuple[Array, Array]:
        """Φ of shape (m,) and ∂Φ/∂θ = −(∂P/∂θ)/(∂P/∂Φ) of shape (m, 3)."""
        weights, phi = self._weights(theta), self.geometry.angle(bulge)
        terms, slopes = pressure_terms(self.geometry, bulge)
        stiffness = (weights @ slopes) / phi.slope
        below = pressure_kpa < 0.0
        angle = np.where(below, pressure_kpa / stiffness, phi.value)
        # On the tangent P = (dP/dΦ)·Φ, so what a parameter adds to P is its share of the slope.
        by_weight = np.where(below, slopes / phi.slope * angle, terms)
        by_width = -weights[2] / float(theta[0]) * by_weight[2]
        by_theta = -np.column_stack([by_width, by_weight[0], by_weight[1]])
        return angle, by_theta / stiffness[:, None]
