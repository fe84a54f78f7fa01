"""How fast a law of second order moves, and which of its terms are too fast to be seen."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.models.second_order import Law, Order

Array = npt.NDArray[np.float64]

UNSEEN_PERIODS = 0.1
"""A mode that dies out within a tenth of the sampling interval cannot be seen in the samples."""


def speeds(law: Law, u: float, u_unit: str | None = None) -> dict[str, tuple[float, str]]:
    """Time constant N/Q, natural frequency √(Q/M)/2π and damping ratio N/2√(QM) at one input.

    Parameters
    ----------
    law
        The coefficients.
    u
        The input.
    u_unit
        Its unit, to name the place; None when the coefficients are the same everywhere.
    """
    damping, stiffness, _ = (float(c[0]) for c in law.coefficients(np.array([u])))
    at = f"_at_{u:.0f}_{u_unit}" if u_unit else ""
    found: dict[str, tuple[float, str]] = {}
    if damping > 0:
        found[f"time_constant{at}"] = (damping / stiffness, "s")
    if law.mass > 0:
        found[f"natural_frequency{at}"] = (float(np.sqrt(stiffness / law.mass)) / (2 * np.pi), "Hz")
        found[f"damping_ratio{at}"] = (damping / (2.0 * float(np.sqrt(stiffness * law.mass))), "1")
    return found


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
