"""How far, how fast and how unevenly an actuator moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.motion import residual_context

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

NEARLY_ALL = 0.95
"""Share of a motion whose positions, speeds and accelerations lie within a range that holds it."""


@dataclass(frozen=True)
class MotionRange:
    """Between which positions, how fast and with which accelerations an actuator moves.

    Attributes
    ----------
    low, high
        Least and largest position.
    speed, acceleration
        The largest, either way.
    """

    low: float
    high: float
    speed: float
    acceleration: float

    @classmethod
    def of(cls, motion: Array) -> MotionRange:
        """The range of a motion.

        Parameters
        ----------
        motion
            From `motion_of`.
        """
        x, v, a = motion
        return cls(float(x.min()), float(x.max()), float(abs(v).max()), float(abs(a).max()))

    def holds(self, motion: Array) -> BoolArray:
        """Which positions, speeds and accelerations lie within, shape (3, n).

        Parameters
        ----------
        motion
            Of whichever model.
        """
        x, v, a = motion
        within = (self.low <= x) & (x <= self.high), abs(v) <= self.speed
        return np.array([*within, abs(a) <= self.acceleration])

    def holds_nearly_all(self, motion: Array) -> bool:
        """Whether nearly all of a motion lies within.

        In a row of sines the fast ones may go as far and as fast as the slow ones, but not as
        evenly.

        Parameters
        ----------
        motion
            As in `holds`.
        """
        return bool((np.mean(self.holds(motion), axis=1) >= NEARLY_ALL).all())


def motion_of(model: Candidate) -> Array | None:
    """Positions, speeds and accelerations of a model, shape (3, n); None where it runs away.

    Parameters
    ----------
    model
        The model where it stands.
    """
    motions = residual_context(model)
    x, v = (np.concatenate([getattr(motion, name) for motion in motions]) for name in "xv")
    rates = [
        np.gradient(motion.v, motion.time_s) if motion.v.size > 1 else np.zeros_like(motion.v)
        for motion in motions
    ]
    found = np.array([x, v, np.concatenate(rates)])
    return found if np.isfinite(found).all() else None
