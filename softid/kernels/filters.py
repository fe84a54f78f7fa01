r"""Filters that are exact for an input that is straight between any, also irregular, times.

Before the first time the input is constant, so every filter begins settled. Each works in place on
the values of its input; ``step_s`` are the intervals between them.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]

ALIKE = 1e-11
"""Relative difference up to which two steps share what depends on their length."""

SMALL = 0.1
"""Exponent up to which eight terms of its series give e^x − 1 to a relative 3e-14."""

C2, C3, C4, C5 = 1 / 2, 1 / 6, 1 / 24, 1 / 120
C6, C7, C8 = 1 / 720, 1 / 5040, 1 / 40320
"""Coefficients of the last terms of the series of e^x − 1."""


HALVINGS = 50
"""Halvings of a step after which a time within it is known to rounding."""

MOST_PARTS = 4
"""Most parts of a step along a straight input: it passes a level fewer times."""

EASE = 0.5
"""A rate is taken to change by so large a share at most on the way to the middle of a step."""


@njit(nogil=True, error_model="numpy")
def growth_over(exponent: float) -> float:
    """e^x − 1; of a small x from its series, which takes a tenth of the time."""
    x = exponent
    if abs(x) > SMALL:
        return float(np.expm1(x))
    late = C5 + x * (C6 + x * (C7 + x * C8))
    return float(x * (1.0 + x * (C2 + x * (C3 + x * (C4 + x * late)))))


@njit(nogil=True, error_model="numpy")
def _relaxed(difference: float, slope: float, step_s: float, rate: float) -> float:
    """`lag_difference` of the rate 1/τ."""
    decayed = growth_over(-step_s * rate)
    return float(difference + (difference + slope / rate) * decayed)


@kernel
def lag_difference(difference: float, slope: float, step_s: float, tau_s: float) -> float:
    """Output minus input of τ ẏ + y = u after a step along a straight input.

    With d = y − u it is d⁺ = d e^{−h/τ} − s τ (1 − e^{−h/τ}).

    Parameters
    ----------
    difference
        d before the step.
    slope
        Slope s of the input.
    step_s
        Length h of the step.
    tau_s
        Time constant τ, positive.
    """
    return _relaxed(difference, slope, step_s, 1.0 / tau_s)


@njit(nogil=True, error_model="numpy")
def _alike(step_s: float, usual_s: float) -> bool:
    """Whether two steps differ by the rounding of their times only."""
    return abs(step_s - usual_s) <= ALIKE * step_s


@kernel
def lag(step_s: Array, values: Array, rising_s: float, falling_s: float) -> None:
    """First-order lag τ ẏ + y = u, with one τ where u > y and another where u < y.

    The difference y − u passes zero at most once along a straight input, since there it moves
    against the slope; the time constant changes at that instant,
    t* = τ ln(1 + d/(s τ)).

    Parameters
    ----------
    step_s
        Intervals, shape (n − 1,).
    values
        Input, shape (n,); overwritten by the output.
    rising_s, falling_s
        Time constants while the output follows upward and downward; not negative.
    """
    before = values[0]
    difference = 0.0
    usual = usual_rising = usual_falling = 0.0
    for k in range(step_s.size):
        now = values[k + 1]
        left = step_s[k]
        slope = (now - before) / left
        if not _alike(left, usual):
            usual = left
            usual_rising = np.expm1(-left / rising_s) if rising_s > 0.0 else -1.0
            usual_falling = np.expm1(-left / falling_s) if falling_s > 0.0 else -1.0
        rising = difference < 0.0 or (difference == 0.0 and slope > 0.0)
        tau = rising_s if rising else falling_s
        decayed = usual_rising if rising else usual_falling
        if rising_s != falling_s and difference != 0.0 and (slope < 0.0) == rising and slope != 0.0:
            passing = tau * np.log1p(difference / (slope * tau)) if tau > 0.0 else 0.0
            if passing < left:
                left -= passing
                difference = 0.0
                tau = falling_s if rising else rising_s
                decayed = np.expm1(-left / tau) if tau > 0.0 else -1.0
        difference = difference * (1.0 + decayed) + slope * tau * decayed
        values[k + 1] = now + difference
        before = now


@kernel
def lag_by_level(step_s: Array, values: Array, tau_s: float, growth: float, level: float) -> None:
    """First-order lag whose time constant depends on its output, τ(y) ẏ + y = u.

    With τ(y) = τ e^{g (y − y0)} the difference d = y − u obeys ḋ = −d/τ(y) − s along a straight
    input. With the rate λ = 1/τ,

        d⁺ = e^{−∫λ} d − s ∫ e^{−∫_t^h λ} dt.

    Each step takes the mean λ̄ along it by Simpson's rule, at the outputs that a lag with the rate
    known so far would have reached, and in the second integral what a slope of λ changes,
    −h² Δλ/(12 + 6x + 2x²) with x = λ̄h, which is right for small and for large x: an exponential
    integrator of order 3, exact where g is zero and stable however short τ is.

    Parameters
    ----------
    step_s
        Intervals, shape (n − 1,).
    values
        Input, shape (n,); overwritten by the output.
    tau_s
        Time constant τ at the level y0; not negative.
    growth
        Growth g of ln τ per unit of the output.
    level
        The level y0.

    Source: Hochbruck and Ostermann, Acta Numerica 19, 209, 2010 (exponential integrators).
    """
    if not tau_s > 0.0:
        return
    before, at, difference = values[0], values[0], 0.0
    first = np.exp(-growth * (at - level)) / tau_s
    for k in range(step_s.size):
        h, now = step_s[k], values[k + 1]
        slope = (now - before) / h
        soon = first * (1.0 + min(max(0.25 * h * growth * difference * first, -EASE), EASE))
        output = before + 0.5 * h * slope + _relaxed(difference, slope, 0.5 * h, soon)
        middle = first + first * growth_over(-growth * (output - at))
        output = now + _relaxed(difference, slope, h, middle)
        last = first + first * growth_over(-growth * (output - at))
        mean = (1.0 / 6.0) * (first + 4.0 * middle + last)
        x = h * mean
        bent = slope * h * h * (last - first) / (12.0 + x * (6.0 + 2.0 * x))
        difference = _relaxed(difference, slope, h, mean) + bent
        values[k + 1] = now + difference
        first = last + last * growth_over(-growth * (now + difference - output))
        before, at = now, now + difference


@kernel
def limit_rate(step_s: Array, values: Array, rising: float, falling: float) -> None:
    """Follow the input no faster than a limit either way, −F ≤ ẏ ≤ R.

    Parameters
    ----------
    step_s
        Intervals, shape (n − 1,).
    values
        Input, shape (n,); overwritten by the output.
    rising, falling
        The limits R and F, positive.
    """
    y = values[0]
    for k in range(step_s.size):
        y += min(max(values[k + 1] - y, -falling * step_s[k]), rising * step_s[k])
        values[k + 1] = y


@njit(nogil=True, error_model="numpy")
def _leaves_after(
    aim: float, apart: float, slope: float, step_s: float, rate: float, is_above: bool
) -> float:
    """When a lag leaves its side of zero, of which it is on the other at the end of a step.

    Found by halving the time. The lag is ``apart`` from an aim of this slope at the beginning.
    """
    stays, left = 0.0, step_s
    for _ in range(HALVINGS):
        middle = 0.5 * (stays + left)
        there = aim + slope * middle + _relaxed(apart, slope, middle, rate)
        if (there > 0.0) == is_above:
            stays = middle
        else:
            left = middle
    return left


@kernel
def lag_with_relief(step_s: Array, values: Array, tau_s: float, opens: float, lost: float) -> None:
    """First-order lag with a leak that opens above a level, τ ẏ + y + ℓ max(y − y0, 0) = u.

    Below y0 it is a lag of τ behind u, above it one of τ/(1 + ℓ) behind y0 + (u − y0)/(1 + ℓ); both
    are exact, and the instant at which one takes over from the other is found to rounding.

    Parameters
    ----------
    step_s
        Intervals, shape (n − 1,).
    values
        Input, shape (n,); overwritten by the output.
    tau_s
        Time constant τ below the level, positive.
    opens
        The level y0.
    lost
        Loss ℓ above it, not negative.
    """
    kept = 1.0 / (1.0 + lost)
    before = values[0] - opens
    is_open = before > 0.0
    y = kept * before if is_open else before
    values[0] = opens + y
    for k in range(step_s.size):
        now = values[k + 1] - opens
        left = step_s[k]
        slope = (now - before) / left
        for part in range(MOST_PARTS):
            gain = kept if is_open else 1.0
            rate = 1.0 / (gain * tau_s)
            apart = y - gain * before
            there = gain * now + _relaxed(apart, gain * slope, left, rate)
            if (there > 0.0) == is_open or part == MOST_PARTS - 1:
                break
            passing = _leaves_after(gain * before, apart, gain * slope, left, rate, is_open)
            before += slope * passing
            left -= passing
            y, is_open = 0.0, not is_open
        y, before = there, now
        values[k + 1] = opens + y


@kernel
def resonance(step_s: Array, values: Array, omega: float, zeta: float) -> None:
    """Second-order resonance ÿ/ω² + 2ζ ẏ/ω + y = u at any damping.

    With s the slope of the input, e = y − u + 2ζ s/ω obeys ë + 2ζω ė + ω² e = 0, so with a = ζω

        e⁺ = e^{−ah} [e C + (ė + a e) S],   ė⁺ = e^{−ah} [ė C − (a ė + ω² e) S],

    C = cos ω_d h, S = sin(ω_d h)/ω_d and ω_d = ω √(1 − ζ²); beyond ζ = 1 the hyperbolic functions.

    Parameters
    ----------
    step_s
        Intervals, shape (n − 1,).
    values
        Input, shape (n,); overwritten by the output.
    omega
        Natural frequency ω in rad/s, positive.
    zeta
        Damping ratio ζ, positive.
    """
    a = zeta * omega
    turning = omega * np.sqrt(abs((1.0 - zeta) * (1.0 + zeta)))
    before = values[0]
    y, v = before, 0.0
    usual, c, s = 0.0, 1.0, 0.0
    for k in range(step_s.size):
        h = step_s[k]
        now = values[k + 1]
        slope = (now - before) / h
        if not _alike(h, usual):
            usual = h
            if zeta < 1.0:
                c = np.exp(-a * h) * np.cos(turning * h)
                s = np.exp(-a * h) * np.sin(turning * h) / turning
            elif turning > 0.0:
                slow = np.exp(-omega * h / (zeta + turning / omega))
                c = 0.5 * slow * (1.0 + np.exp(-2.0 * turning * h))
                s = -0.5 * slow * np.expm1(-2.0 * turning * h) / turning
            else:
                c = np.exp(-a * h)
                s = h * np.exp(-a * h)
        behind = 2.0 * zeta * slope / omega
        e, rate = y - before + behind, v - slope
        y = now - behind + e * c + (rate + a * e) * s
        v = slope + rate * c - (a * rate + omega * omega * e) * s
        values[k + 1] = y
        before = now


@kernel
def hermite(step_s: Array, y: Array, finer_s: Array, finer: Array) -> None:
    """Cut every interval into equal pieces, at whose ends the cubic with slopes at the samples is.

    The slope at a sample is that of the parabola through it and its neighbours, at either end that
    of the outermost three, as `numpy.gradient` with edges of order 2 has it.

    Parameters
    ----------
    step_s
        Intervals, shape (n − 1,) with n ≥ 3.
    y
        Samples, shape (n,).
    finer_s
        Receives the lengths of the pieces, shape ((n − 1) P,) with any P ≥ 1.
    finer
        Receives the values at their ends, the first sample foremost, shape ((n − 1) P + 1,).
    """
    n = y.size
    pieces = finer_s.size // step_s.size
    last, here = (y[1] - y[0]) / step_s[0], (y[2] - y[1]) / step_s[1]
    slope = last + (last - here) * step_s[0] / (step_s[0] + step_s[1])
    for k in range(n - 1):
        h, begin, rise = step_s[k], y[k], y[k + 1] - y[k]
        here = rise / h
        if k < n - 2:
            ahead_s = step_s[k + 1]
            ahead = (y[k + 2] - y[k + 1]) / ahead_s
            next_slope = (ahead_s * here + h * ahead) / (h + ahead_s)
        else:
            next_slope = here + (here - last) * h / (h + step_s[k - 1])
        first, second = h * slope, h * next_slope
        for j in range(pieces):
            s = j / pieces
            curve = (first + second - 2.0 * rise) * s + (3.0 * rise - 2.0 * first - second)
            finer_s[k * pieces + j] = h / pieces
            finer[k * pieces + j] = begin + first * s + curve * s * s
        last, slope = here, next_slope
    finer[finer.size - 1] = y[n - 1]


@kernel
def cubic(time_s: Array, values: Array, at_s: Array, found: Array) -> None:
    """Interpolate by the cubic through the two samples on either side (Lagrange).

    Near the ends it is the cubic through the outermost four.

    Parameters
    ----------
    time_s, values
        Samples, each of shape (n,) with n ≥ 4.
    at_s
        Increasing times within those of the samples, shape (m,).
    found
        Receives the values at these times, shape (m,).
    """
    n = time_s.size
    left = 0
    for i in range(at_s.size):
        t = at_s[i]
        while left < n - 2 and time_s[left + 1] <= t:
            left += 1
        first = min(max(left - 1, 0), n - 4)
        total = 0.0
        for j in range(first, first + 4):
            weight = 1.0
            for o in range(first, first + 4):
                if o != j:
                    weight *= (t - time_s[o]) / (time_s[j] - time_s[o])
            total += weight * values[j]
        found[i] = total
