"""How fast a law of second order moves, and which of its terms are too fast to be seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.models.second_order import Law, Order

Array = npt.NDArray[np.float64]

UNSEEN_PERIODS = 0.1
"""A mode that dies out within a tenth of the sampling interval cannot be seen in the samples."""


@dataclass(frozen=True)
class Speeds:
    """How fast a motion M·ẍ + N·ẋ + Q·x is at one input; None of what it does not have.

    Attributes
    ----------
    time_constant_s
        N/Q.
    natural_frequency_hz
        √(Q/M)/2π.
    damping_ratio
        N/2√(QM); below one the motion rings.
    """

    time_constant_s: float | None = None
    natural_frequency_hz: float | None = None
    damping_ratio: float | None = None

    def named(self, at: str = "") -> dict[str, tuple[float, str]]:
        """Name → (value, unit) of what there is.

        Parameters
        ----------
        at
            End of the names, which says at which input.
        """
        rows = (
            ("time_constant", self.time_constant_s, "s"),
            ("natural_frequency", self.natural_frequency_hz, "Hz"),
            ("damping_ratio", self.damping_ratio, "1"),
        )
        return {f"{name}{at}": (value, unit) for name, value, unit in rows if value is not None}


def speeds_of(law: Law, u: float) -> Speeds:
    """Those of a law of second order; of a law without a spring there are none.

    Parameters
    ----------
    law
        The coefficients.
    u
        The input.
    """
    damping, stiffness, _ = (float(c[0]) for c in law.coefficients(np.array([u])))
    if stiffness <= 0:
        return Speeds()
    settling_s = damping / stiffness if damping > 0 else None
    if not law.mass > 0:
        return Speeds(settling_s)
    return Speeds(
        settling_s,
        float(np.sqrt(stiffness / law.mass)) / (2 * np.pi),
        damping / (2.0 * float(np.sqrt(stiffness * law.mass))),
    )


def faded(law: Law, order: Order, period_s: float, inputs: Array) -> tuple[Order, str] | None:
    """The lower order to continue with when the fast mode cannot be seen, and why.

    Parameters
    ----------
    law
        The coefficients.
    order
        Its order now.
    period_s
        Sampling interval.
    inputs
        Inputs over the fitted range, shape (m,).
    """
    damping, stiffness, _ = law.coefficients(inputs)
    with np.errstate(divide="ignore", invalid="ignore"):
        inertia_s = float(np.max(law.mass / damping))
        settling_s = float(np.max(damping / stiffness))
    if order == "second" and inertia_s < UNSEEN_PERIODS * period_s:
        return "first", _reason("the inertia dies out", inertia_s, period_s)
    if order == "first" and settling_s < UNSEEN_PERIODS * period_s:
        return "static", _reason("the motion settles", settling_s, period_s)
    return None


def _reason(what: str, duration_s: float, period_s: float) -> str:
    limit_s = UNSEEN_PERIODS * period_s
    how = f"within {duration_s:.2g} s" if duration_s > 1e-3 * period_s else "at once"
    return f"{what} {how}, and less than {limit_s:.2g} s cannot be seen at this sampling interval"
