"""Outputs that a slower sensor delivers: the repeats are left out of the residuals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import TRUTH, linear_log

from softid.identification import fit
from softid.identification.repeated_output import repeated_readings
from softid.log import Log


def repeated(log: Log, name: str, factor: int) -> Log:
    """The log with a channel that is read at every so many-th row, and repeated until then."""
    channel = log.channels[name]
    held = channel.values[(np.arange(len(log)) // factor) * factor]
    return replace(log, channels={**log.channels, name: replace(channel, values=held)})


@pytest.mark.parametrize("factor", [2, 3, 5])
def test_repeats_are_those_rows_without_a_new_reading(factor: int) -> None:
    """Known truth: every row but the first of each reading."""
    log = repeated(linear_log(noise=0.01), "angle", factor)
    expected = np.arange(len(log)) % factor != 0
    np.testing.assert_array_equal(repeated_readings(log), expected)
    assert not repeated_readings(linear_log(noise=0.01)).any()


def test_what_no_row_repeats_of_all_outputs_stays() -> None:
    """Beside an output that is read at every row nothing is left out, nor where one is missing."""
    log = repeated(linear_log(noise=0.01), "angle", 3)
    both = {**log.channels, "torque": linear_log(noise=0.01, seed=1).channels["angle"]}
    both["torque"] = replace(both["torque"], name="torque")
    assert not repeated_readings(replace(log, channels=both, outputs=("angle", "torque"))).any()
    values = log.channels["angle"].values.copy()
    values[300:330] = np.nan
    missing = {**log.channels, "angle": replace(log.channels["angle"], values=values)}
    assert not repeated_readings(replace(log, channels=missing))[300:330].any()


def test_a_slow_camera_does_not_change_the_parameters() -> None:
    """Known truth: the repeats are late by 20 and 40 ms, which the damping would take for its own.

    The fit says what it left out, and counts what is there.
    """
    log = repeated(linear_log(noise=0.002), "angle", 3)
    found = fit(log, model="oscillator")
    for name, true in TRUTH.items():
        low, high = found.parameter(name).ci95
        assert low <= true <= high
    (issue,) = [issue for issue in found.issues if issue.code == "repeated-output"]
    assert "repeats each reading for about 3 samples" in issue.message
    (row,) = found.statistics
    assert row.n == -(-len(log) // 3)
    assert row.rmse == pytest.approx(0.002, rel=0.15)


def lost(log: Log, share: float, *, seed: int = 0) -> Log:
    """The log with an angle that repeats its last reading where one was lost, at random."""
    channel = log.channels["angle"]
    arrived = np.random.default_rng(seed).random(len(log)) >= share
    last = np.maximum.accumulate(np.where(arrived, np.arange(len(log)), 0))
    values = channel.values[last]
    return replace(log, channels={**log.channels, "angle": replace(channel, values=values)})


def test_a_repeat_in_the_place_of_a_lost_packet_is_none() -> None:
    """Known truth: three in ten were lost; their repeats would leave 0.021 rad, not 0.002."""
    log = lost(linear_log(noise=0.002), 0.3)
    stale = np.append(False, np.diff(log.channels["angle"].values) == 0.0)
    np.testing.assert_array_equal(repeated_readings(log), stale)
    found = fit(log, model="oscillator")
    for name, true in TRUTH.items():
        parameter = found.parameter(name)
        assert parameter.value == pytest.approx(true, abs=3.0 * parameter.stderr)
    assert found.statistics[0].rmse == pytest.approx(0.002, rel=0.15)


@pytest.mark.parametrize("bits", [7, 8])
def test_a_converter_behind_a_curve_repeats_values_by_chance(bits: int) -> None:
    """Its values are on no even grid, but they come again and again."""
    log = linear_log(noise=0.002)
    channel = log.channels["angle"]
    levels = 2.0**bits
    values = np.round(np.sqrt(np.clip(channel.values + 0.1, 0.0, None) / 3.0) * levels)
    curved = replace(channel, values=3.0 * (values / levels) ** 2)
    assert not repeated_readings(replace(log, channels={**log.channels, "angle": curved})).any()
