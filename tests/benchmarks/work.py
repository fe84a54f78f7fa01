"""The work that the benchmarks share: one log of a muscle, from an integrator of its own."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from softid.log import Log

NAMES = ("M", "a1", "b1", "c1", "a2", "b2", "c2")
TRUTH = np.array([3e-3, 0.0143, 3.0, 0.95, 1.5e-3, 2.0, 0.28])
START = TRUTH * np.array([1.35, 0.8, 1.2, 0.75, 1.3, 0.8, 1.3])
"""20 to 35 % off."""

PERIOD_S = 0.005
NOISE = 0.005
HOLD = 100


def drive_bar(n: int, seed: int = 1) -> np.ndarray:
    """A 0.5 Hz sine from 0 to 2.4 bar, then random steps of 0.5 s in its second half."""
    time_s = PERIOD_S * np.arange(n)
    pressure = 1.2 - 1.2 * np.cos(np.pi * time_s)
    half = n // 2
    levels = np.random.default_rng(seed).uniform(0.0, 2.4, n // HOLD + 2)
    pressure[half:] = np.repeat(levels, HOLD)[: n - half]
    return pressure


def response(time_s: np.ndarray, pressure_bar: np.ndarray) -> np.ndarray:
    """x of the true muscle by DOP853 with rtol 1e-10, restarted every 0.5 s."""
    mass, a1, b1, c1, a2, b2, c2 = TRUTH

    def rates(t: float, y: np.ndarray) -> list[float]:
        p = np.interp(t, time_s, pressure_bar)
        force = np.exp(b1 * p)
        damping = a2 * np.exp(b2 * p) + c2
        return [y[1], (force - damping * y[1] - (a1 * force + c1) * y[0]) / mass]

    force = np.exp(b1 * pressure_bar[0])
    state = np.array([force / (a1 * force + c1), 0.0])
    x = np.empty(time_s.size)
    x[0] = state[0]
    for first in range(0, time_s.size - 1, HOLD):
        part = time_s[first : first + HOLD + 1]
        found = solve_ivp(
            rates, (part[0], part[-1]), state, "DOP853", part, rtol=1e-10, atol=1e-10,
            max_step=PERIOD_S,
        ).y  # fmt: skip
        x[first : first + part.size] = found[0]
        state = found[:, -1]
    return x


def log_of(n: int, *, exact: bool = True, seed: int = 1) -> Log:
    """The log: contraction in mm with 0.5 % noise; without ``exact`` softid makes the response."""
    time_s, pressure = PERIOD_S * np.arange(n), drive_bar(n, seed)
    x = response(time_s, pressure) if exact else quick_response(time_s, pressure)
    rng = np.random.default_rng(1 + seed)
    y = x + NOISE * np.ptp(x) * rng.standard_normal(n)
    return Log.from_arrays(
        time_s,
        {"pressure": 100.0 * pressure, "contraction": y},
        outputs=("contraction",),
        units={"contraction": "mm"},
        name=f"log-{seed}",
    )


def quick_response(time_s: np.ndarray, pressure_bar: np.ndarray) -> np.ndarray:
    """x by softid's own kernels, for logs whose length alone matters."""
    from softid.models.muscle_law import MuscleLaw
    from softid.models.second_order import simulate_law

    return simulate_law(MuscleLaw(TRUTH), time_s, 100.0 * pressure_bar, None, derivatives=False).x
