"""That an input which saturates is told where it may be what is missing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from handmade_diagnosis import diagnosis

from softid.diagnosis.report.clipped_input import (
    CLIPPED_INPUT,
    clipped_input_issues,
    with_clipped_input,
)
from softid.diagnosis_results import Verdict
from softid.log import Log

TIME_S = np.arange(3000) * 0.01


def log_of(low: float, high: float) -> Log:
    """A noisy sine of the pressure from 0 to 200 kPa behind a gauge that ends at both limits."""
    noise = 0.3 * np.random.default_rng(0).standard_normal(TIME_S.size)
    pressure = 100.0 - 100.0 * np.cos(TIME_S) + noise
    angle = np.sin(TIME_S) + 1e-3 * noise[::-1]
    channels = {"pressure": np.clip(pressure, low, high), "angle": angle}
    return Log.from_arrays(TIME_S, channels, name="clipped")


def test_what_stops_at_the_end_of_a_gauge_is_told() -> None:
    """By hand: a cosine is above 1/√2 for a quarter of its period, here above 170.7 kPa."""
    (issue,) = clipped_input_issues(log_of(-10.0, 170.7))
    assert "clipped: pressure stands at exactly 170.7 kPa in 2" in issue.message
    assert "larger range" in str(issue.remedy)


@pytest.mark.parametrize("low", [-10.0, 5.0], ids=["free", "vented"])
def test_a_gauge_that_does_not_end_above_is_not(low: float) -> None:
    """Noise at the top; a vented actuator rests at the lower end."""
    assert clipped_input_issues(log_of(low, 500.0)) == ()


@pytest.mark.parametrize("verdict", Verdict)
def test_it_is_told_where_something_is_missing(verdict: Verdict) -> None:
    """It comes before any other experiment where nothing has a name."""
    answer = replace(diagnosis(verdict), next_experiment="record more")
    found = with_clipped_input(answer, [log_of(-10.0, 150.0)])
    told = [issue for issue in found.issues if issue.code == CLIPPED_INPUT]
    assert len(told) == (verdict not in (Verdict.ADEQUATE, Verdict.NAMED))
    assert (found.next_experiment == "record more") is (verdict is not Verdict.UNKNOWN)
