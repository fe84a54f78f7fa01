"""A pressure that is read by a slower sensor and repeated until the next reading."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

import softid
from softid.excitation.texture import SampleHold
from softid.identification.issues import RANGE_MARGIN, extrapolation, fitted_range
from softid.identification.repeated_input import readings_of, without_repeats
from softid.log import Log, LogSet

Array = npt.NDArray[np.float64]

RATE_HZ, SLOWER_HZ = 120.0, 25.0
TAU_S = 0.2


def recorded(*, repeated: bool = True, channel: str = "pressure", jitter_s: float = 0.0) -> Log:
    """τ ẏ + y = u for two sines, u read 25 times a second, or nearly, into a file of 120 Hz."""
    time_s = np.arange(0.0, 30.0, 1.0 / RATE_HZ)
    waves = ((40.0, 2.0), (25.0, 5.0))

    def pressure(at_s: Array) -> Array:
        return 80.0 + np.sum([a * np.sin(w * at_s) for a, w in waves], axis=0)

    y = 80.0 + sum(
        a * (np.sin(w * time_s) - w * TAU_S * np.cos(w * time_s)) / (1.0 + (w * TAU_S) ** 2)
        for a, w in waves
    )
    read_s = time_s
    if repeated:
        clock_s = np.arange(0.0, 30.0, 1.0 / SLOWER_HZ)
        clock_s[1:] += np.random.default_rng(4).uniform(-jitter_s, jitter_s, clock_s.size - 1)
        read_s = clock_s[np.searchsorted(clock_s, time_s + 1e-9) - 1]
    noise = np.random.default_rng(3).standard_normal(time_s.size)
    channels = {channel: pressure(read_s), "angle": 0.01 * y + 0.002 * noise}
    return Log.from_arrays(time_s, channels, input=channel, outputs=("angle",))


def test_the_course_between_the_readings_is_smooth() -> None:
    """Within 0.05 % of the range, and told; the repeats miss it by 6 %."""
    told = without_repeats(recorded())
    true = recorded(repeated=False).channels["pressure"].values
    span = float(np.ptp(true))
    inside = slice(5, -10)
    assert np.abs(told.channels["pressure"].values - true)[inside].max() < 0.0005 * span
    assert np.abs(recorded().channels["pressure"].values - true)[inside].max() > 0.05 * span
    (issue,) = told.issues
    assert issue.code == "repeated-input"
    assert "repeats each value for about 4.8 samples (new values at 25 Hz)" in issue.message


def test_nothing_swings_beside_a_jump() -> None:
    """Known truth: a sine that jumps by 60 between two readings, and goes on; within 0.3 of it."""
    log = recorded()
    time_s, pressure = log.time_s, log.channels["pressure"]
    higher = pressure.values + 60.0 * (time_s >= 15.0)
    jumping = {**log.channels, "pressure": replace(pressure, values=higher)}
    told = without_repeats(replace(log, channels=jumping)).channels["pressure"].values
    usual = without_repeats(log).channels["pressure"].values
    away = np.abs(time_s - 15.0) > 1.5 / SLOWER_HZ
    assert np.abs(told - usual - 60.0 * (time_s >= 15.0))[away].max() < 0.3


def test_a_sensor_without_a_clock_is_read_when_its_value_is_first_seen() -> None:
    """The rms error is less than a third of that of the repeats; a sample's delay is left."""
    log = recorded(jitter_s=0.015)
    true = recorded(repeated=False).channels["pressure"].values
    bridged, repeats = (x.channels["pressure"].values - true for x in (without_repeats(log), log))
    assert 0.0 < np.std(bridged) < 0.3 * np.std(repeats)


def test_what_brings_news_at_every_sample_is_left_alone() -> None:
    """The pressure is read as often as the output."""
    log = recorded(repeated=False)
    assert without_repeats(log) is log


@pytest.mark.parametrize(
    "log",
    [
        recorded(channel="pressure_command"),
        replace(recorded(), intersample="zoh"),
        replace(recorded(), intersample="held"),
        replace(recorded(), intersample="straight"),
    ],
    ids=["command", "zoh", "held", "straight"],
)
def test_a_command_or_a_declared_input_is_left_alone(log: Log) -> None:
    """Somebody has said what the input does between its samples."""
    assert without_repeats(log) is log


