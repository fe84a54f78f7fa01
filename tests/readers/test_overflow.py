"""Counters and angles that begin again at the end of their range."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from softid.errors import InputError
from softid.readers import load
from softid.readers.overflow import SMOOTH, TURN_RAD, counted_on, turned_on

WriteFile = Callable[..., Path]
STEPS_MS = np.array([20, 21, 19, 20, 40, 20, 20, 20, 20, 20])


@pytest.mark.parametrize("bits", [16, 32])
def test_a_counter_goes_on(bits: int) -> None:
    """Known truth, also where a cell is empty on both sides of the end."""
    truth = 2.0**bits - 70.0 + np.cumsum(STEPS_MS)
    counts = truth % 2.0**bits
    np.testing.assert_array_equal(counted_on(counts).values, truth)
    assert counted_on(counts).at.tolist() == [3]
    counts[[2, 3]] = np.nan
    found = counted_on(counts)
    np.testing.assert_array_equal(found.values, np.where(np.isnan(counts), np.nan, truth))
    assert found.at.tolist() == [4]


def test_a_counter_that_overflows_often() -> None:
    """16 bits of milliseconds hold 65.5 s: three minutes overflow twice."""
    truth = 20.0 * np.arange(9000)
    np.testing.assert_array_equal(counted_on(truth % 2.0**16).values, truth)


@pytest.mark.parametrize(
    "counts",
    [
        [0.0, 20.0, 40.0, 0.0, 20.0],
        [65000.0, 65020.0, 65040.0, 4.0, 24.0],
        [65480.5, 65500.5, 65520.5, 4.5, 24.5],
        [65490.0, 65510.0, 65530.0, 65490.0, 65510.0],
        [0.0, 20.0, 40.0, 60.0],
    ],
    ids=["begun anew", "half a second lost", "no whole numbers", "out of order", "runs forward"],
)
def test_what_is_no_overflow_stays(counts: list[float]) -> None:
    assert counted_on(np.array(counts)).values.tolist() == counts


def test_the_time_of_a_file_goes_on_and_says_so(write_log: WriteFile) -> None:
    """The second is counted from the first cell as before; one begun anew is refused."""
    rows = [f"{(65480 + 20 * k) % 65536};{k};{k}" for k in range(6)]
    log = load(write_log("\n".join(("t_ms;pressure_kpa;angle_deg", *rows))))
    np.testing.assert_allclose(log.time_s, 65.48 + 0.02 * np.arange(6), rtol=0.0, atol=1e-9)
    (issue,) = [issue for issue in log.issues if issue.code == "counter-overflow"]
    assert "row 5" in issue.message
    assert "once" in issue.message
    anew = [f"{20 * (k % 3)};{k};{k}" for k in range(6)]
    with pytest.raises(InputError, match="runs backward"):
        load(write_log("\n".join(("t_ms;pressure_kpa;angle_deg", *anew))))


def swing(turns: float, about_rad: float = np.pi) -> np.ndarray:
    """An angle that swings about the end of a range, 500 samples."""
    swung: np.ndarray = about_rad + turns * TURN_RAD * np.sin(np.linspace(0.0, 25.0, 500))
    return swung


@pytest.mark.parametrize("lowest", [-np.pi, 0.0], ids=["-180 to 180", "0 to 360"])
def test_an_angle_turns_on(lowest: float) -> None:
    """Known truth but for whole turns, with a sample missing at an end."""
    truth = swing(0.3, lowest) + 0.5
    told = (truth - lowest) % TURN_RAD + lowest
    told[np.flatnonzero(np.abs(np.diff(told)) > 3.0)[2]] = np.nan
    found = turned_on(told)
    assert found.at.size > 5
    np.testing.assert_allclose(
        np.diff(found.values - truth)[~np.isnan(np.diff(told))], 0, atol=1e-9
    )


def test_no_other_jump_is_a_turn() -> None:
    """Readings of zero while a marker was lost, a jump of 200°, and a drive beyond one turn."""
    lost = swing(0.2) + 0.5
    lost[100:103] = 0.0
    jumped = np.where(np.arange(500) < 250, -1.7, 1.7) + 0.01 * swing(0.3)
    beyond = np.where(np.arange(500) % 100 < 50, 0.0, 1.02 * TURN_RAD)
    square = np.where(np.arange(500) % 100 < 50, 0.0, 0.95 * TURN_RAD - 2.0 * SMOOTH * TURN_RAD)
    for told in (lost, jumped, beyond, square):
        assert turned_on(told).values is told


def test_an_angle_that_jumps_otherwise_too_stays() -> None:
    """It passes the end of a turn, and reads zero, half a turn away, while a marker was lost."""
    told = (swing(0.3) + 0.5 + np.pi) % TURN_RAD - np.pi
    assert turned_on(told).at.size > 5
    told[100:103] = 0.0
    assert turned_on(told).values is told


def test_the_angle_of_a_file_turns_on_and_says_so(write_log: WriteFile) -> None:
    """In the unit of the file; the row is that of the first sample behind the end."""
    truth = 150.0 + 3.0 * np.arange(20)
    told = (truth + 180.0) % 360.0 - 180.0
    rows = [f"{0.02 * k:.2f};{k};{angle:.1f}" for k, angle in enumerate(told)]
    log = load(write_log("\n".join(("time_s;pressure_kpa;angle_deg", *rows))))
    np.testing.assert_allclose(np.degrees(log.channels["angle"].values), truth, atol=1e-9)
    (issue,) = [issue for issue in log.issues if issue.code == "wrapped-angle"]
    assert "a turn, 360 deg, once, the first in row 12" in issue.message
