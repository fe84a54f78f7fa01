"""Outputs that were interpolated to a faster clock."""

from __future__ import annotations

import numpy as np
import pytest

from softid.diagnosis import diagnose
from softid.diagnosis_results import Verdict
from softid.identification import fit
from softid.identification.interpolated_output import interpolated_samples
from softid.log import Log
from softid.synthesis import hidden_pair
from softid.synthesis.rig import Rig

RATE_HZ = 100.0


def brought_to(log: Log, rate_hz: float) -> Log:
    """Both channels as straight lines at the times of a faster clock."""
    time_s = np.arange(0.0, log.time_s[-1], 1.0 / rate_hz)
    channels = {
        name: np.round(np.interp(time_s, log.time_s, channel.values), 6)
        for name, channel in log.channels.items()
    }
    return Log.from_arrays(time_s, channels, name=log.name)


@pytest.mark.parametrize("noise", [0.0, 5e-3])
@pytest.mark.parametrize("reading_hz", [20.0, 25.0, 30.0, 40.0, 50.0])
def test_one_sample_a_reading_stays(reading_hz: float, noise: float) -> None:
    """Where readings are at samples they stay, but for one in fifty that lies on the line of its
    neighbours; else every so many samples as span a reading."""
    read_s = np.arange(0.0, 60.0, 1.0 / reading_hz)
    angle = np.sin(read_s) + noise * np.random.default_rng(3).normal(size=read_s.size)
    time_s = np.arange(0.0, 59.0, 1.0 / RATE_HZ)
    values = np.round(np.interp(time_s, read_s, angle), 6)
    log = Log.from_arrays(time_s, {"pressure": time_s, "angle": values})
    kept = ~interpolated_samples(log)
    assert kept.mean() == pytest.approx(1.0 / np.ceil(RATE_HZ / reading_hz), rel=0.06)
    if RATE_HZ % reading_hz == 0.0:
        assert np.mean(np.flatnonzero(kept) % int(RATE_HZ / reading_hz) == 0) > 0.99


@pytest.mark.parametrize("hidden", [[], ["sensor_clipping"], ["coulomb_friction"]])
def test_what_was_sampled_has_none(hidden: list[str]) -> None:
    """Noise, rests, limits and the corners of dry friction are no interpolation."""
    for log in hidden_pair(hidden, seed=620).logs:
        assert not interpolated_samples(log).any()
    still = np.repeat([0.0, 1.0, 0.0, 1.0], 100)
    log = Log.from_arrays(np.arange(400.0), {"pressure": np.arange(400.0), "angle": still})
    assert not interpolated_samples(log).any()


def test_a_log_that_was_resampled_is_adequate() -> None:
    """Recorded at 40 Hz and brought to 100 Hz; neighbouring samples share their noise."""
    train, hold_out = hidden_pair([], seed=621, rig=Rig(rate_hz=40.0)).logs
    logs = [brought_to(log, RATE_HZ) for log in (train, hold_out)]
    found = diagnose(logs[0], hold_out=[logs[1]], model="muscle")
    assert found.verdict is Verdict.ADEQUATE
    told = [i.message for i in found.issues if i.code == "interpolated-output"]
    assert len(told) == 2
    assert "an interpolation to a faster clock; 33.3 samples a second stay" in told[0]


def test_errors_are_those_of_the_readings() -> None:
    """Standard errors of a fit to the readings, and to what was made of them, to a third."""
    train, _ = hidden_pair([], seed=622, rig=Rig(rate_hz=50.0)).logs
    given = {p.name: p for p in fit(train, model="muscle").parameters}
    made = {p.name: p for p in fit(brought_to(train, RATE_HZ), model="muscle").parameters}
    for name in ("a1", "b1", "c1"):
        assert made[name].stderr == pytest.approx(given[name].stderr, rel=0.33)
