"""Chambers that bulge and bend a column: the pressure of a bulge, by virtual work."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache
from math import factorial, pi

import numpy as np
import numpy.typing as npt

from softid.errors import UsageError

Array = npt.NDArray[np.float64]

LARGEST_BULGE_RAD = pi
"""The wall as a half circle. Past it the sides of a chamber would swell over its own edges."""

_KPA_PER_MPA = 1000.0
"""Moduli are in MPa, pressures in kPa."""

_TERMS = 16
"""Terms of each series; at a half circle the next one is far below rounding."""

_SINC = np.polynomial.Polynomial(
    [c for k in range(_TERMS) for c in ((-1) ** k / factorial(2 * k + 1), 0.0)]
)
_SHORTFALL = -np.polynomial.Polynomial([0.0, *_SINC.coef[1:]])
_SEGMENT = np.polynomial.Polynomial(
    [c for k in range(_TERMS) for c in (0.0, 6.0 * (-1) ** k / factorial(2 * k + 3))]
)
"""sin(h)/h, what it lacks of 1, and 6 (δ − sin δ)/δ²: the series converge to rounding over the
whole range, without the cancellation of the closed forms."""

_GRID = 513
"""Bulges in the table. Straight lines between them are 1e-5 off, a start for Newton's steps."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
"""Gauss points over the height of the column; its stress is so smooth that more change no digit."""


@dataclass(frozen=True, eq=False)
class Jet:
    """A function of the bulge angle δ with its first two derivatives, each of shape (m,)."""

    value: Array
    slope: Array
    curvature: Array


def strain(bulge_rad: Array) -> Jet:
    """λ(δ) − 1 with λ = δ/(2 sin(δ/2)): arc over chord of the wall (Zhao et al. 2021, Eq 16)."""
    half = 0.5 * np.asarray(bulge_rad, dtype=np.float64)
    s, s1, s2 = _SINC(half), 0.5 * _SINC.deriv()(half), 0.25 * _SINC.deriv(2)(half)
    return Jet(_SHORTFALL(half) / s, -s1 / s**2, (2.0 * s1**2 - s * s2) / s**3)


def yeoh_energy(strain: Array) -> tuple[Array, Array, Array]:
    """Yeoh strain energy in plane strain and its derivatives by λ = 1 + strain, each (2, …).

    W = C10·e² + C20·e⁴ with e = λ − 1/λ (Eq 5); dW/dλ is the nominal stress (Eq 7). Row 0 is for
    C10 = 1 and row 1 for C20 = 1.

    Examples
    --------
    >>> _, by_stretch, _ = yeoh_energy(np.array([0.5]))
    >>> round(float(0.09 * by_stretch[0, 0] + 0.02 * by_stretch[1, 0]), 5)
    0.28354
    """
    inverse = 1.0 / (1.0 + strain)
    # λ − 1/λ of the strain itself: the difference would leave rounding alone at small strains.
    e = strain * (2.0 + strain) * inverse
    square = inverse * inverse
    e1, e2 = 1.0 + square, -2.0 * square * inverse
    e_squared = e * e
    energy = np.stack([e_squared, e_squared * e_squared])
    stress = np.stack([2.0 * e * e1, 4.0 * e_squared * e * e1])
    bend = e * e2
    tangent = np.stack([2.0 * (e1 * e1 + bend), 4.0 * e_squared * (3.0 * e1 * e1 + bend)])
    return energy, stress, tangent