def test_steps_that_somebody_wanted_are_no_repeats() -> None:
    """Levels of half a second behind a sine, sampled at 20 Hz: half of the samples are repeats."""
    time_s = np.arange(0.0, 120.0, 0.05)
    levels = np.repeat(np.random.default_rng(1).uniform(0.0, 240.0, time_s.size // 10), 10)
    u = np.where(time_s < 55.0, 120.0 - 120.0 * np.cos(np.pi * time_s), levels)
    log = Log.from_arrays(time_s, {"pressure": u, "angle": u}, outputs=("angle",))
    assert without_repeats(log) is log


def test_a_fit_finds_the_time_constant() -> None:
    """Within 1 %; from the repeats it would be off by half a reading, 20 ms of 200."""
    found = softid.fit(recorded(), model="oscillator")
    values = found.values
    assert values["N"] / values["Q"] == pytest.approx(TAU_S, rel=0.01)
    assert any(issue.code == "repeated-input" for issue in found.issues)
    as_it_stands = softid.fit(replace(recorded(), intersample="zoh"), model="oscillator").values
    assert abs(as_it_stands["N"] / as_it_stands["Q"] / TAU_S - 1.0) > 0.05


def test_a_score_reads_the_input_alike() -> None:
    found = softid.fit(recorded(), model="oscillator")
    (score,) = softid.validate(found, replace(recorded(), name="other")).statistics
    (fitted,) = found.statistics
    assert score.rmse == pytest.approx(fitted.rmse, rel=1e-3)


def test_readings_closer_than_half_a_period_give_no_clock() -> None:
    """A segment of twelve samples with two changes in it: each is read when it is first seen."""
    time_s = np.arange(12) / RATE_HZ
    values = np.repeat([1.0, 2.0, 3.0], [3, 2, 7])
    hold = SampleHold(4.8, 4.8 / RATE_HZ, RATE_HZ / 4.8)
    read_s, read = readings_of(time_s, values, hold)
    assert set(read_s) <= set(time_s)
    assert read.tolist() == values[np.searchsorted(time_s, read_s)].tolist()


@pytest.mark.parametrize(
    ("step", "told"), [(1e-9, "for about 1.4 samples"), (1.0, "rows, as all else does")]
)
def test_rows_that_are_lost_as_a_whole_are_bridged(step: float, told: str) -> None:
    """Known truth: where the output repeats its reading the input does, too, and is on its way.

    With the input repeated 0.05 of its range is the largest error, bridged 0.02, also where its
    values are so coarse that they come again without any loss.
    """
    log = recorded(repeated=False)
    true = step * np.round(log.channels["pressure"].values / step)
    true_range = float(np.ptp(true))
    arrived = np.random.default_rng(0).random(len(log)) >= 0.3
    last = np.maximum.accumulate(np.where(arrived, np.arange(len(log)), 0))
    log = replace(
        log,
        channels={**log.channels, "pressure": replace(log.channels["pressure"], values=true)},
    )
    channels = {name: replace(c, values=c.values[last]) for name, c in log.channels.items()}
    lossy = replace(log, channels=channels)
    bridged = without_repeats(lossy)
    late, left = (
        float(np.abs(x.channels["pressure"].values - true)[: last[-1]].max()) / true_range
        for x in (lossy, bridged)
    )
    assert left < 0.02 < 0.05 < late
    (issue,) = bridged.issues
    assert told in issue.message
    alone = {**log.channels, "angle": channels["angle"]}
    assert without_repeats(replace(log, channels=alone)).issues == ()


def test_the_range_is_that_of_the_readings() -> None:
    """The course swings up to 2 kPa beyond them beside a corner between two readings, which nobody
    recorded: neither the fitted range nor what is told of a log scored says so."""
    lowest, highest = 20.0, 140.0
    log = recorded()
    pressure, angle = log.channels["pressure"], log.channels["angle"]
    ramp = np.clip(pressure.values, lowest, highest)
    log = replace(log, channels={"pressure": replace(pressure, values=ramp), "angle": angle})
    bridged = without_repeats(log)
    assert bridged.channels["pressure"].values.max() > highest + 1.0
    assert fitted_range(LogSet((bridged,)))["pressure"] == (lowest, highest)
    margin = RANGE_MARGIN * (highest - lowest)
    narrow = {"pressure": (lowest + 2.0 * margin, highest)}
    issue = extrapolation(bridged, "pressure", narrow)
    assert issue is not None
    assert "pressure reaches 20 kPa" in issue.message
    nearly_all = {"pressure": (lowest, highest - 0.9 * margin)}
    assert extrapolation(bridged, "pressure", nearly_all) is None
