r"""Pressure behind a valve or restriction after ISO 6358, along a straight supply pressure.

    ṗa = ± p_u ψ(p_d/p_u)/τ,   ψ(r) = 1 for r ≤ b,  √(1 − ((r − b)/(1 − b))²) above,

with p_u the greater and p_d the smaller of supply and actuator pressure. Above r = 0.999 the flow
is taken as laminar, linear in the pressure difference; there the law is a first-order lag that
is stepped exactly, however stiff. Outside the law is not stiff against the motion of the supply,
and Dormand and Prince's pair of orders 5 and 4 follows it with steps of its own, from one bend of
the supply to the next; what lies between a step's ends is read from its interpolant (Hairer,
Nørsett and Wanner, *Solving Ordinary Differential Equations I*, §II.6). The instants at which the
flow turns laminar or turbulent are located, so that the computed pressure is smooth in the
parameters, and so is where the one turns into the other if venting takes another time than filling.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.decorators import kernel
from softid.kernels.filters import lag_difference

Array = npt.NDArray[np.float64]

Law = tuple[float, float, float, float]
"""1/τ, b, 1/(1 − b) and the rate of the lag that laminar flow is."""

Between = tuple[float, float, float, float]
"""Coefficients of `_between`."""

LAMINAR_ABOVE = 0.999
"""Ratio of the pressures above which the flow is laminar: ψ would end at 1 with an infinite slope,
which no integrator follows. A judgement; a thousandth of an atmosphere is what a gauge resolves."""

MAX_SWITCHES = 8
"""Times that the flow may turn laminar or turbulent between two samples. On a straight supply three
are the most: what vents turns laminar, then fills, and turns turbulent if the supply rises fast. So
it stops nothing but a chatter by rounding on the border, where both laws are the same."""

MAX_BISECTIONS = 60
"""Rounds in which an instant is located: where one side is almost flat halving has to do, which
leaves 1e-18 of the step after so many."""

ALIKE = 1e-7
"""Difference of two intervals, in laminar time constants, up to which a straight line leads from
the decay over one to that over the other."""

A20, A21 = 3 / 40, 9 / 40
A30, A31, A32 = 44 / 45, -56 / 15, 32 / 9
A40, A41, A42, A43 = 19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729
A50, A51, A52, A53, A54 = 9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656
A60, A62, A63, A64, A65 = 35 / 384, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84
E0, E2, E3, E4, E5, E6 = 71 / 57600, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40
"""Dormand and Prince's coefficients, and what tells their two orders apart, without the zeros."""

D0, D2, D3 = -12715105075 / 11282082432, 87487479700 / 32700410799, -10690763975 / 1880347072
D4, D5, D6 = 701980252875 / 199316789632, -1453857185 / 822651844, 69997945 / 29380423
"""The last coefficient of the interpolant of order 4."""

SAFETY = 0.02
"""Share of the tolerance that a step may reach: steps come and go as a parameter moves, and what
they leave must stay below the differences that derivatives are taken from."""

STRAIGHT = 1e-2
"""Share of the tolerance by which values of the supply may lie beside a straight line."""

ROUNDED = 1e-15
"""Times are known to this share of the longest, which within a jump of microseconds is much."""


@njit(nogil=True, error_model="numpy")
def _rate(supply: float, actuator: float, law: Law) -> float:
    """ṗa at absolute pressures, without a division: of p_u ψ, both are drawn under the root."""
    per_s, b, per_range, laminar_per_s = law
    upstream, downstream = max(supply, actuator), min(supply, actuator)
    if downstream > LAMINAR_ABOVE * upstream:
        return laminar_per_s * (supply - actuator)
    missing = max(downstream - b * upstream, 0.0) * per_range
    flow: float = per_s * np.sqrt(upstream * upstream - missing * missing)
    return flow if supply > actuator else -flow


@njit(nogil=True, error_model="numpy")
def _laminar_time(tau_s: float, b: float) -> float:
    """Time constant of the lag that laminar flow is."""
    psi = np.sqrt(1.0 - ((LAMINAR_ABOVE - b) / (1.0 - b)) ** 2)
    return float(tau_s * (1.0 - LAMINAR_ABOVE) / psi)


