"""A misfit that goes with a channel which is no input of the model."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter, lsim

from softid import Log, diagnose
from softid.diagnosis.report.second_input import FOLLOWS_SECOND_INPUT
from softid.diagnosis.verdict.second_input import LAG_TIMES, _lagged
from softid.diagnosis_results import Diagnosis, Verdict

TIME_S = np.arange(0.0, 40.0, 0.02)


def levels(seed: int) -> np.ndarray:
    """Random levels of 0.6 to 4 s behind a valve of 0.1 s, in kPa."""
    rng = np.random.default_rng(seed)
    steps, at = np.zeros_like(TIME_S), 2.0
    while at < TIME_S[-1]:
        steps[at <= TIME_S] = rng.uniform(0.0, 200.0)
        at += rng.uniform(0.6, 4.0)
    keeps = np.exp(-0.02 / 0.1)
    return np.asarray(lfilter([1.0 - keeps], [1.0, -keeps], steps))


def log_of(seed: int, *, share: float, drift: float) -> Log:
    """An oscillator that two pressures drive, the second by a share of the first."""
    first, second = levels(seed), levels(seed + 1000)
    _, angle, _ = lsim(([0.01], [0.02, 0.4, 1.0]), first + share * second, TIME_S)
    noise = np.random.default_rng(seed).normal(0.0, 0.01, TIME_S.size)
    channels = {
        "pressure": first,
        "second_kpa": second,
        "angle": angle + drift * TIME_S + noise,
    }
    units = {"second_kpa": "kPa"}
    return Log.from_arrays(TIME_S, channels, units=units, outputs=["angle"], name=f"log{seed}")


def diagnosed(*, share: float = 0.0, drift: float = 0.0) -> Diagnosis:
    """The diagnosis of one log, judged by another."""
    train, hold_out = (log_of(seed, share=share, drift=drift) for seed in (10, 20))
    effects = ("sensor_drift", "creep", "hysteresis")
    return diagnose(train, hold_out=[hold_out], model="oscillator", effects=effects)


@pytest.mark.parametrize("share", [0.3, 0.03])
def test_a_second_chamber_is_no_cause_of_the_catalogue(share: float) -> None:
    """The motion that it makes is told as what it is, however small, and nothing is named."""
    found = diagnosed(share=share)
    assert found.verdict is Verdict.UNKNOWN
    assert found.causes == ()
    (told,) = (issue for issue in found.issues if issue.code == FOLLOWS_SECOND_INPUT)
    assert told.message.startswith("what is missing follows second_kpa")
    assert "follows second_kpa" in found.summary
    assert (
        found.next_experiment == "record logs in which second_kpa is held, or moves with pressure"
    )


def test_a_second_pressure_that_drives_nothing_takes_no_name_away() -> None:
    """A drift is a drift, whatever another gauge shows."""
    found = diagnosed(drift=0.01)
    assert found.verdict is Verdict.NAMED
    assert [cause.effect for cause in found.causes] == ["sensor_drift"]
    assert FOLLOWS_SECOND_INPUT not in {issue.code for issue in found.issues}


def test_a_channel_in_pairs_of_samples_lags_as_another() -> None:
    """Closed form: a ramp is late by the lag once that has passed. Pairs 1 µs apart every 0.1 s:
    over times at median intervals it would be 20,000,000 values for each lag."""
    first_s = 0.1 * np.arange(200)
    time_s = np.sort(np.concatenate((first_s, first_s + 1e-6)))
    log = Log.from_arrays(time_s, {"pressure": 3.0 * time_s, "angle": time_s})
    lagged = _lagged(log, "pressure", time_s, 0.5)
    late = time_s > 15.0
    for lag, column in zip(LAG_TIMES, lagged.T, strict=True):
        expected = 3.0 * (time_s - 0.5 * lag) if lag else 3.0 * time_s
        np.testing.assert_allclose(column[late], expected[late], atol=0.05)
