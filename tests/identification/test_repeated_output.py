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
