"""How fast a law of second order moves, and which of its terms are too fast to be seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.models.second_order import Law, Order

Array = npt.NDArray[np.float64]

UNSEEN_PERIODS = 0.1
"""A mode that dies out within a tenth of the sampling interval cannot be seen in the samples."""

SWING_LEVELS = 9
"""Inputs over the fitted range at which the swing is looked at."""

TOO_LATE = 30.0
"""A spring that would bring the motion back in more lengths of the longest log is none: by the end
of that its force is a thirtieth of the damping's."""


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


def order_seen(law: Law, order: Order, period_s: float, inputs: Array) -> tuple[Order, str] | None:
    """The lower order to continue with when the samples cannot show the motion, and why.

    First order when M/N is far below the sampling interval, static when N/Q is. Weakly damped an
    inertia lasts, but when it swings more than once in two samples everywhere, the samples show an
    alias of any frequency: a staircase sampled once a second was fitted with a mass that was not
    there.

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
    alias = _alias(law, period_s, inputs) if order == "second" else None
    return ("first", alias) if alias else None


def returning_late(law: Law, u: float, longest_s: float) -> str | None:
    """Why a spring is none: it would bring the motion back only long after the logs have ended.

    What pushes a drive about passes for such a spring, and what is missing has to lean on it.

    Parameters
    ----------
    law
        The coefficients.
    u
        The input.
    longest_s
        Length of the longest log.
    """
    damping, stiffness, _ = (float(c[0]) for c in law.coefficients(np.array([u])))
    if not stiffness > 0.0 or damping / stiffness <= TOO_LATE * longest_s:
        return None
    return (
        f"the motion would come back in {damping / stiffness:.2g} s, and the logs end after "
        f"{longest_s:.2g} s"
    )


def _alias(law: Law, period_s: float, inputs: Array) -> str | None:
    """Why the samples show no swing; None where they do at some input, or where none rings."""
    slowest_hz = float("inf")
    for level in np.linspace(inputs[0], inputs[-1], SWING_LEVELS).tolist():
        found = speeds_of(law, level)
        swing_hz, ratio = found.natural_frequency_hz, found.damping_ratio
        if swing_hz is None or ratio is None or ratio >= 1.0:
            return None
        slowest_hz = min(slowest_hz, swing_hz)
    shown_hz = 0.5 / period_s
    if slowest_hz <= shown_hz:
        return None
    return (
        f"the motion would swing at {slowest_hz:.2g} Hz, and more than {shown_hz:.2g} Hz cannot be "
        "seen at this sampling interval"
    )


def _reason(what: str, duration_s: float, period_s: float) -> str:
    limit_s = UNSEEN_PERIODS * period_s
    how = f"within {duration_s:.2g} s" if duration_s > 1e-3 * period_s else "at once"
    return f"{what} {how}, and less than {limit_s:.2g} s cannot be seen at this sampling interval"
