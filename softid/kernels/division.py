r"""How many steps each sampling interval needs for an error of 1e-4 of the motion, by either rule.

The limits were found on m·ẍ + n·ẋ + q·x = f with f jumping within one interval, over damping ratios
ζ = n/2√(mq) from 0.02 to 100, against the same law in 64 times as many steps; ω² = q/m, d = n/m.
Beside the rate of the motion, the coefficients must not bend too much within a step.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

Array = npt.NDArray[np.float64]
Counts = npt.NDArray[np.int16]

MAX_PHASE_PER_STEP = 0.8
"""Largest product of step and rate of motion for the Radau rule."""

RINGING = 0.15
"""Damping ratio below which oscillations last so long that phase errors add up to more; the Radau
rule's steps are then shorter by (ζ/0.15)^(1/5)."""

STIFF_RATIO = 2000.0
STIFF_EXPONENT = 0.28
"""An overdamped fast mode is resolved with a step of 0.8·(fast/slow)^0.28 of its time constant up
to fast/slow = 2000: from the error of the rule's R(z) against exp(z), the fast mode's share of the
error then stays below 1e-4 of the motion."""

RK4_MAX_PHASE = 0.3
RK4_MAX_DECAY = 1.5
"""Largest h·ω and h·d at which the explicit rule is used at all."""

RK4_SHARE = 0.0845
"""Largest h²·ω·d of the explicit rule: its error in a jump is 0.007·(h²·ω·d)² of the motion."""

RK4_RINGING = 30.0
"""Largest (hω)⁴/ζ of the explicit rule, inverse: oscillations err by 0.0015·(hω)⁴/ζ."""

LEAST_RATIO = 0.01
MAX_EXPONENT_PER_STEP = 0.8
RK4_MAX_EXPONENT = 0.5
"""Largest change of an exponent of the coefficients within one step of either rule."""

MAX_SUBSTEPS = 64


@njit(nogil=True, error_model="numpy")
def radau_rate(mass: float, damping: float, stiffness: float) -> float:
    """Speed of the motion that a step of the Radau rule must resolve; 0 where it is not finite.

    |λ| when the law oscillates. When it is overdamped a jump of the force excites the fast mode to
    slow/fast of the whole motion only, so a stiff mode may be stepped over the more boldly the
    stiffer it is, and beyond `STIFF_RATIO` entirely: the rule damps it as nature does.
    """
    discriminant = damping * damping - 4.0 * mass * stiffness
    if mass > 0.0 and discriminant < 0.0:
        omega = np.sqrt(stiffness / mass)
        ratio = max(0.5 * damping / (mass * omega), LEAST_RATIO)
        rate = omega if ratio >= RINGING else omega * (RINGING / ratio) ** 0.2
    else:
        slow = 2.0 * stiffness / (damping + np.sqrt(max(discriminant, 0.0)))
        stiff = stiffness / mass / (slow * slow) if mass > 0.0 else np.inf
        rate = slow * stiff ** (1.0 - STIFF_EXPONENT) if stiff < STIFF_RATIO else slow
    return rate if np.isfinite(rate) else 0.0


@njit(nogil=True, error_model="numpy")
def rk4_rate(mass: float, damping: float, stiffness: float) -> float:
    """Steps per second of the explicit rule; infinite where it must not be used."""
    if not (mass > 0.0 and stiffness >= 0.0 and damping >= 0.0):
        return np.inf
    omega, decay = np.sqrt(stiffness / mass), damping / mass
    ratio = max(0.5 * decay / omega, LEAST_RATIO) if omega > 0.0 else np.inf
    rate = max(omega / RK4_MAX_PHASE, decay / RK4_MAX_DECAY, np.sqrt(omega * decay / RK4_SHARE))
    rate = max(rate, omega * np.sqrt(np.sqrt(RK4_RINGING / ratio)))
    return rate if np.isfinite(rate) else np.inf


@njit(nogil=True, error_model="numpy")
def _count(wanted: float, bend: float) -> int:
    most = max(wanted, bend)
    if not np.isfinite(most):
        return 1
    return int(min(max(np.ceil(most), 1.0), MAX_SUBSTEPS))


@njit(cache=True, nogil=True, error_model="numpy")
def count_steps(
    mass: float,
    damping: Array,
    stiffness: Array,
    time_s: Array,
    bend: Array,
    radau: Counts,
    rk4: Counts,
) -> tuple[float, float]:
    """Steps of every sampling interval for both rules.

    Parameters
    ----------
    mass
        m ≥ 0.
    damping, stiffness
        n and q at the samples, each of shape (n,).
    time_s
        Sample times, shape (n,).
    bend
        Change of the coefficients' exponents over every interval, shape (n − 1,).
    radau, rk4
        Receive the counts, each of shape (n − 1,).

    Returns
    -------
    radau, rk4
        Sums of the counts; the second is infinite where the explicit rule must not be used.
    """
    total, explicit = 0.0, 0.0
    rate = radau_rate(mass, damping[0], stiffness[0])
    bold = rk4_rate(mass, damping[0], stiffness[0])
    for i in range(radau.size):
        next_rate = radau_rate(mass, damping[i + 1], stiffness[i + 1])
        next_bold = rk4_rate(mass, damping[i + 1], stiffness[i + 1])
        duration = time_s[i + 1] - time_s[i]
        phase = duration * max(rate, next_rate) / MAX_PHASE_PER_STEP
        radau[i] = _count(phase, bend[i] / MAX_EXPONENT_PER_STEP)
        total += radau[i]
        wanted = max(duration * max(bold, next_bold), bend[i] / RK4_MAX_EXPONENT)
        rk4[i] = _count(wanted, 1.0)
        explicit += rk4[i] if wanted <= MAX_SUBSTEPS else np.inf
        rate, bold = next_rate, next_bold
    return total, explicit
