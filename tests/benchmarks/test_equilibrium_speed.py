"""How long the equilibrium model takes: one Runge–Kutta step, and 6 s at 1 kHz.

Not part of the normal run: ``make bench``, or pytest with ``--benchmark-only`` on this file. The
paper claims 1 ms a step. The best of the rounds counts, in processor time: another program on the
machine only ever adds to the time.
"""

from __future__ import annotations

import time

import numpy as np
import pytest

from softid.kernels.bending import propagate_bending
from softid.log import Log
from softid.models.equilibrium import Equilibrium

pytest.importorskip("pytest_benchmark")

THETA = np.array([4.5e-4, 0.2, -0.3, 1.3, 1.0, 1.0, 0.0, 0.0])
STEPS = 6000
OWN_TIME = pytest.mark.benchmark(timer=time.thread_time, min_time=1e-3)


@pytest.fixture(autouse=True)
def _only_when_asked(request: pytest.FixtureRequest) -> None:
    """A busy machine must not fail the normal run."""
    if not request.config.getoption("benchmark_only"):
        pytest.skip("run with --benchmark-only")


@OWN_TIME
def test_one_step(benchmark) -> None:
    """At most 1 µs a step, over 6000 steps of a ringing response."""
    body = Equilibrium().compiled_body
    step_s, pressures = np.full(STEPS, 1e-3), np.full((STEPS, 3), 20.0)
    states = np.empty((STEPS, 2))
    benchmark(lambda: propagate_bending(step_s, pressures, THETA, body, np.zeros(2), states))
    assert benchmark.stats.stats.min / STEPS < 1e-6


@OWN_TIME
@pytest.mark.parametrize("derivatives", [False, True])
def test_six_seconds_at_one_kilohertz(benchmark, derivatives: bool) -> None:
    """At most 10 ms with planning and output, and with all derivatives as well."""
    time_s = np.arange(STEPS + 1) * 1e-3
    pressure = np.where(time_s < 0.5, 0.0, 20.0)
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": time_s})
    segment, model = log.segments()[0], Equilibrium()
    benchmark(
        lambda: model.response(THETA, segment, ("angle",), start=None, derivatives=derivatives)
    )
    assert benchmark.stats.stats.min < 10e-3


if __name__ == "__main__":
    raise SystemExit(pytest.main([__file__, "--benchmark-only", "-q"]))
