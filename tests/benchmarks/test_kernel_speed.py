"""Nanoseconds a sample, growth with length, memory and threads of the affine kernels.

Run by ``pytest --benchmark-only tests/benchmarks``; times are printed, and only ratios taken within
one run are asserted. One thread is timed by its own processor time, so that neighbours on the
machine count as little as they can; two threads by the clock.
"""
# ruff: noqa: T201 (figures that the run prints)

from __future__ import annotations

import time
import tracemalloc
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from work import NAMES, TRUTH, log_of

from softid.fitters.normal_equations import linearise
from softid.fitters.problem import Problem
from softid.models.division import Division
from softid.models.muscle import Muscle
from softid.models.products import ALL_COLUMNS, NO_COLUMNS

SIGMA = {"contraction": 1.0}
ROUNDS = 7
OWN_TIME = pytest.mark.benchmark(timer=time.thread_time, min_time=1e-3)


def problem_of(n: int) -> tuple[Problem, np.ndarray, list[Division | None]]:
    model = Muscle()
    problem = Problem(model, model.parameters(), [log_of(n, exact=False)])
    z = problem.unknowns(dict(zip(NAMES, TRUTH.tolist(), strict=True)))
    return problem, z, problem.plans(z)


def one_step_each(plan: Division | None, rule: str) -> Division:
    assert plan is not None
    return replace(plan, counts=np.ones_like(plan.counts), rule=rule)


def middle(run: Callable[[], object]) -> float:
    """Median processor time of several runs, in seconds."""
    run()
    times = []
    for _ in range(ROUNDS):
        began = time.thread_time()
        run()
        times.append(time.thread_time() - began)
    return float(np.median(times))


@OWN_TIME
@pytest.mark.parametrize("rule", ["rk4", "radau"])
@pytest.mark.parametrize("n", [1000, 10_000, 100_000])
def test_state_sensitivities_and_normal_matrix(benchmark, rule: str, n: int) -> None:
    """State, seven sensitivities, two of the initial state, and the normal equations, summed."""
    problem, z, plans = problem_of(n)
    held = [one_step_each(plan, rule) for plan in plans]
    benchmark(linearise, problem, z, SIGMA, plans=held, keep=NO_COLUMNS)
    nanoseconds = benchmark.stats.stats.median / n * 1e9
    benchmark.extra_info["ns_per_sample"] = nanoseconds
    print(f"\n{rule}, {n} samples: {nanoseconds:.1f} ns a sample, all of Python included")


@OWN_TIME
def test_as_a_fit_evaluates(benchmark) -> None:
    """The same with the plan that accuracy calls for and the columns kept, as a fit does it."""
    problem, z, plans = problem_of(10_000)
    benchmark(linearise, problem, z, SIGMA, plans=plans, keep=ALL_COLUMNS)
    plan = plans[0]
    assert plan is not None
    print(f"\n{plan.rule}, {plan.counts.mean():.2f} steps a sample", end=": ")
    print(f"{benchmark.stats.stats.median / 10_000 * 1e9:.1f} ns a sample with columns kept")


@OWN_TIME
@pytest.mark.parametrize("n", [100_000, 10_000_000])
def test_length(benchmark, n: int) -> None:
    """Linear to 10⁷ samples within a half, and memory beside the log at most twice its own."""
    problem, z, plans = problem_of(n)
    small, z_small, plans_small = problem_of(10_000)
    still, sums = {"plans": plans_small, "keep": NO_COLUMNS}, {"plans": plans, "keep": NO_COLUMNS}
    short = middle(lambda: linearise(small, z_small, SIGMA, **still)) / 1e4
    long = middle(lambda: linearise(problem, z, SIGMA, **sums)) / n
    benchmark.pedantic(linearise, (problem, z, SIGMA), sums, rounds=1)
    segment = problem.segments[0]
    own = segment.time_s.nbytes + segment.input.nbytes + segment.outputs["contraction"].nbytes
    tracemalloc.start()
    linearise(problem, z, SIGMA, plans=problem.plans(z), keep=NO_COLUMNS)
    extra = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    print(f"\n{n} samples: {1e9 * long:.1f} ns a sample, at 10,000 {1e9 * short:.1f}", end="; ")
    print(f"memory beside the log {extra / own:.2f} times its own")
    assert long <= 1.5 * short
    assert extra <= 2.0 * own


def test_two_threads(benchmark) -> None:
    """Throughput of two threads over one, with evaluations of 100,000 samples; printed."""
    problem, z, plans = problem_of(100_000)

    def evaluate(_: int) -> None:
        linearise(problem, z, SIGMA, plans=plans, keep=NO_COLUMNS)

    evaluate(0)
    ratios = []
    with ThreadPoolExecutor(2) as pool:
        for _ in range(ROUNDS):
            began = time.perf_counter()
            for k in range(8):
                evaluate(k)
            alone = time.perf_counter() - began
            began = time.perf_counter()
            list(pool.map(evaluate, range(8)))
            ratios.append(alone / (time.perf_counter() - began))
    benchmark.pedantic(evaluate, (0,), rounds=3)
    print(f"\ntwo threads: {np.median(ratios):.2f} times the throughput of one", end=" ")
    print(f"(from {min(ratios):.2f} to {max(ratios):.2f})")