@dataclass(frozen=True)
class BulgeGeometry:
    """A row of chambers on a column that does not shorten; lengths in mm.

    Attributes
    ----------
    height_mm, foot_mm
        h, inner height of a chamber, and h_a, height of the foot of its wall, which does not bulge.
    wall_mm
        t, thickness of the wall that bulges.
    column_mm, length_mm
        a and l, thickness and length of the column.
    chambers
        N, number of chambers; each has two walls that bulge.

    Raises
    ------
    UsageError
        A size is not positive, or the foot is as high as the chamber.

    Source: Zhao et al. 2021, Table 1 and Eq 8 to 16.
    """

    height_mm: float
    foot_mm: float
    wall_mm: float
    column_mm: float
    length_mm: float
    chambers: int

    def __post_init__(self) -> None:
        for name in (f.name for f in fields(self)):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise UsageError(
                    f"{name} is not positive",
                    where="chamber geometry",
                    value=value,
                    remedy="measure it on the actuator",
                )
        if self.foot_mm >= self.height_mm:
            raise UsageError(
                "the foot of the wall is as high as the chamber",
                where="chamber geometry",
                value=(self.foot_mm, self.height_mm),
                remedy="give foot_mm below height_mm",
            )

    @property
    def chord_mm(self) -> float:
        """The part of the wall that bulges, h − h_a."""
        return self.height_mm - self.foot_mm

    @property
    def _tangent_ratio(self) -> float:
        return self.chord_mm / (self.height_mm + self.foot_mm)

    def angle(self, bulge_rad: Array) -> Jet:
        """Φ(δ) = 2N·arctan[(h − h_a)/(h + h_a)·tan(δ/4)] in rad, from Eq 8, 9 and 12.

        Examples
        --------
        >>> zhao = BulgeGeometry(35.0, 8.0, 2.0, 16.0, 160.0, 13)
        >>> zhao.angle(np.array([1.0])).value.round(7).tolist()
        [4.1334269]
        """
        v, q = 0.25 * np.asarray(bulge_rad, dtype=np.float64), self._tangent_ratio
        width = np.cos(v) ** 2 + (q * np.sin(v)) ** 2
        widening = 0.25 * (q * q - 1.0) * np.sin(2.0 * v)
        rate = 0.5 * self.chambers * q
        return Jet(
            2.0 * self.chambers * np.arctan(q * np.tan(v)),
            rate / width,
            -rate * widening / width**2,
        )

    def bulge_of_angle(self, angle_rad: npt.ArrayLike) -> Array:
        """The bulge δ of bending angles of any shape; the inverse of `angle`.

        Examples
        --------
        >>> zhao = BulgeGeometry(35.0, 8.0, 2.0, 16.0, 160.0, 13)
        >>> zhao.bulge_of_angle([2.88]).round(7).tolist()
        [0.7012671]
        """
        share = np.asarray(angle_rad, dtype=np.float64) / (2.0 * self.chambers)
        bulge: Array = 4.0 * np.arctan(np.tan(share) / self._tangent_ratio)
        return bulge

    def area(self, bulge_rad: Array) -> Jet:
        """A(δ) = R²·(δ − sin δ)/2 with R = (h − h_a)/(2 sin(δ/2)), in mm².

        The area between wall and chord, that is Eq 15 integrated over the chord.

        Examples
        --------
        >>> zhao = BulgeGeometry(35.0, 8.0, 2.0, 16.0, 160.0, 13)
        >>> zhao.area(np.array([1.0])).value.round(4).tolist()
        [62.8498]
        """
        b = np.asarray(bulge_rad, dtype=np.float64)
        g, g1, g2 = _SEGMENT(b), _SEGMENT.deriv()(b), _SEGMENT.deriv(2)(b)
        lam = strain(b)
        x, x1, x2 = 1.0 + lam.value, lam.slope, lam.curvature
        scale = self.chord_mm**2 / 12.0
        return Jet(
            scale * g * x**2,
            scale * (g1 * x**2 + 2.0 * g * x * x1),
            scale * (g2 * x**2 + 4.0 * g1 * x * x1 + 2.0 * g * (x1**2 + x * x2)),
        )

    def column_moment(self, angle_rad: Array) -> tuple[Array, Array]:
        """∂E/∂Φ and ∂²E/∂Φ² of the column for C10 = 1 and C20 = 1, each of shape (2, m).

        The column bends about its far face, so that the layer at y is stretched by 1 + y·Φ/l:
        E = l·∫W(1 + yΦ/l)dy over 0…a, per unit width.
        """
        y = 0.5 * self.column_mm * (_NODES + 1.0)
        weights = 0.5 * self.column_mm * _WEIGHTS
        layers = np.multiply.outer(np.asarray(angle_rad), y / self.length_mm)
        _, stress, tangent = yeoh_energy(layers)
        return stress @ (weights * y), tangent @ (weights * y**2 / self.length_mm)

    def wall_energy(self, bulge_rad: Array) -> tuple[Array, Array, Array]:
        """V = 2N·t·(h − h_a)·W(λ(δ)), Eq 18, and its two derivatives by δ, each (2, m)."""
        lam = strain(bulge_rad)
        energy, stress, tangent = yeoh_energy(lam.value)
        area = 2.0 * self.chambers * self.wall_mm * self.chord_mm
        curvature = tangent * lam.slope**2 + stress * lam.curvature
        return area * energy, area * stress * lam.slope, area * curvature


def pressure_terms(geometry: BulgeGeometry, bulge_rad: Array) -> tuple[Array, Array]:
    """The pressure that holds a bulge, by virtual work, for each of its three causes alone.

    2N·P·dA/dδ = dV/dδ + (∂E/∂Φ + ∂S/∂Φ)·dΦ/dδ  with  S = ½·(k/w)·(a·Φ/2)²

    The pressure is linear in the material and the spring: P = C10·p₁ + C20·p₂ + (k/w)·p₃.

    Parameters
    ----------
    geometry
        Chambers and column.
    bulge_rad
        δ from 0 to `LARGEST_BULGE_RAD`, shape (m,).

    Returns
    -------
    terms : ndarray
        p₁, p₂ in kPa per MPa and p₃ in kPa per N/mm² , shape (3, m).
    slopes : ndarray
        dp/dδ, shape (3, m).

    Source: the energies are those of Zhao et al. 2021, Eq 18 to 20, repaired: the column bends
    instead of stretching with the wall, the spring depends on Φ, and work balances for every small
    motion instead of in total (Eq 21).
    """
    phi, area = geometry.angle(bulge_rad), geometry.area(bulge_rad)
    _, wall, wall_rate = geometry.wall_energy(bulge_rad)
    column, column_rate = geometry.column_moment(phi.value)
    arm = 0.25 * geometry.column_mm**2
    moment = np.vstack([column, arm * phi.value])
    moment_rate = np.vstack([column_rate, np.full_like(phi.value, arm)])
    nothing = np.zeros_like(phi.value)
    force = np.vstack([wall, nothing]) + moment * phi.slope
    force_rate = (
        np.vstack([wall_rate, nothing]) + moment_rate * phi.slope**2 + moment * phi.curvature
    )
    swept = 2.0 * geometry.chambers * area.slope / _KPA_PER_MPA
    terms: Array = force / swept
    slopes: Array = force_rate / swept - terms * area.curvature / area.slope
    return terms, slopes


@lru_cache(maxsize=16)
def tabulated_terms(geometry: BulgeGeometry) -> tuple[Array, Array, Array]:
    """δ from 0 to the half circle, and `pressure_terms` there: (g,), (3, g) and (3, g)."""
    bulge = np.linspace(0.0, LARGEST_BULGE_RAD, _GRID)
    terms, slopes = pressure_terms(geometry, bulge)
    for table in (bulge, terms, slopes):
        table.setflags(write=False)
    return bulge, terms, slopes
