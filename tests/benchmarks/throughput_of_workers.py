"""Print how much more two workers get done than one, beside what the machine itself allows.

Run from the root of the project::

    python tests/benchmarks/throughput_of_workers.py

One worker and two take turns, so that neighbours on the machine slow both alike; the median over
the rounds is printed, beside the machine's own ceiling: two processes that only count.
Threads share one interpreter, so what a candidate or a start does outside the compiled kernels is
not shared out; processes share nothing. What two of them make of the same starts and candidates
tells what threads lose.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterable
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from functools import cache
from multiprocessing import get_context

import numpy as np
from work import NAMES, TRUTH, log_of

import softid
from softid.effects import EFFECTS, ExtendedModel, Scale
from softid.fitters.objective import Objective
from softid.fitters.problem import Problem
from softid.models.muscle import Muscle

COUNTS = 3_000_000
JOBS = 6
SAMPLES = 10_000
EVALUATIONS = 20

Work = Callable[[int], object]
Pools = tuple[Executor, Executor]
"""One worker, and two."""


def count(_: int) -> int:
    total = 0
    for k in range(COUNTS):
        total += k
    return total


def fit_of_a_log(seed: int) -> None:
    softid.fit(log_of(1000, exact=False), model="muscle", seed=seed)


@cache
def run_of_a_start() -> Work:
    model = Muscle()
    problem = Problem(model, model.parameters(), [log_of(SAMPLES, exact=False)])
    guesses = model.guess(problem.segments, "contraction")
    points = [problem.unknowns(guess.values_dict()) for guess in guesses]

    def run(k: int) -> None:
        Objective(problem, {"contraction": 1.0}).solve(points[k % len(points)], 30)

    return run


@cache
def evaluation_of_a_candidate() -> Work:
    scale = Scale(0, 240, 0, 70, 300, 8, 0, 70, 0.005, 50, 0.2, 800)
    model = ExtendedModel(Muscle(), (EFFECTS["creep"](),), scale)
    (segment,) = log_of(SAMPLES, exact=False).segments()
    theta = model.parameters().values_vector()
    theta[: len(NAMES)] = TRUTH
    plan = model.plan(theta, segment)

    def run(_: int) -> None:
        model.response(theta, segment, ("contraction",), start=None, derivatives=True, plan=plan)

    return run


def evaluation_of_the_muscle() -> Work:
    model = Muscle()
    problem = Problem(model, model.parameters(), [log_of(100_000, exact=False)])
    z = problem.unknowns(dict(zip(NAMES, TRUTH.tolist(), strict=True)))
    objective = Objective(problem, {"contraction": 1.0})
    objective.plans = problem.plans(z)
    return lambda _: [objective(z) for _ in range(EVALUATIONS)]


def start(k: int) -> None:
    """One start, in a process that makes its problem once."""
    run_of_a_start()(k)


def candidate(k: int) -> None:
    """One evaluation of a candidate, alike."""
    evaluation_of_a_candidate()(k)


def tell(what: str, pools: Pools, work: Work, machine: Pools, rounds: int) -> None:
    """Print the median throughput of two workers over that of one, beside the machine's ceiling.

    The ceiling is taken in the same rounds, since what neighbours leave free changes by the minute.
    """
    for pool in (*pools, *machine):
        list(pool.map(work if pool in pools else count, range(2)))
    found, ceiling = [], []
    for _ in range(rounds):
        found.append(ratio(pools, work))
        ceiling.append(ratio(machine, count))
    share = 100.0 * np.median(np.array(found) / np.array(ceiling))
    print(
        f"{what}: {np.median(found):.2f}, counting {np.median(ceiling):.2f} at the same time, "
        f"{share:.0f} % of that",
        flush=True,
    )


def ratio(pools: Pools, work: Work) -> float:
    """Throughput of the second pool over that of the first."""
    one, two = (elapsed(pool.map(work, range(JOBS))) for pool in pools)
    return one / two


def elapsed(results: Iterable[object]) -> float:
    began = time.perf_counter()
    list(results)
    return time.perf_counter() - began


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    rounds = parser.parse_args().rounds
    context = get_context("spawn")
    print("two workers over one, median of", rounds, "rounds")
    with (
        ProcessPoolExecutor(1, mp_context=context) as one,
        ProcessPoolExecutor(2, mp_context=context) as two,
        ThreadPoolExecutor(1) as single,
        ThreadPoolExecutor(2) as double,
    ):
        machine = (one, two)
        for what, work in (
            ("fits of several logs, processes", fit_of_a_log),
            ("starts of one fit, processes", start),
            ("candidates of a diagnosis, processes", candidate),
        ):
            tell(what, machine, work, machine, rounds)
        for what, work in (
            ("evaluations of the muscle, threads", evaluation_of_the_muscle()),
            ("starts of one fit, threads", run_of_a_start()),
            ("candidates of a diagnosis, threads", evaluation_of_a_candidate()),
        ):
            tell(what, (single, double), work, machine, rounds)


if __name__ == "__main__":
    main()
