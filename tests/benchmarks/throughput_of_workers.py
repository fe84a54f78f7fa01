"""Print how much more two workers get done than one, beside what the machine itself allows.

Run from the root of the project::

    python tests/benchmarks/throughput_of_workers.py

One worker and two take turns, so that neighbours on the machine slow both alike; the median over
the rounds is printed, beside the machine's own ceiling: two workers that only count. Everything is
shared out as softid does it, by `softid.parallel.in_parallel`; what a worker costs to begin with is
part of it. A whole diagnosis has as many cores.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable

import numpy as np
from work import NAMES, TRUTH, log_of

import softid
from softid.effects import EFFECTS, ExtendedModel, Scale
from softid.fitters.objective import Objective
from softid.fitters.problem import Problem
from softid.models.muscle import Muscle
from softid.parallel import in_parallel
from softid.synthesis import hidden_pair

COUNTS = 3_000_000
JOBS = 6
SAMPLES = 10_000
EVALUATIONS = 20
DRAWS = 200
SEED = 3

Share = Callable[[int], object]
"""Does something with so many workers."""


def by_jobs(work: Callable[[int], object]) -> Share:
    """The same work a few times."""
    return lambda workers: in_parallel(work, range(JOBS), workers=workers)


def counting(_: int) -> int:
    total = 0
    for k in range(COUNTS):
        total += k
    return total


def fits_of_logs() -> Share:
    logs = [log_of(SAMPLES, exact=False) for _ in range(JOBS)]
    return by_jobs(lambda k: softid.fit(logs[k], model="muscle", seed=k).values)


def starts_of_a_fit() -> Share:
    model = Muscle()
    problem = Problem(model, model.parameters(), [log_of(SAMPLES, exact=False)])
    guesses = model.guess(problem.segments, "contraction")
    points = [problem.unknowns(guess.values_dict()) for guess in guesses]

    def start(k: int) -> float:
        search = Objective(problem, {"contraction": 1.0})
        return search.solve(points[k % len(points)], 30).normal.cost

    return lambda workers: in_parallel(start, range(4 * JOBS), workers=workers)


def refits_of_a_bootstrap() -> Share:
    log = log_of(SAMPLES, exact=False)
    result = softid.fit(log, model="muscle")
    return lambda workers: softid.bootstrap_parameters(result, log, draws=DRAWS, workers=workers)


def evaluations_of_candidates() -> Share:
    scale = Scale(0, 240, 0, 70, 300, 8, 0, 70, 0.005, 50, 0.2, 800)
    model = ExtendedModel(Muscle(), (EFFECTS["creep"](),), scale)
    (segment,) = log_of(SAMPLES, exact=False).segments()
    theta = model.parameters().values_vector()
    theta[: len(NAMES)] = TRUTH
    plan = model.plan(theta, segment)

    def run(_: int) -> None:
        for _ in range(EVALUATIONS):
            model.response(
                theta, segment, ("contraction",), start=None, derivatives=True, plan=plan
            )

    return by_jobs(run)


def whole_diagnosis() -> Share:
    """On as many cores; what nothing can share out is a part of it."""
    train, hold_out = hidden_pair(["creep"], seed=SEED).logs

    def diagnosed(workers: int) -> None:
        cores = os.sched_getaffinity(0)
        os.sched_setaffinity(0, sorted(cores)[:workers])
        try:
            softid.diagnose(train, hold_out=[hold_out], model="muscle")
        finally:
            os.sched_setaffinity(0, cores)

    return diagnosed


def tell(what: str, share: Share, rounds: int) -> None:
    """Print the median throughput of two workers over that of one, beside the machine's ceiling.

    The ceiling is taken in the same rounds, since what neighbours leave free changes by the minute.
    """
    share(2)
    found, ceiling = [], []
    for _ in range(rounds):
        found.append(ratio(share))
        ceiling.append(ratio(by_jobs(counting)))
    part = 100.0 * np.median(np.array(found) / np.array(ceiling))
    print(
        f"{what}: {np.median(found):.2f}, counting {np.median(ceiling):.2f} at the same time, "
        f"{part:.0f} % of that",
        flush=True,
    )


def ratio(share: Share) -> float:
    """Throughput of two workers over that of one."""
    alone, two = (elapsed(share, workers) for workers in (1, 2))
    return alone / two


def elapsed(share: Share, workers: int) -> float:
    began = time.perf_counter()
    share(workers)
    return time.perf_counter() - began


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    rounds = parser.parse_args().rounds
    print("two workers over one, median of", rounds, "rounds")
    for what, share in (
        ("fits of several logs", fits_of_logs()),
        ("starts of one fit", starts_of_a_fit()),
        ("refits of a bootstrap", refits_of_a_bootstrap()),
        ("candidates of a diagnosis", evaluations_of_candidates()),
    ):
        tell(what, share, rounds)
    if hasattr(os, "sched_setaffinity"):
        tell("a whole diagnosis", whole_diagnosis(), rounds)


if __name__ == "__main__":
    main()
