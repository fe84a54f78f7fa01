"""Print what a fit of the muscle's seven parameters takes with softid and with other tools.

Run from the root of the project::

    python tests/benchmarks/speed_of_fits.py --samples 1000 10000 100000

The log is a 0.5 Hz sine from 0 to 2.4 bar and then random steps, sampled every 5 ms, with 0.5 % of
noise. Other tools start 20 to 35 % from the truth, at rest, with seven unknowns. softid is shown
thrice: as `softid.fit` with nothing but the model's name given, which also guesses a start, looks
for better optima, estimates errors and judges; as search and optimiser alone; and from the others'
start, one run of the optimiser. It has three more unknowns: the sensor's zero and the initial
state. Every fit runs twice and the second counts, so that nothing is compiled within it; what
takes more than 20 s of processor time runs once. Ratios are of processor time. "Noise left" is the
residual's standard deviation over that at the truth.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
import datetime
import platform
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import rivals
from work import NAMES, START, TRUTH, log_of

import softid
from softid.fitters.output_error import draft_fit, output_error
from softid.fitters.problem import Problem
from softid.log import Log
from softid.models.muscle import Muscle

Fit = Callable[[Log], np.ndarray]
ONCE_S = 20.0
RECOVERED = 0.1
"""M, and N(p) and the static curve from 0 to 2.4 bar, count as recovered within 10 %."""


def softid_fit(log: Log) -> np.ndarray:
    found = softid.fit(log, model="muscle")
    values = {p.name: p.value for p in found.parameters}
    return np.array([values[name] for name in NAMES])


def softid_search(log: Log) -> np.ndarray:
    model = Muscle()
    problem = Problem(model, model.parameters(), [log])
    starts = [s.values_dict() for s in model.guess(log.segments(), "contraction")]
    found = output_error(problem, starts, rng=np.random.default_rng(0))
    return problem.theta(found.unknowns)


def softid_start(log: Log) -> np.ndarray:
    model = Muscle()
    problem = Problem(model, model.parameters(), [log])
    start = dict(zip(NAMES, START.tolist(), strict=True))
    found = draft_fit(problem, [start])
    return problem.theta(found.unknowns)


def of_arrays(rival: Callable[..., np.ndarray]) -> Fit:
    def fit(log: Log) -> np.ndarray:
        pressure = log.channels["pressure"].values / 100.0
        return rival(log.time_s, pressure, log.channels["contraction"].values)

    return fit


RIVALS: dict[str, tuple[Fit, bool]] = {
    "softid.fit, model named": (softid_fit, False),
    "softid search + optimiser": (softid_search, False),
    "softid optimiser, same start": (softid_start, False),
    "lmfit + solve_ivp": (of_arrays(rivals.lmfit_solve_ivp), True),
    "lmfit + odeint": (of_arrays(rivals.lmfit_odeint), True),
    "numba + differences + least_squares": (of_arrays(rivals.numba_least_squares), False),
    "CasADi + least_squares": (of_arrays(rivals.casadi_fit), False),
    "diffrax + optimistix": (of_arrays(rivals.diffrax_fit), False),
}
"""Name → fit, and whether it is left out beyond `--slow-up-to` samples."""


def timed(fit: Fit, log: Log) -> tuple[float, float, np.ndarray]:
    """Duration, processor time of all threads, and what was found."""
    times = []
    while len(times) < 2:
        began, worked = time.perf_counter(), time.process_time()
        theta = fit(log)
        times.append((time.perf_counter() - began, time.process_time() - worked))
        if times[0][1] > ONCE_S:
            break
    return *times[-1], theta


def noise_left(log: Log, theta: np.ndarray) -> float:
    """Standard deviation of the residual by the compiled loop, over that at the truth."""
    pressure = log.channels["pressure"].values / 100.0
    out = np.empty(len(log))
    left = []
    for at in (theta, TRUTH):
        fine = np.linspace(log.time_s[0], log.time_s[-1], 4 * (len(log) - 1) + 1)
        x = np.empty(fine.size)
        rivals._rk4(at, fine, np.interp(fine, log.time_s, pressure), x)
        out = log.channels["contraction"].values - x[::4]
        left.append(float(np.std(out)))
    return left[0] / left[1]


def recovered(theta: np.ndarray) -> bool:
    p = np.linspace(0.0, 2.4, 25)

    def curves(at: np.ndarray) -> np.ndarray:
        m, a1, b1, c1, a2, b2, c2 = at
        static = 1.0 / (a1 + c1 * np.exp(-b1 * p))
        return np.concatenate([static, a2 * np.exp(b2 * p) + c2, [m]])

    return bool(np.all(np.abs(curves(theta) / curves(TRUTH) - 1.0) < RECOVERED))


def processor() -> str:
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, nargs="+", default=[1000, 10_000, 100_000])
    parser.add_argument("--slow-up-to", type=int, default=1000)
    options = parser.parse_args()
    print(f"{datetime.date.today()}, {processor()}, Python {platform.python_version()}\n")
    print("| samples | fit | time | processor time | × softid.fit | noise left | recovered |")
    print("|---|---|---|---|---|---|---|")
    for n in options.samples:
        log = log_of(n, exact=n <= 10_000)
        base = None
        for name, (fit, slow) in RIVALS.items():
            if slow and n > options.slow_up_to:
                continue
            try:
                seconds, worked, theta = timed(fit, log)
            except ImportError as missing:
                print(f"| {n} | {name} | not installed ({missing.name}) | | | | |", flush=True)
                continue
            base = base or worked
            left = noise_left(log, theta)
            good = "yes" if recovered(theta) else "no"
            print(
                f"| {n} | {name} | {1e3 * seconds:.4g} ms | {1e3 * worked:.4g} ms "
                f"| {worked / base:.3g} | {left:.4f} | {good} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
