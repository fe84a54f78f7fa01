r"""Pressure behind a valve or restriction after ISO 6358, along a straight supply pressure.

    ṗa = ± p_u ψ(p_d/p_u)/τ,   ψ(r) = 1 for r ≤ b,  √(1 − ((r − b)/(1 − b))²) above,

with p_u the greater and p_d the smaller of supply and actuator pressure. Above r = 0.999 the flow
is taken as laminar, linear in the pressure difference; there the law is a first-order lag that
is stepped exactly, however stiff. Outside the law is not stiff against the motion of the supply,
and Dormand and Prince's pair of orders 5 and 4 follows it with steps of its own. The instants at
which the flow turns laminar or turbulent are located, so that the computed pressure is smooth in
the parameters.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from softid.kernels.filters import lag_difference

Array = npt.NDArray[np.float64]

LAMINAR_ABOVE = 0.999
MAX_SWITCHES = 8
MAX_BISECTIONS = 60

_A: Array = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
_C: Array = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_E: Array = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@njit(cache=True, nogil=True, error_model="numpy")
def pressure_rate(supply: float, actuator: float, tau_s: float, b: float) -> float:
    """ṗa at given absolute pressures.

    Parameters
    ----------
    supply, actuator
        Absolute pressures, positive.
    tau_s
        Time τ in which a choked flow would raise the pressure by the upstream pressure.
    b
        Critical pressure ratio.
    """
    upstream, downstream = max(supply, actuator), min(supply, actuator)
    ratio = downstream / upstream
    if ratio <= b:
        psi = 1.0
    else:
        seen = min(ratio, LAMINAR_ABOVE)
        psi = np.sqrt(1.0 - ((seen - b) / (1.0 - b)) ** 2)
        if ratio > seen:
            psi *= (1.0 - ratio) / (1.0 - LAMINAR_ABOVE)
    flow = upstream * psi / tau_s
    return flow if supply > actuator else -flow


@njit(cache=True, nogil=True, error_model="numpy")
def _advance(
    laminar: bool, p: float, slope: float, a: float, h: float, tau_s: float, b: float
) -> tuple[float, float]:
    """Actuator pressure after h from a at a supply p + slope·t, and its estimated error."""
    if laminar:
        psi = np.sqrt(1.0 - ((LAMINAR_ABOVE - b) / (1.0 - b)) ** 2)
        tau = tau_s * (1.0 - LAMINAR_ABOVE) / psi
        return p + slope * h + lag_difference(a - p, slope, h, tau), 0.0
    rates = np.empty(7)
    reached, error = a, 0.0
    for i in range(7):
        reached = a
        for j in range(i):
            reached += h * _A[i, j] * rates[j]
        rates[i] = pressure_rate(p + slope * _C[i] * h, reached, tau_s, b)
        error += h * _E[i] * rates[i]
    return reached, abs(error)


@njit(cache=True, nogil=True, error_model="numpy")
def _beyond(supply: float, actuator: float, side: float) -> float:
    """How far the pressure difference is beyond the laminar range, on one side or on either."""
    difference = side * (supply - actuator) if side != 0.0 else abs(supply - actuator)
    return difference - (1.0 - LAMINAR_ABOVE) * max(supply, actuator)


@njit(cache=True, nogil=True, error_model="numpy")
def _crossing(
    laminar: bool,
    side: float,
    p: float,
    slope: float,
    a: float,
    h: float,
    tau_s: float,
    b: float,
) -> float:
    """Time at which the flow leaves the range that it is in; it has left it after h (Illinois)."""
    low, high = 0.0, h
    at_low = _beyond(p, a, side)
    at_high = _beyond(p + slope * h, _advance(laminar, p, slope, a, h, tau_s, b)[0], side)
    if (at_low > 0.0) == (at_high > 0.0):
        return 0.0
    for _ in range(MAX_BISECTIONS):
        middle = high - at_high * (high - low) / (at_high - at_low)
        reached = _advance(laminar, p, slope, a, middle, tau_s, b)[0]
        at_middle = _beyond(p + slope * middle, reached, side)
        if (at_middle > 0.0) == (at_high > 0.0):
            at_low *= 0.5
        else:
            low, at_low = high, at_high
        moved = abs(middle - high)
        high, at_high = middle, at_middle
        if at_high == 0.0 or moved <= 1e-15 * h or abs(high - low) <= 1e-15 * h:
            break
    return high


@njit(cache=True, nogil=True, error_model="numpy")
def valve_flow(step_s: Array, values: Array, tau_s: float, b: float, tolerance: float) -> None:
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
    tolerance
        Error allowed per step, in the unit of the pressures.
    """
    p = values[0]
    a = p
    laminar = True
    usual = np.inf
    for k in range(step_s.size):
        left = step_s[k]
        slope = (values[k + 1] - p) / left
        switches = 0
        shortest = 1e-9 * left
        while left > 0.0:
            side = 0.0 if laminar else np.sign(p - a)
            h = left if laminar else min(usual, left)
            reached, error = _advance(laminar, p, slope, a, h, tau_s, b)
            if not laminar:
                fitting = h * min(5.0, max(0.2, 0.9 * (tolerance / (error + 1e-300)) ** 0.2))
                if error > tolerance and h > shortest:
                    usual = fitting
                    continue
                usual = max(fitting, usual) if h == left else fitting
            left_range = (_beyond(p + slope * h, reached, side) > 0.0) == laminar
            if left_range and switches < MAX_SWITCHES:
                h = _crossing(laminar, side, p, slope, a, h, tau_s, b)
                reached = _advance(laminar, p, slope, a, h, tau_s, b)[0]
                laminar = not laminar
                switches += 1
            p += slope * h
            a = reached
            left = left - h if h < left else 0.0
        p = values[k + 1]
        values[k + 1] = a
