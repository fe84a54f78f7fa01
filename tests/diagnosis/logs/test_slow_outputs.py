"""Outputs that are read more slowly than the input: samples are readings, the input goes on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import SIGMA, TRUTH, linear_log, linear_problem

from softid.diagnosis import diagnose
from softid.diagnosis.logs.decimation import samples_to_average
from softid.diagnosis.logs.even_sampling import evenly_sampled
from softid.diagnosis.logs.slow_outputs import SlowOutputLog, at_readings
from softid.diagnosis_results import Verdict
from softid.log import Log

EVERY = 3


def slow(log: Log) -> Log:
    """The log with an angle at every third row only."""
    angle = log.channels["angle"]
    values = np.where(np.arange(len(log)) % EVERY == 0, angle.values, np.nan)
    return replace(log, channels={**log.channels, "angle": replace(angle, values=values)})


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


def test_what_was_read_between_is_not_averaged_away() -> None:
    """Nothing is averaged for good; copies that only choose take the readings alone, unless what is
    held would change at other times there."""
    log = at_readings(slow(linear_log(samples=9000)))
    assert samples_to_average([log], 1000.0, enough=1000) == 1
    even = evenly_sampled(log)
    assert even is not None
    assert samples_to_average([even], 1000.0, enough=1000) == 3
    assert evenly_sampled(replace(log, intersample="zoh")) is None


@pytest.mark.parametrize(("drift", "verdict"), [(0.0, Verdict.ADEQUATE), (0.02, Verdict.NAMED)])
def test_a_slow_camera_beside_a_gauge(drift: float, verdict: Verdict) -> None:
    """Known truth: nothing, which single residuals with gaps between them could not tell from a
    misfit, or a reading that drifts by 0.02 rad/s."""
    drifted = drift * linear_log(samples=2400).time_s
    fitted, held_out = (
        slow(linear_log(noise=0.01, seed=seed, samples=2400, added=drifted)) for seed in range(2)
    )
    found = diagnose(fitted, hold_out=held_out, model="oscillator")
    assert found.verdict is verdict
    assert [cause.effect for cause in found.causes] == (["sensor_drift"] if drift else [])
