"""Arc geometry of a bending muscle: distance of the ends ↔ contraction ↔ bending angle."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np
import numpy.typing as npt

from softid.errors import InputError, UsageError
from softid.models.monotone import invert_monotone

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

_SERIES_BELOW = 0.5
"""Argument below which the series are taken: the closed form of the slope loses a digit there, and
more and more below."""

_TERMS = 9
"""Terms of each series; the next one is below 1e-22 where they are taken."""

_SINC = np.polynomial.Polynomial([(-1) ** k / factorial(2 * k + 1) for k in range(_TERMS)])
_SINC_SLOPE_BY_U = np.polynomial.Polynomial(
    [(-1) ** k * 2 * k / factorial(2 * k + 1) for k in range(1, _TERMS + 1)]
)
"""sin(u)/u and its slope over u, as functions of u²."""


def sinc(u: Array) -> Array:
    """sin(u)/u, 1 at u = 0, to full relative precision."""
    small = np.abs(u) < _SERIES_BELOW
    safe = np.where(small, 1.0, u)
    value: Array = np.where(small, _SINC(u * u), np.sin(safe) / safe)
    return value


def sinc_slope(u: Array) -> Array:
    """d/du sin(u)/u = (cos u − sinc u)/u, by its series near u = 0, where that cancels."""
    small = np.abs(u) < _SERIES_BELOW
    safe = np.where(small, 1.0, u)
    closed = (np.cos(safe) - np.sin(safe) / safe) / safe
    value: Array = np.where(small, u * _SINC_SLOPE_BY_U(u * u), closed)
    return value


@dataclass(frozen=True)
class ArcGeometry:
    """A muscle bent to a circular arc: one side keeps its length L0, the other shortens to L.

    x = L0 − L,  θ = x/d,  D = (L0 + L)/θ · sin(θ/2) = (L0 − x/2) · sinc(θ/2)

    with sinc(u) = sin(u)/u. D is the straight distance between the two ends.

    Attributes
    ----------
    fixed_length_mm
        L0, length of the side that neither extends nor contracts.
    diameter_mm
        d, distance between the fixed and the deformable side. The paper's text calls d a radius,
        but its Eq 1 and Eq 2 agree with each other only for the diameter.

    Raises
    ------
    UsageError
        A length is not positive.

    Source: Ru et al. 2019, doi 10.1007/s11432-018-9709-x, Eq 1 to 3.

    Examples
    --------
    >>> arc = ArcGeometry(fixed_length_mm=150.0, diameter_mm=20.0)
    >>> arc.distance_mm([10.0, 30.0, 60.0]).round(6).tolist()
    [143.494296, 122.694977, 79.799599]
    """

    fixed_length_mm: float
    diameter_mm: float

    def __post_init__(self) -> None:
        for name in ("fixed_length_mm", "diameter_mm"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise UsageError(
                    f"{name} is not a positive length",
                    where="arc geometry",
                    value=value,
                    remedy="measure it on the actuator and give it in mm",
                )

    @property
    def largest_contraction_mm(self) -> float:
        """End of the branch on which D falls strictly: θ = min(2π, 2·L0/d).

        Beyond x = L0 the deformable side would have a negative length; the equations still hold
        there, so an optimiser may pass through.
        """
        return float(min(2.0 * np.pi * self.diameter_mm, 2.0 * self.fixed_length_mm))

    @property
    def longest_distance_mm(self) -> float:
        """Largest D that any arc reaches; it belongs to a slight extension, x < 0."""
        # The slope falls from 0 < dD/dx near θ = −2π through zero to −1/2 at θ = 0.
        low, high = -2.0 * np.pi * self.diameter_mm, 0.0
        for _ in range(100):
            middle = 0.5 * (low + high)
            rising = float(self.distance_slope(middle)) > 0
            low, high = (middle, high) if rising else (low, middle)
        return float(self.distance_mm(0.5 * (low + high)))

    def angle_rad(self, contraction_mm: npt.ArrayLike) -> Array:
        """Bending angle θ = x/d of contractions of any shape."""
        return np.asarray(contraction_mm, dtype=np.float64) / self.diameter_mm

    def length_mm(self, contraction_mm: npt.ArrayLike) -> Array:
        """Length of the deformable side, L = L0 − x."""
        return self.fixed_length_mm - np.asarray(contraction_mm, dtype=np.float64)

    def contraction_from_length_mm(self, length_mm: npt.ArrayLike) -> Array:
        """Contraction x = L0 − L of lengths of any shape."""
        return self.fixed_length_mm - np.asarray(length_mm, dtype=np.float64)

    def distance_mm(self, contraction_mm: npt.ArrayLike) -> Array:
        """Distance of the ends, D = (L0 − x/2)·sinc(θ/2), of contractions of any shape."""
        x = np.asarray(contraction_mm, dtype=np.float64)
        value: Array = (self.fixed_length_mm - 0.5 * x) * sinc(0.5 * x / self.diameter_mm)
        return value

    def distance_slope(self, contraction_mm: npt.ArrayLike) -> Array:
        """dD/dx = −½·sinc(θ/2) + (L0 − x/2)·sinc′(θ/2)/(2d); −½ at rest.

        Noise in a contraction that was computed from D is therefore twice that of D at rest.
        """
        x = np.asarray(contraction_mm, dtype=np.float64)
        u = 0.5 * x / self.diameter_mm
        arm = (self.fixed_length_mm - 0.5 * x) / (2.0 * self.diameter_mm)
        value: Array = -0.5 * sinc(u) + arm * sinc_slope(u)
        return value

    def contraction_from_distance_mm(self, distance_mm: npt.ArrayLike) -> Array:
        """Contraction x of measured distances, on the branch where D falls strictly.

        Parameters
        ----------
        distance_mm
            Distances of any shape; NaN stays NaN.

        Returns
        -------
        ndarray
            Contractions in mm. A distance above L0, as noise gives at rest, is continued along
            the tangent at rest, x = 2·(L0 − D) < 0: the extension branch itself is two-valued,
            and holding D at L0 instead would bias the lowest level upward. `continued` tells
            which values these are.

        Raises
        ------
        InputError
            A distance is not positive, or longer than any arc of this geometry.

        Examples
        --------
        >>> arc = ArcGeometry(fixed_length_mm=150.0, diameter_mm=20.0)
        >>> arc.contraction_from_distance_mm([143.494296, 150.1]).round(5).tolist()
        [10.0, -0.2]
        """
        distance = np.asarray(distance_mm, dtype=np.float64)
        self._check_distance(distance)
        x = np.full(distance.shape, np.nan)
        above = self.continued(distance)
        x[above] = 2.0 * (self.fixed_length_mm - distance[above])
        bent = np.isfinite(distance) & ~above
        x[bent] = invert_monotone(
            self.distance_mm,
            self.distance_slope,
            distance[bent],
            0.0,
            self.largest_contraction_mm,
        )
        return x

    def continued(self, distance_mm: npt.ArrayLike) -> BoolArray:
        """Which distances exceed L0, so that the contraction is the tangent's and not the arc's."""
        return np.asarray(distance_mm, dtype=np.float64) > self.fixed_length_mm

    def _check_distance(self, distance: Array) -> None:
        with np.errstate(invalid="ignore"):
            wrong = (distance <= 0) | (distance > self.longest_distance_mm) | np.isinf(distance)
        if not wrong.any():
            return
        worst = distance[wrong]
        raise InputError(
            f"{int(wrong.sum())} distances lie outside (0, {self.longest_distance_mm:.6g}] mm, "
            f"the range of an arc with L0 = {self.fixed_length_mm:g} mm and "
            f"d = {self.diameter_mm:g} mm",
            where="distance",
            value=float(worst.flat[0]),
            remedy="check the unit, the sensor zero and the two lengths of the geometry",
        )
