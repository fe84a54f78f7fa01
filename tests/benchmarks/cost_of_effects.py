"""Print what a state effect costs per sample and sensitivity, beside the affine kernel.

Run from the root of the project::

    python tests/benchmarks/cost_of_effects.py

Every line is one simulation with all derivatives over the shared log: the muscle with one effect at
its start values, and the equilibrium model. The affine kernels sum the normal equations on the way;
they are timed as an optimiser calls them. Sensitivities are those by the parameters and the initial
state. Processor time of one thread, the least of several runs; the ratio counts, since both are
taken within one run.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
from work import NAMES, TRUTH, log_of

from softid.effects import EFFECTS, ExtendedModel, Scale, StateEffect
from softid.fitters.normal_equations import linearise
from softid.fitters.problem import Problem
from softid.log import Log
from softid.models.base import Model
from softid.models.equilibrium import Equilibrium
from softid.models.muscle import Muscle
from softid.models.products import NO_COLUMNS

SCALE = Scale(0, 240, 0, 70, 300, 8, 0, 70, 0.005, 50, 0.2, 800)
STATES = 2


def least_s(run: Callable[[], object], rounds: int) -> float:
    """Processor time of the quickest of several runs."""
    run()
    times = []
    for _ in range(rounds):
        began = time.thread_time()
        run()
        times.append(time.thread_time() - began)
    return min(times)


def affine(log: Log) -> tuple[Callable[[], object], int]:
    model = Muscle()
    problem = Problem(model, model.parameters(), [log])
    z = problem.unknowns(dict(zip(NAMES, TRUTH.tolist(), strict=True)))
    plans = problem.plans(z)
    sigma = {"contraction": 1.0}
    run = lambda: linearise(problem, z, sigma, plans=plans, keep=NO_COLUMNS)  # noqa: E731
    return run, len(NAMES) + STATES


def extended(key: str, log: Log) -> tuple[Callable[[], object], int]:
    model = ExtendedModel(Muscle(), (EFFECTS[key](),), SCALE)
    theta = model.parameters().values_vector()
    theta[: len(NAMES)] = TRUTH
    return responding(model, theta, log, "contraction")


def equilibrium(log: Log) -> tuple[Callable[[], object], int]:
    pressure = log.channels["pressure"].values / 10.0
    bent = Log.from_arrays(log.time_s, {"pressure": pressure, "angle": 1e-3 * pressure})
    model = Equilibrium()
    return responding(model, model.parameters().values_vector(), bent, "angle")


def responding(
    model: Model, theta: np.ndarray, log: Log, output: str
) -> tuple[Callable[[], object], int]:
    (segment,) = log.segments()
    plan = model.plan(theta, segment)

    def run() -> object:
        return model.response(theta, segment, (output,), start=None, derivatives=True, plan=plan)

    return run, theta.size + STATES


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=4000)
    parser.add_argument("--rounds", type=int, default=7)
    options = parser.parse_args()
    log = log_of(options.samples, exact=False)
    keys = [key for key, effect in EFFECTS.items() if issubclass(effect, StateEffect)]
    works = {"affine kernel": affine(log)} | {key: extended(key, log) for key in keys}
    works["equilibrium model"] = equilibrium(log)
    print("| law | sensitivities | ns per sample and sensitivity | times the affine kernel |")
    print("|---|---|---|---|")
    base = None
    for name, (run, count) in works.items():
        found = 1e9 * least_s(run, options.rounds) / options.samples / count
        base = base or found
        print(f"| {name} | {count} | {found:.3g} | {found / base:.1f} |", flush=True)


if __name__ == "__main__":
    main()
