"""Outputs that are read more slowly than the input: samples are readings, the input goes on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem
from slow_camera import EVERY, free_camera, slow

from softid.identification import fit
from softid.identification.slow_outputs import SlowOutputLog, at_readings
from softid.log import Log
from softid.validation import validate


def test_samples_are_the_readings_and_the_response_is_that_of_all_rows() -> None:
    """Residuals of the log as it was recorded, whatever the input is taken to do."""
    for intersample in (None, "smooth", "held", "zoh"):
        log = replace(slow(linear_log(noise=0.01)), intersample=intersample)
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


@pytest.mark.parametrize("frames_hz", [17.3, 24.0])
@pytest.mark.parametrize("repeated", [True, False])
def test_a_camera_with_its_own_clock_is_not_late(frames_hz: float, repeated: bool) -> None:
    """Known truth: the parameters within three standard errors, and nothing but noise left.

    Taken when it is seen, a frame is late by nothing to a whole row, which leaves 0.008 rad.
    """
    log = free_camera(frames_hz, repeated=repeated)
    found = fit(log, model="oscillator")
    for name, true in TRUTH.items():
        parameter = found.parameter(name)
        assert parameter.value == pytest.approx(true, abs=3.0 * parameter.stderr)
    (row,) = found.statistics
    assert row.rmse == pytest.approx(0.002, rel=0.1)
    (again,) = validate(found, log).statistics
    assert again.rmse == pytest.approx(row.rmse, rel=1e-4)


def test_frames_with_rows_of_their_own_are_where_they_are() -> None:
    """A file that was merged from two has the times of both, however uneven a camera's are."""
    log = linear_log()
    rng = np.random.default_rng(0)
    frames_s = log.time_s[0] + np.arange(1, 240) / 13.0 + rng.uniform(-0.001, 0.001, 239)
    time_s, where = np.unique(np.concatenate((log.time_s, frames_s)), return_index=True)
    angle = np.where(where < len(log), np.nan, time_s)
    pressure = np.interp(time_s, log.time_s, log.channels["pressure"].values)
    merged = Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})
    np.testing.assert_array_equal(at_readings(merged).time_s, frames_s)
