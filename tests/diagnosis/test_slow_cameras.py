"""A diagnosis of outputs that are read more slowly than the input."""

from __future__ import annotations

from dataclasses import replace

import pytest
from linear_motion import linear_log
from slow_camera import slow

from softid.diagnosis import diagnose
from softid.diagnosis.logs.decimation import samples_to_average
from softid.diagnosis.logs.even_sampling import evenly_sampled
from softid.diagnosis_results import Verdict
from softid.identification.slow_outputs import at_readings


def test_what_was_read_between_is_not_averaged_away() -> None:
    """Nothing is averaged for good; copies that only choose take the readings alone, unless what is
    held would change at other times there."""
    log = at_readings(slow(linear_log(samples=9000)))
    assert samples_to_average([log], 1000.0, enough=1000) == 1
    even = evenly_sampled(log)
    assert even is not None
    assert samples_to_average([even], 1000.0, enough=1000) == 3
    assert evenly_sampled(replace(log, intersample="zoh")) is None


@pytest.mark.parametrize(
    ("drift", "verdict"),
    [(0.0, Verdict.ADEQUATE), pytest.param(0.02, Verdict.NAMED, marks=pytest.mark.slow)],
)
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
