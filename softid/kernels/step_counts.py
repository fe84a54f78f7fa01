r"""How many steps each sampling interval needs for an error of 1e-4 of the motion, by either rule.

The limits were found on m·ẍ + n·ẋ + q·x = f with f jumping within one interval, over damping ratios
ζ = n/2√(mq) from 0.02 to 100, against the same law in 64 times as many steps; ω² = q/m, d = n/m.
Beside the rate of the motion, the coefficients must not bend too much within a step.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels import exponential
from softid.kernels.cache_invalidation import follow_sources
from softid.kernels.decorators import kernel
from softid.kernels.exponential import NO_REORDERING

Array = npt.NDArray[np.float64]
Counts = npt.NDArray[np.int16]

MAX_PHASE_PER_STEP = 0.8
"""Largest product of step and rate of motion for the Radau rule."""

RINGING = 0.15
"""Damping ratio below which oscillations last so long that phase errors add up to more; the Radau
rule's steps are then shorter by (ζ/0.15)^(1/4), down to half."""

MOST_RINGING = 2.0
"""Largest factor by which ringing shortens the Radau rule's steps: reached at a damping ratio of
0.15/16 = 0.01."""

STIFF_RATIO = 200.0
"""An overdamped fast mode is resolved with a step of 0.8·(fast/slow)^¼ of its time constant up to
fast/slow = 200. Beyond, it carries so little of the motion after an input that is straight over the
step that stepping over it errs by less than 5e-5."""

RK4_MAX_PHASE = 0.3
"""Largest h·ω at which the explicit rule is used at all."""

RK4_MAX_DECAY = 1.5
"""Largest h·d at which the explicit rule is used: it is unstable from 2.79 on."""

RK4_SHARE = 0.0845
"""Largest h²·ω·d of the explicit rule: its error in a jump is 0.007·(h²·ω·d)² of the motion."""

RK4_RINGING = 30.0
"""Largest (hω)⁴/ζ of the explicit rule, inverse: oscillations err by 0.0015·(hω)⁴/ζ."""

LEAST_RATIO = 0.01
"""Least d/ω for which the explicit rule's steps are shortened, a damping ratio of 0.005: without
any damping they would have no length at all."""

MAX_EXPONENT_PER_STEP = 0.8
"""Largest change of an exponent of the coefficients within a step of the Radau rule: 2.2 times."""

RK4_MAX_EXPONENT = 0.5
"""Largest change of an exponent of the coefficients within a step of the explicit rule: 1.6
times."""

BRIEF = 1e-3
"""Product of an interval and the rate of the motion below which the coefficients may bend as they
like: nothing moves meanwhile, as in a jump of the input."""

MAX_SUBSTEPS = 64
"""Steps of one sampling interval at most: where the explicit rule wants more it is not used, and
the Radau rule, which is stable at any step, takes so many and is less exact."""

_HUGE = 1e300
"""Least rate that is taken for infinite, and asks for one step, as one that is no number does."""


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING, forceinline=True)
def _radau_rate(mass, damping, stiffness):  # type: ignore[no-untyped-def]
    """Steps per second of the Radau rule.

    They resolve |λ| when the law oscillates. When it is overdamped a jump of the force excites the
    fast mode to slow/fast of the whole motion only, so a stiff mode may be stepped over the more
    boldly the stiffer it is, and beyond `STIFF_RATIO` entirely: the rule damps it as nature does.
    """
    discriminant = damping * damping - 4.0 * mass * stiffness
    omega = np.sqrt(stiffness / mass)
    longer = max(RINGING * 2.0 * mass * omega / max(damping, 1e-300), 1.0)
    oscillating = omega * min(np.sqrt(np.sqrt(longer)), MOST_RINGING)
    slow = 2.0 * stiffness / (damping + np.sqrt(max(discriminant, 0.0)))
    faster = omega / slow  # the square root of fast/slow
    bold = slow * (faster * np.sqrt(faster) if faster * faster < STIFF_RATIO else 1.0)
    return (oscillating if discriminant < 0.0 else bold) / MAX_PHASE_PER_STEP


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING, forceinline=True)
def _rk4_rate(mass, damping, stiffness):  # type: ignore[no-untyped-def]
    """Steps per second of the explicit rule; not finite where it must not be used."""
    omega, decay = np.sqrt(stiffness / mass), damping / mass
    ringing = RK4_RINGING * 2.0 * omega / max(decay, LEAST_RATIO * omega)
    rate = max(omega / RK4_MAX_PHASE, decay / RK4_MAX_DECAY)
    rate = max(rate, np.sqrt(omega * decay / RK4_SHARE))
    return max(rate, omega * np.sqrt(np.sqrt(ringing)))


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _rates(mass: float, damping: Array, stiffness: Array, radau: Array, rk4: Array) -> None:
    for i in range(radau.size):
        radau[i] = _radau_rate(mass, damping[i], stiffness[i])
        rk4[i] = _rk4_rate(mass, damping[i], stiffness[i])


@njit(nogil=True, error_model="numpy", fastmath=NO_REORDERING)
def _counts(
    rate: Array, time_s: Array, u: Array, bend: float, limit: float, counts: Counts
) -> tuple[int, int]:
    """Counts from 1 to MAX_SUBSTEPS; what is not finite asks for one step.

    Returns their sum and how many intervals want more: whole numbers, which a loop that takes
    several intervals at a time may add up in any order.
    """
    total, beyond = 0, 0
    for i in range(counts.size):
        a = rate[i] if rate[i] < _HUGE else 0.0
        b = rate[i + 1] if rate[i + 1] < _HUGE else 0.0
        wanted = max(a, b) * (time_s[i + 1] - time_s[i])
        turn = abs(u[i + 1] - u[i]) * bend
        turn = turn if turn < _HUGE and wanted > BRIEF else 0.0
        wanted = max(wanted, turn / limit)
        beyond += 1 if wanted > MAX_SUBSTEPS else 0
        steps = min(max(np.ceil(wanted), 1.0), MAX_SUBSTEPS)
        total += int(steps)
        counts[i] = np.int16(steps)
    return total, beyond


@kernel
def count_steps(
    mass: float,
    damping: Array,
    stiffness: Array,
    time_s: Array,
    u: Array,
    bend: float,
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
    time_s, u
        Sample times and input, each of shape (n,).
    bend
        How much the coefficients' exponents change with the input.
    radau, rk4
        Receive the counts, each of shape (n − 1,).

    Returns
    -------
    radau, rk4
        Sums of the counts; the second is infinite where the explicit rule must not be used.
    """
    implicit, explicit = np.empty(damping.size), np.empty(damping.size)
    _rates(mass, damping, stiffness, implicit, explicit)
    total, _ = _counts(implicit, time_s, u, bend, MAX_EXPONENT_PER_STEP, radau)
    total_explicit, unsafe = _counts(explicit, time_s, u, bend, RK4_MAX_EXPONENT, rk4)
    for rate in explicit:
        unsafe += 0 if rate < _HUGE else 1
    return float(total), float(total_explicit) if unsafe == 0 else np.inf


follow_sources(count_steps, (exponential,))