@njit(nogil=True, error_model="numpy")
def _law(tau_s: float, b: float) -> Law:
    return 1.0 / tau_s, b, 1.0 / (1.0 - b), 1.0 / _laminar_time(tau_s, b)


@njit(nogil=True, error_model="numpy")
def _balanced_after(difference: float, slope: float, tau_laminar: float) -> float:
    """Time after which a laminar flow towards a supply that comes to meet it is none."""
    late = slope * tau_laminar
    return float(tau_laminar * np.log1p(-difference / late)) if difference * late < 0.0 else np.inf


@njit(nogil=True, error_model="numpy")
def _turbulent(
    p: float, slope: float, a: float, h: float, k1: float, law: Law
) -> tuple[float, float, float, Between]:
    """Actuator pressure after h from a at a supply p + slope·t, where it moves at ``k1`` at first.

    The pressure, its rate there, its estimated error, and the coefficients of `_between`.
    """
    k2 = _rate(p + slope * (h / 5), a + h * (k1 / 5), law)
    k3 = _rate(p + slope * (3 * h / 10), a + h * (A20 * k1 + A21 * k2), law)
    reached = a + h * (A30 * k1 + A31 * k2 + A32 * k3)
    k4 = _rate(p + slope * (4 * h / 5), reached, law)
    reached = a + h * (A40 * k1 + A41 * k2 + A42 * k3 + A43 * k4)
    k5 = _rate(p + slope * (8 * h / 9), reached, law)
    reached = a + h * (A50 * k1 + A51 * k2 + A52 * k3 + A53 * k4 + A54 * k5)
    k6 = _rate(p + slope * h, reached, law)
    move = h * (A60 * k1 + A62 * k3 + A63 * k4 + A64 * k5 + A65 * k6)
    k7 = _rate(p + slope * h, a + move, law)
    error = h * (E0 * k1 + E2 * k3 + E3 * k4 + E4 * k5 + E5 * k6 + E6 * k7)
    ahead = h * k1 - move
    last = h * (D0 * k1 + D2 * k3 + D3 * k4 + D4 * k5 + D5 * k6 + D6 * k7)
    return a + move, k7, abs(error), (move, ahead, move - h * k7 - ahead, last)


@njit(nogil=True, error_model="numpy")
def _between(a: float, terms: Between, share: float) -> float:
    """Pressure at a share of a turbulent step from a."""
    move, ahead, behind, last = terms
    rest = 1.0 - share
    return a + share * (move + rest * (ahead + share * (behind + rest * last)))


@njit(nogil=True, error_model="numpy")
def _fitting(h: float, error: float, allowed: float) -> float:
    """The next step after one of h, by the error that was estimated and the one that is allowed."""
    return float(h * min(5.0, max(0.2, 0.9 * (allowed / (error + 1e-300)) ** 0.2)))


@njit(nogil=True, error_model="numpy")
def _beyond(supply: float, actuator: float, side: float) -> float:
    """How far the pressure difference is beyond the laminar range, on one side or on either."""
    difference = side * (supply - actuator) if side != 0.0 else abs(supply - actuator)
    return difference - (1.0 - LAMINAR_ABOVE) * max(supply, actuator)


@njit(nogil=True, error_model="numpy")
def _crossing(
    laminar: bool,
    side: float,
    p: float,
    slope: float,
    a: float,
    h: float,
    reached: float,
    terms: Between,
    tau_laminar: float,
) -> float:
    """Time at which the flow leaves the range that it is in; it has left it after h (Illinois)."""
    low, high = 0.0, h
    at_high = _beyond(p + slope * h, reached, side)
    at_low = np.copysign(_beyond(p, a, side), -at_high)  # zero but for rounding after a switch
    for _ in range(MAX_BISECTIONS):
        middle = high - at_high * (high - low) / (at_high - at_low)
        supply = p + slope * middle
        if laminar:
            there = supply + lag_difference(a - p, slope, middle, tau_laminar)
        else:
            there = _between(a, terms, middle / h)
        at_middle = _beyond(supply, there, side)
        if (at_middle > 0.0) == (at_high > 0.0):
            at_low *= 0.5
        else:
            low, at_low = high, at_high
        moved = abs(middle - high)
        high, at_high = middle, at_middle
        if at_high == 0.0 or moved <= 1e-15 * h or abs(high - low) <= 1e-15 * h:
            break
    return high


