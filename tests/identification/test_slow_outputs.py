"""Outputs that are read more slowly than the input: samples are readings, the input goes on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem
from slow_camera import EVERY, slow

from softid.identification import fit
from softid.identification.slow_outputs import SlowOutputLog, at_readings
from softid.validation import validate


def test_samples_are_the_readings_and_the_response_is_that_of_all_rows() -> None:
    """Residuals of the log as it was recorded, whatever the input is taken to do."""
    for reading in (None, "smooth", "held", "zoh"):
        log = replace(slow(linear_log(noise=0.01)), intersample=reading)
        found = at_readings(log)
        assert isinstance(found, SlowOutputLog)
        np.testing.assert_array_equal(found.time_s, log.time_s[::EVERY])
        problems = [linear_problem([one]) for one in (log, found)]
        residuals = [
            next(iter(p.blocks(p.unknowns(TRUTH), derivatives=False))).residual for p in problems
        ]
        np.testing.assert_allclose(residuals[1], residuals[0], atol=1e-9 * SIGMA["angle"])
        (segment,) = found.segments()
        read_s, read = segment.readings
        np.testing.assert_array_equal(read_s, log.time_s[log.time_s <= found.time_s[-1]])
        known = np.interp(read_s, log.time_s, log.channels["pressure"].values)
        np.testing.assert_allclose(read, known, atol=1e-9)


@pytest.mark.parametrize("lost", [0.0, 0.3])
def test_a_log_that_lost_samples_is_left_alone(lost: float) -> None:
    """Most of its readings follow each other."""
    log = linear_log()
    masked = np.random.default_rng(0).random(len(log)) < lost
    assert not isinstance(at_readings(log.with_masked(masked)), SlowOutputLog)


@pytest.mark.parametrize("intersample", [None, "zoh"])
def test_a_fit_takes_readings_for_samples(intersample: str | None) -> None:
    """Known truth: the parameters within their intervals; simulated and scored at the readings."""
    log = slow(linear_log(noise=0.01)).with_intersample(intersample)
    found = fit(log, model="oscillator")
    if intersample is None:
        for name, true in TRUTH.items():
            low, high = found.parameter(name).ci95
            assert low <= true <= high
    (row,), (simulated,) = found.statistics, found.simulations
    assert row.n == simulated.time_s.size == -(-len(log) // EVERY)
    (again,) = validate(found, log).statistics
    assert again.rmse == pytest.approx(row.rmse, rel=1e-4)
