"""The times of a motion at the usual input."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from softid.diagnosis.refit.candidates import Candidate

LEAST_DAMPING_RATIO = 0.7
"""A law that is damped less swings, which no chain of lags does; noise and what the base gets wrong
let two equal poles look a little like it."""


class UsualLaw(NamedTuple):
    """A law of motion with the median of its coefficients over the logs.

    Attributes
    ----------
    mass, damping, stiffness
        M, N and K.
    """

    mass: float
    damping: float
    stiffness: float

    @property
    def inertia_s(self) -> float:
        """Time that the inertia takes, M/N."""
        return self.mass / self.damping

    @property
    def damping_s(self) -> float:
        """Time that the damping takes, N/K."""
        return self.damping / self.stiffness

    @property
    def swing_s(self) -> float:
        """Time of an undamped swing over 2π, √(M/K)."""
        return float(np.sqrt(self.mass / self.stiffness))

    @property
    def poles_s(self) -> tuple[float, float] | None:
        """Times T₁ ≥ T₂ of the two poles, N/K = T₁ + T₂ and M/K = T₁T₂.

        A damping ratio ζ between `LEAST_DAMPING_RATIO` and 1 has two equal ones, N/2K, whose
        product is ζ²M/K. None where the law swings or has no spring.
        """
        if self.stiffness <= 0.0:
            return None
        ratio = self.damping / (2.0 * np.sqrt(self.mass * self.stiffness))
        if ratio < LEAST_DAMPING_RATIO:
            return None
        apart = np.sqrt(max(1.0 - ratio**-2, 0.0))
        return 0.5 * self.damping_s * (1.0 + apart), 0.5 * self.damping_s * (1.0 - apart)


def usual_law(candidate: Candidate) -> UsualLaw | None:
    """The law of a candidate at the median of its coefficients; None without one.

    Parameters
    ----------
    candidate
        The candidate.
    """
    problem = candidate.problem
    law = problem.model.motion_law(problem.theta(candidate.minimum.point))
    if law is None:
        return None
    inputs = np.concatenate([segment.input for segment in problem.segments])
    damping, stiffness, _ = (float(np.median(c)) for c in law.coefficients(inputs))
    return UsualLaw(law.mass, max(damping, 1e-300), stiffness)
