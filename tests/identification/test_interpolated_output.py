"""Outputs that were interpolated to a faster clock."""

from __future__ import annotations

import numpy as np
import pytest

from softid.diagnosis import diagnose
from softid.diagnosis_results import Verdict
from softid.identification import fit
from softid.identification.interpolated_output import interpolated_samples, recovered_readings
from softid.identification.preparation import without_dropouts
from softid.identification.slow_outputs import at_readings
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


@pytest.mark.parametrize("noise", [0.05, 0.1])
def test_slow_readings_of_ramps_with_a_few_quick_bends_have_none(noise: float) -> None:
    """Ramps that last for twenty readings, with noise, and a quick swing at the end, beside whose
    bends the noise is so small that every reading of a ramp seems to lie on it exactly."""
    read_s = 0.2 * np.arange(240)
    ramps = 20.0 * np.abs((read_s / 8.0) % 1.0 - 0.5)
    swing = 40.0 * np.sin(9.0 * read_s) * (read_s > 40.0)
    for seed in range(3):
        noisy = noise * np.random.default_rng(seed).standard_normal(read_s.size)
        channels = {"pressure": read_s, "angle": ramps + swing + noisy}
        assert not interpolated_samples(Log.from_arrays(read_s, channels)).any()


@pytest.mark.parametrize("hidden", [[], ["sensor_clipping"], ["coulomb_friction"]])
def test_what_was_sampled_has_none(hidden: list[str]) -> None:
    """Noise, rests, limits and the corners of dry friction are no interpolation."""
    for log in hidden_pair(hidden, seed=620).logs:
        assert not interpolated_samples(log).any()
    still = np.repeat([0.0, 1.0, 0.0, 1.0], 100)
    log = Log.from_arrays(np.arange(400.0), {"pressure": np.arange(400.0), "angle": still})
    assert not interpolated_samples(log).any()


@pytest.mark.parametrize("rate_hz", [10.0, 20.0, 100.0])
@pytest.mark.parametrize("step", [0.5, 1.0, 2.0])
def test_what_is_rounded_coarsely_was_sampled(step: float, rate_hz: float) -> None:
    """An encoder of 1 degree, or a gauge that tells whole kPa: every fifth reading, or more, lies
    exactly between its neighbours."""
    rng = np.random.default_rng(2)
    time_s = np.arange(0.0, 60.0, 1.0 / rate_hz)
    angle = 40.0 * np.sin(time_s) + 0.4 * rng.standard_normal(time_s.size)
    rounded = step * np.round(angle / step)
    log = Log.from_arrays(time_s, {"pressure": time_s, "angle": rounded})
    assert not interpolated_samples(log).any()


def test_a_ramp_without_a_corner_says_nothing() -> None:
    """Every sample lies on the line, and none tells a reading."""
    time_s = np.arange(0.0, 20.0, 0.1)
    log = Log.from_arrays(time_s, {"pressure": time_s, "angle": np.arange(200.0)})
    assert not interpolated_samples(log).any()


@pytest.mark.parametrize("times", [2, 3, 4])
def test_rounded_readings_are_told_from_what_lies_between_them(times: int) -> None:
    """Halves, thirds and quarters of the step of a sensor are no readings of it."""
    rng = np.random.default_rng(2)
    read_s = np.arange(0.0, 60.0, 0.05)
    angle = 40.0 * np.sin(read_s) + 0.4 * rng.standard_normal(read_s.size)
    readings = 0.1 * np.round(angle / 0.1)
    time_s = np.arange(0.0, 59.0, 0.05 / times)
    values = np.interp(time_s, read_s, readings)
    log = Log.from_arrays(time_s, {"pressure": time_s, "angle": values})
    between = interpolated_samples(log)
    assert between.mean() == pytest.approx(1.0 - 1.0 / times, rel=0.1)
    assert np.mean(np.flatnonzero(between) % times != 0) > 0.95  # a reading may lie on a line