@njit(nogil=True, error_model="numpy")
def _straight(
    step_s: Array, values: Array, k: int, p: float, near: float, resolution_s: float
) -> tuple[int, float]:
    """Interval behind the one up to which the supply goes on straight from ``k``, and its slope.

    It may bend by ``near``, and as far as ``resolution_s``, to which times are known, lets it seem.
    """
    passed = step_s[k]
    slope = (values[k + 1] - p) / passed
    end = k + 1
    while end < step_s.size:
        longer = passed + step_s[end]
        unknown = near + resolution_s * abs(slope)
        if not abs(values[end + 1] - (p + slope * longer)) <= unknown:
            break
        passed, end = longer, end + 1
        slope = (values[end] - p) / passed
    return end, slope


@kernel
def valve_flow(
    step_s: Array, values: Array, tau_s: float, b: float, ratio: float, tolerance: float
) -> None:
    """Pressure of an actuator that begins settled at its supply.

    Parameters
    ----------
    step_s
        Intervals, shape (n − 1,).
    values
        Absolute supply pressure, positive, shape (n,); overwritten by that of the actuator.
    tau_s
        Time τ of the law, positive.
    b
        Critical pressure ratio.
    ratio
        Time τ of venting over that of filling.
    tolerance
        Error allowed per step, in the unit of the pressures.
    """
    p = values[0]
    a = p
    laminar = True
    usual = np.inf
    filling, venting = _law(tau_s, b), _law(tau_s * ratio, b)
    turns, tau_laminar, law = ratio != 1.0, 0.0, filling
    kept_h, kept, allowed = 0.0, 0.0, SAFETY * tolerance
    resolution_s = ROUNDED * np.sum(step_s)
    k, rate, rate_there = 0, 0.0, 0.0
    while k < step_s.size:
        end, slope = _straight(step_s, values, k, p, STRAIGHT * tolerance, resolution_s)
        ahead, left, to_next = values[end], np.sum(step_s[k:end]), step_s[k]
        switches, shortest = 0, 1e-9 * left
        while k < end:
            side = 0.0 if laminar else np.sign(p - a)
            h = to_next if laminar else usual if usual < left else left
            terms = (0.0, 0.0, 0.0, 0.0)
            if laminar:
                law = filling if p > a or (p == a and slope > 0.0) else venting
                if 1.0 / law[3] != tau_laminar:
                    tau_laminar, kept_h = 1.0 / law[3], np.inf
                if turns:
                    h = min(h, _balanced_after(p - a, slope, tau_laminar))
                longer = (h - kept_h) / tau_laminar
                if not abs(longer) < ALIKE:  # most intervals are as long as the one before
                    kept_h, longer, kept = h, 0.0, np.expm1(-h / tau_laminar)
                decayed = kept - longer * (1.0 + kept)
                reached = p + slope * h + (a - p) * (1.0 + decayed) + slope * tau_laminar * decayed
            else:
                reached, rate_there, error, terms = _turbulent(p, slope, a, h, rate, law)
                if error > allowed and h > shortest:
                    usual = _fitting(h, error, allowed)
                    continue
                if h < left:  # else the supply bends sooner than the law asks for another step
                    usual = _fitting(h, error, allowed)
            left_range = (_beyond(p + slope * h, reached, side) > 0.0) == laminar
            if left_range and switches < MAX_SWITCHES:
                h = _crossing(laminar, side, p, slope, a, h, reached, terms, tau_laminar)
                if laminar:
                    reached = p + slope * h + lag_difference(a - p, slope, h, tau_laminar)
                    law = filling if p + slope * h > reached else venting
                    rate_there = _rate(p + slope * h, reached, law)
                else:
                    reached, rate_there, _, terms = _turbulent(p, slope, a, h, rate, law)
                laminar = not laminar
                switches += 1
            while k < end and (to_next <= h or h == left):
                values[k + 1] = _between(a, terms, to_next / h) if to_next < h else reached
                k += 1
                to_next += step_s[k] if k < end else 0.0
                switches = 0
            to_next -= h
            left = max(left - h, to_next)
            p += slope * h
            a, rate = reached, rate_there
        p = ahead
