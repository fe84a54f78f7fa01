"""Print the simulation's error over a grid of stiffness and sampling.

Run from the root of the project::

    python tests/benchmarks/accuracy_of_steps.py

The muscle's inertia is 1e-5 to 1e2 times the nominal one, the pressure jumps between held levels
within one sampling interval. Each entry is the largest error as a share of the range, the rule that
was chosen (k: explicit Runge–Kutta, r: Radau IIA) and its steps per interval. The reference is the
Radau rule in 64 times as many steps; where its steps are short enough to tell, DOP853 with rtol
1e-11 says the same, and the last lines print by how much.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from softid.models.division import divide
from softid.models.muscle_law import MuscleLaw
from softid.models.second_order import simulate_law

NOMINAL = np.array([2e-3, 1 / 70, 2.8, 1.0, 0.02, 1.6, 0.25])
LEVELS_KPA = (0.0, 240.0, 60.0, 300.0, 0.0, 120.0)
FINER = 64
SHORT = {"rk4": "k", "radau": "r"}


def holds(period_s: float, hold_s: float) -> tuple[np.ndarray, np.ndarray]:
    u = np.repeat(LEVELS_KPA, max(round(hold_s / period_s), 4))
    return period_s * np.arange(u.size), u


def adaptive(theta: np.ndarray, time_s: np.ndarray, u: np.ndarray) -> np.ndarray:
    mass, a1, b1, c1, a2, b2, c2 = theta
    force = np.exp(b1 * u[0] / 100)
    state = np.array([force / (a1 * force + c1), 0.0])
    x = [state[0]]
    for k in range(time_s.size - 1):
        slope = (u[k + 1] - u[k]) / (time_s[k + 1] - time_s[k])

        def rates(t: float, y: np.ndarray, k: int = k, slope: float = slope) -> list[float]:
            p = (u[k] + slope * (t - time_s[k])) / 100
            push = np.exp(b1 * p)
            damping = a2 * np.exp(b2 * p) + c2
            return [y[1], (push - damping * y[1] - (a1 * push + c1) * y[0]) / mass]

        state = solve_ivp(
            rates, (time_s[k], time_s[k + 1]), state, "DOP853", rtol=1e-11, atol=1e-12
        ).y[:, -1]
        x.append(state[0])
    return np.array(x)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--hold", type=float, default=0.5, help="duration of a level, s")
    hold_s = parser.parse_args().hold
    periods = (0.001, 0.005, 0.02, 0.1)
    print("M/nominal " + "".join(f"{1e3 * h:>20.0f} ms" for h in periods))
    worst = 0.0
    for factor in (0.0, *np.geomspace(1e-5, 1e2, 15)):
        law = MuscleLaw(NOMINAL * np.array([factor, 1, 1, 1, 1, 1, 1]))
        row = f"{factor:9.2g} "
        for period_s in periods:
            time_s, u = holds(period_s, hold_s)
            plan = divide(law, time_s, u)
            fine = replace(plan, counts=(plan.counts * FINER).astype(np.int16), rule="radau")
            x = simulate_law(law, time_s, u, None, derivatives=False, plan=plan).x
            exact = simulate_law(law, time_s, u, None, derivatives=False, plan=fine).x
            error = float(np.abs(x - exact).max() / np.ptp(exact))
            worst = max(worst, error)
            row += f"{error:12.1e} {SHORT[plan.rule]} {plan.counts.mean():6.2f} "
        print(row)
    print(f"largest error: {worst:.1e} of the range")
    for factor in (0.1, 1.0, 100.0):
        theta = NOMINAL * np.array([factor, 1, 1, 1, 1, 1, 1])
        time_s, u = holds(0.02, hold_s)
        law = MuscleLaw(theta)
        counts = np.full(u.size - 1, FINER, np.int16)
        fine = replace(divide(law, time_s, u), counts=counts, rule="radau")
        x = simulate_law(law, time_s, u, None, derivatives=False, plan=fine).x
        exact = adaptive(theta, time_s, u)
        print(
            f"reference against DOP853 at M/nominal = {factor:g}: "
            f"{np.abs(x - exact).max() / np.ptp(exact):.1e} of the range"
        )


if __name__ == "__main__":
    main()