@pytest.mark.slow
def test_a_log_that_was_resampled_is_adequate() -> None:
    """Recorded at 40 Hz and brought to 100 Hz; neighbouring samples share their noise."""
    train, hold_out = hidden_pair([], seed=621, rig=Rig(rate_hz=40.0)).logs
    logs = [brought_to(log, RATE_HZ) for log in (train, hold_out)]
    found = diagnose(logs[0], hold_out=[logs[1]], model="muscle")
    assert found.verdict is Verdict.ADEQUATE
    told = [i.message for i in found.issues if i.code == "recovered-readings"]
    assert len(told) == 2
    assert "an interpolation to a faster clock; 40 readings a second stay" in told[0]


@pytest.mark.parametrize("digits", [4, 9])
@pytest.mark.parametrize("reading_hz", [16.7, 24.0, 25.0, 30.0, 37.0, 40.0])
def test_readings_are_where_the_lines_meet(reading_hz: float, digits: int) -> None:
    """What was interpolated is found again: times to a fiftieth of a sampling interval, values to
    twice what the rounding takes and a hundredth of the noise, for the clock is off by a little."""
    rng = np.random.default_rng(1)
    read_s = np.arange(-1.0 / reading_hz + 0.0034, 62.0, 1.0 / reading_hz)
    angle = np.sin(read_s) + 5e-3 * rng.normal(size=read_s.size)
    time_s = np.arange(0.0, 60.0, 1.0 / RATE_HZ)
    values = np.round(np.interp(time_s, read_s, angle), digits)
    log = Log.from_arrays(time_s, {"pressure": time_s, "angle": values})
    readings = recovered_readings(log)
    assert readings is not None
    taken_s, found = readings[0], readings[1]["angle"]
    within = (read_s >= time_s[0]) & (read_s <= time_s[-1])
    np.testing.assert_allclose(taken_s, read_s[within], atol=0.02 / RATE_HZ)
    told = np.isfinite(found)
    assert told.mean() > 0.99
    np.testing.assert_allclose(found[told], angle[within][told], atol=2.0 * 10.0**-digits + 5e-5)


def test_an_uneven_sensor_is_thinned() -> None:
    """No regular clock explains where its lines meet, so one sample a reading stays."""
    rng = np.random.default_rng(2)
    read_s = np.cumsum(rng.uniform(0.02, 0.06, 1600))
    time_s = np.arange(1.0, 60.0, 1.0 / RATE_HZ)
    angle = np.interp(time_s, read_s, np.sin(read_s) + 5e-3 * rng.normal(size=read_s.size))
    log = Log.from_arrays(time_s, {"pressure": time_s, "angle": angle})
    assert recovered_readings(log) is None


def test_lost_samples_of_what_was_interpolated_stay_lost() -> None:
    """A reading counts where the log counts a sample nearby; the course of the input is that of
    all rows."""
    read_s = np.arange(0.004, 62.0, 1.0 / 30.0)
    angle = np.sin(read_s) + 5e-3 * np.random.default_rng(4).normal(size=read_s.size)
    time_s = np.arange(0.0, 60.0, 1.0 / RATE_HZ)
    pressure = np.sin(1.3 * time_s)
    values = {"pressure": pressure, "angle": np.interp(time_s, read_s, angle)}
    lost = (time_s > 20.0) & (time_s < 25.0)
    found = at_readings(without_dropouts(Log.from_arrays(time_s, values).with_masked(lost)))
    counts = found.time_s[~found.masked]
    assert not np.any((counts > 20.05) & (counts < 24.95))
    assert counts.size == pytest.approx(55 * 30, abs=5)
    assert found.period_s == pytest.approx(1.0 / 30.0)
    (segment,) = found.segments()
    read = np.interp(time_s[1000:5000], segment.readings[0], segment.readings[1])
    np.testing.assert_allclose(read, pressure[1000:5000], atol=1e-9)


def test_errors_are_those_of_the_readings() -> None:
    """Standard errors of a fit to the readings, and to what was made of them, to a third."""
    train, _ = hidden_pair([], seed=622, rig=Rig(rate_hz=50.0)).logs
    given = {p.name: p for p in fit(train, model="muscle").parameters}
    made = {p.name: p for p in fit(brought_to(train, RATE_HZ), model="muscle").parameters}
    for name in ("a1", "b1", "c1"):
        assert made[name].stderr == pytest.approx(given[name].stderr, rel=0.33)
