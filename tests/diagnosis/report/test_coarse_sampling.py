"""What the input may have done between its samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade_diagnosis import diagnosis
from linear_motion import at_truth, linear_log

from softid.diagnosis.report.coarse_sampling import (
    COARSE_SAMPLING,
    coarse_sampling_issues,
    with_coarse_sampling,
)
from softid.diagnosis_results import Verdict


@pytest.mark.parametrize(("noise", "told"), [(0.01, True), (0.03, False)])
def test_jumps_within_an_interval_are_told_where_they_make_what_is_left(
    noise: float, told: bool
) -> None:
    """By hand: eight jumps of about 60 kPa in 20 s, each Δ T/√12 = 0.35 kPa·s off, with Q = 50
    kPa/rad and a time constant of 0.2 s make 0.007 rad rms, half the power of a noise of 0.01."""
    found = coarse_sampling_issues(at_truth(linear_log(noise=noise)))
    assert bool(found) is told
    if told:
        assert "pressure moves faster than it is sampled, every 0.02 s" in found[0].message
        assert "power of what is left" in found[0].message


def test_what_is_held_or_open_is_not_told_again() -> None:
    log = linear_log(noise=0.01)
    assert not coarse_sampling_issues(at_truth(log.with_intersample("zoh")))
    assert not coarse_sampling_issues(at_truth(log), open_jumps=8)


def test_a_slower_gauge_counts_by_its_readings() -> None:
    """Ten times a second: five times the effect of the samples, and told with noise of 0.03."""
    log = linear_log(noise=0.03)
    pressure = log.channels["pressure"]
    read_s = log.time_s[::5]
    course = np.interp(log.time_s, read_s, pressure.values[::5])
    channels = {**log.channels, "pressure": replace(pressure, values=course)}
    slow = replace(log, channels=channels, input_read_s=read_s)
    (found,) = coarse_sampling_issues(at_truth(slow))
    assert "every 0.1 s" in found.message


@pytest.mark.parametrize("verdict", [Verdict.UNKNOWN, Verdict.PARTIAL])
def test_an_unknown_cause_asks_for_faster_samples_first(verdict: Verdict) -> None:
    """A cause that is named has its own experiment."""
    answer = replace(diagnosis(verdict), next_experiment="repeat it")
    told = with_coarse_sampling(answer, at_truth(linear_log(noise=0.01)))
    is_told = COARSE_SAMPLING in {issue.code for issue in told.issues}
    assert is_told is (verdict is Verdict.UNKNOWN)
    assert ("several times as fast" in (told.next_experiment or "")) is is_told
