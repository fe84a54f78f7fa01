"""Files that were merged from two recorders: every output has its own rows, without an input."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from softid.errors import InputError
from softid.identification import fit
from softid.identification.slow_outputs import at_readings
from softid.readers import load

Array = npt.NDArray[np.float64]
WriteFile = Callable[..., Path]

HEADER = "time_s,pressure_kpa,angle_rad\n"
TAU_S, GAIN = 0.2, 0.01
WAVES = ((40.0, 2.0), (25.0, 5.0))
"""Amplitude in kPa and angular frequency of what drives."""


def pressure(at_s: Array) -> Array:
    return 80.0 + np.sum([a * np.sin(w * at_s) for a, w in WAVES], axis=0)


def angle(at_s: Array) -> Array:
    """The settled answer of a first-order lag."""
    swing = [
        a * (np.sin(w * at_s) - w * TAU_S * np.cos(w * at_s)) / (1.0 + (w * TAU_S) ** 2)
        for a, w in WAVES
    ]
    return GAIN * (80.0 + np.sum(swing, axis=0))


def merged(gauge_s: Array, camera_s: Array) -> str:
    """A file with the rows of both in the order of time; digits enough for no time to be shared."""
    rows = [(t, f"{t:.6f},{p:.4f},") for t, p in zip(gauge_s, pressure(gauge_s), strict=True)]
    noise = 0.002 * np.random.default_rng(0).standard_normal(camera_s.size)
    seen = angle(camera_s) + noise
    rows += [(t, f"{t:.6f},,{y:.6f}") for t, y in zip(camera_s, seen, strict=True)]
    return HEADER + "\n".join(text for _, text in sorted(rows)) + "\n"


def test_two_recorders_with_clocks_of_their_own(write_log: WriteFile) -> None:
    """Known truth: gain and time constant by a fit, and the pressure between readings."""
    gauge_s, camera_s = np.arange(0.0, 30.0, 0.02), 0.0037 + np.arange(0.0, 29.9, 0.024)
    log = load(write_log(merged(gauge_s, camera_s)))
    assert len(log) == gauge_s.size + camera_s.size
    inside = (log.time_s > 0.1) & (log.time_s < 29.9)
    error = log.channels["pressure"].values - pressure(log.time_s)
    assert np.abs(error[inside]).max() < 0.1
    assert log.input_read_s is not None
    np.testing.assert_allclose(log.input_read_s, gauge_s, atol=1e-6)
    (issue,) = [issue for issue in log.issues if issue.code == "merged-rows"]
    assert f"{camera_s.size} rows have angle without pressure, the first in row 3" in issue.message
    found = fit(log, model="oscillator")
    q, n = found.parameter("Q"), found.parameter("N")
    assert q.value == pytest.approx(1.0 / GAIN, rel=0.002)
    assert n.value == pytest.approx(TAU_S / GAIN, rel=0.01)
    assert found.statistics[0].rmse == pytest.approx(0.002, rel=0.1)


def test_times_that_a_file_rounds_are_those_of_the_readings(write_log: WriteFile) -> None:
    """To the nearest 10 ms: as many come early as late, and a clock that rows lag behind would not.

    The frames are within half of that of where they were, by nothing on the average.
    """
    gauge_s, camera_s = np.arange(0.0, 30.0, 0.02), 0.0037 + np.arange(0.0, 29.9, 1.0 / 33.3)
    text = merged(gauge_s, camera_s)
    rows = [line.split(",", 1) for line in text.splitlines()[1:]]
    rounded = [f"{float(time):.2f},{rest}" for time, rest in rows]
    slow = at_readings(load(write_log(HEADER + "\n".join(rounded) + "\n")))
    off_s = slow.time_s - camera_s[: slow.time_s.size]
    assert np.abs(off_s).max() < 0.0051
    assert abs(float(off_s.mean())) < 0.0005


def test_where_the_input_stalls_nothing_is_put_in(write_log: WriteFile) -> None:
    """What the gauge did for two seconds is not on record; nor is what it did before and after."""
    gauge_s, camera_s = np.arange(1.0, 9.0, 0.02), 0.0037 + np.arange(0.0, 10.0, 0.024)
    gauge_s = gauge_s[(gauge_s < 4.0) | (gauge_s > 6.0)]
    log = load(write_log(merged(gauge_s, camera_s)))
    assert log.time_s[0] >= 1.0
    assert log.time_s[-1] <= 9.0
    assert not np.any((log.time_s > 4.0) & (log.time_s < 6.0))
    assert {"merged-rows", "missing-input"} <= {issue.code for issue in log.issues}


def test_rows_of_one_time_are_one_row(write_log: WriteFile) -> None:
    """A frame in the moment of a reading is no second sample; what contradicts is told."""
    rows = ["0,1,,7", "0,,0.5,70", "1,2,,8", "2,3,0.7,9", "2,3,0.9,71", "3,4,,10", "3,,0.8,72"]
    header = HEADER.replace("\n", ",counter\n")
    log = load(write_log(header + "\n".join(rows) + "\n"))
    assert log.time_s.tolist() == [0.0, 1.0, 2.0, 3.0]
    np.testing.assert_array_equal(log.channels["angle"].values, [0.5, np.nan, 0.7, 0.8])
    assert "duplicate-times" in {issue.code for issue in log.issues}
    assert "merged-rows" not in {issue.code for issue in log.issues}


def test_recorders_without_a_common_time_are_refused(write_log: WriteFile) -> None:
    """What the pressure was when the angle was read is not on record."""
    file = write_log(merged(np.arange(0.0, 5.0, 0.02), np.arange(60.0, 65.0, 0.02)))
    with pytest.raises(InputError) as caught:
        load(file)
    assert "read from 60 to 64.98 s, has no pressure beside it" in str(caught.value)
    assert caught.value.remedy
