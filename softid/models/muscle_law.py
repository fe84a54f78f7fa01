"""Ru's law of the bending pneumatic muscle at fixed parameters, as the kernels run it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.affine_blocks import MUSCLE
from softid.kernels.muscle import KPA_PER_BAR, coefficient_derivatives, coefficients, pack
from softid.kernels.small_matrix import LANES
from softid.models.division import held
from softid.models.second_order import AffineForm, Law

Array = npt.NDArray[np.float64]

NAMES = ("M", "a1", "b1", "c1", "a2", "b2", "c2")
"""The parameters, in the order of θ."""

_PER_KPA = np.array([1.0, 1.0, 1.0 / KPA_PER_BAR, 1.0, 1.0, 1.0 / KPA_PER_BAR, 1.0])
_BY_THETA = np.diag(_PER_KPA)
_BY_MASS = np.eye(len(NAMES))[0]
"""Factors from θ to what the kernels take, with b1 and b2 per kPa, and the derivatives of that and
of the mass by θ."""


class MuscleLaw(Law):
    """Coefficients of Ru's law at fixed parameters; the input is pressure in kPa."""

    def __init__(self, theta: Array) -> None:
        self._theta = theta
        self.mass = float(theta[0])
        self.mass_by = _BY_MASS

    def coefficients(self, u: Array) -> tuple[Array, Array, Array]:
        """N, Q and P at pressures of shape (L,)."""
        found: tuple[Array, Array, Array] = coefficients(held(u), self._theta)
        return found

    def derivatives(self, u: Array) -> tuple[Array, Array, Array]:
        """Derivatives of N, Q and P by the seven parameters, each of shape (L, 7)."""
        found: tuple[Array, Array, Array] = coefficient_derivatives(u / KPA_PER_BAR, self._theta)
        return found

    def packed(self, u: Array, *, derivatives: bool) -> tuple[Array, Array]:
        """All coefficients in one compiled pass; see `Law.packed`."""
        packed = np.empty((len(u), 3, 4))
        by = np.empty((len(u) if derivatives else 0, 3, 4, LANES))
        pack(np.ascontiguousarray(u), self._theta, packed, by)
        return packed, by[..., None, :]

    def affine(self) -> AffineForm:
        """The same law with exponents per kPa."""
        theta = np.ones(self._theta.size + 1)
        np.multiply(self._theta, _PER_KPA, out=theta[:-1])
        return AffineForm(MUSCLE, theta, _BY_THETA)

    def exponent_rate(self) -> float:
        """The larger of b1 and b2, per kPa."""
        return float(max(abs(self._theta[2]), abs(self._theta[5]))) / KPA_PER_BAR
