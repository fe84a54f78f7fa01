"""Angles that begin again at the end of a turn."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from softid.quality import inspect, misleading_channels
from softid.readers import load
from softid.readers.turns import SMOOTH, TURN_RAD, Turns, find_turns

WriteFile = Callable[..., Path]


def turns_of(angle_rad: np.ndarray) -> Turns:
    """At even times."""
    return find_turns(0.01 * np.arange(angle_rad.size), angle_rad)


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
    found = turns_of(told)
    assert found.at.size > 5
    assert found.going_on is not None
    np.testing.assert_allclose(
        np.diff(found.going_on - truth)[~np.isnan(np.diff(told))], 0, atol=1e-9
    )


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("noise_before", [True, False], ids=["in the encoder", "behind it"])
def test_an_angle_with_noise_turns_on(noise_before: bool, seed: int) -> None:
    """Known truth: noise of half a degree makes it pass the end of the range many times, or, where
    a converter adds it, its readings pass the ends. Now and then it rests at the end."""
    rng = np.random.default_rng(seed)
    noise = np.radians(rng.normal(0.0, 0.5, 500))
    truth = np.minimum(swing(0.02, 0.0), 0.0 if noise_before else 1.0)
    told = (truth + noise) % TURN_RAD if noise_before else truth % TURN_RAD + noise
    if not noise_before:
        assert np.ptp(told) > TURN_RAD
    found = turns_of(told)
    assert found.going_on is not None
    turned = np.round((found.going_on - truth - noise) / TURN_RAD)
    assert np.ptp(turned) == 0.0


def test_a_coarse_encoder_turns_on() -> None:
    """Of 200 steps a turn: it stands still between most samples, so the moves beside are zero."""
    step = TURN_RAD / 200.0
    truth = step * np.floor(np.linspace(150.0, 250.0, 1000))
    found = turns_of(truth % TURN_RAD)
    assert found.at.size == 1
    np.testing.assert_allclose(found.going_on, truth, atol=1e-9)


def test_an_angle_turns_on_where_samples_were_lost() -> None:
    """It moves ten times as far over a gap of ten samples, and passes the end there."""
    time_s = np.delete(0.01 * np.arange(300), np.arange(151, 160))
    truth = 0.04 * time_s / 0.01
    end = 0.5 * (truth[150] + truth[151])
    found = find_turns(time_s, (truth - end) % TURN_RAD)
    assert 151 in found.at
    np.testing.assert_allclose(np.diff(found.going_on), np.diff(truth), atol=1e-9)


def test_no_other_jump_is_a_turn() -> None:
    """Readings of zero while a marker was lost, a jump of 200°, drives of nearly a turn and beyond
    one, of a noisy sensor too, and readings of zero near the end of the range."""
    lost = swing(0.2) + 0.5
    lost[100:103] = 0.0
    jumped = np.where(np.arange(500) < 250, -1.7, 1.7) + 0.01 * swing(0.3)
    is_high = np.arange(500) % 100 >= 50
    squares = [np.where(is_high, share * TURN_RAD, 0.0) for share in (1.02, 0.95, 0.75, 1.0)]
    noise = np.radians(np.random.default_rng(3).normal(0.0, 0.5, 500))
    late = np.linspace(0.0, 0.97 * TURN_RAD, 500)
    late[480:482] = 0.0
    for told in (lost, jumped, *squares[:3], *(square + noise for square in squares[:3]), late):
        assert turns_of(told).at.size == 0


def test_a_fast_actuator_is_no_turn() -> None:
    """Steps of 340° in closed form, with a lag of two samples: none is made in one sample."""
    command = np.where(np.arange(500) % 100 < 50, 0.0, np.radians(340.0))
    angle = np.zeros(500)
    for k in range(1, 500):
        angle[k] = command[k] + (angle[k - 1] - command[k]) * np.exp(-0.5)
    assert turns_of(angle).at.size == 0


def test_an_angle_that_jumps_otherwise_too_stays() -> None:
    """It passes the end of a turn, and reads zero, half a turn away, while a marker was lost."""
    told = (swing(0.3) + 0.5 + np.pi) % TURN_RAD - np.pi
    assert turns_of(told).going_on is not None
    told[100:103] = 0.0
    found = turns_of(told)
    assert found.at.size > 5
    assert found.going_on is None
    assert found.largest_move > SMOOTH * TURN_RAD


def rows_of(angles: np.ndarray, header: str = "time_s;pressure_kpa;angle_deg") -> str:
    """The text of a log with a rising pressure."""
    return "\n".join((header, *(f"{0.02 * k:.2f};{k};{a:.1f}" for k, a in enumerate(angles))))


def test_the_angle_of_a_file_turns_on_and_says_so(write_log: WriteFile) -> None:
    """In the unit of the file; the row is that of the first sample behind the end."""
    truth = 150.0 + 3.0 * np.arange(20)
    log = load(write_log(rows_of((truth + 180.0) % 360.0 - 180.0)))
    np.testing.assert_allclose(np.degrees(log.channels["angle"].values), truth, atol=1e-9)
    (issue,) = [issue for issue in log.issues if issue.code == "wrapped-angle"]
    assert "angle_deg: the angle jumps by a turn, 360 deg, once in row 12" in issue.message
    assert "(from 177 to -180 deg); it is taken to go on" in issue.message
    assert "wrapped-angle" not in {issue.code for issue in misleading_channels(log)}
    assert [i for i in inspect(log).issues if i.code == "wrapped-angle"] == [issue]


def test_a_channel_of_ones_own_in_degrees_turns_on_as_an_output(write_log: WriteFile) -> None:
    """Its values stay in degrees, and so does the turn; as a channel beside it is left alone."""
    truth = 150.0 + 3.0 * np.arange(20)
    header = "time_s;pressure_kpa;wrist [deg]"
    path = write_log(rows_of((truth + 180.0) % 360.0 - 180.0, header))
    log = load(path, outputs=["wrist [deg]"])
    np.testing.assert_allclose(log.channels["wrist [deg]"].values, truth, atol=1e-9)


def test_an_angle_of_a_file_that_stays_is_told(write_log: WriteFile) -> None:
    """A lost reading half a turn away: what was recorded stays, with the row, and what to do."""
    told = (150.0 + 3.0 * np.arange(60) + 180.0) % 360.0 - 180.0
    recorded = told.copy()
    recorded[40:42] = 60.0
    log = load(write_log(rows_of(recorded)))
    np.testing.assert_allclose(np.degrees(log.channels["angle"].values), recorded, atol=1e-9)
    (issue,) = [issue for issue in log.issues if issue.code == "wrapped-angle"]
    assert issue.severity == "warning"
    assert "once in row 12 (from 177 to -180 deg), but stays as it is" in issue.message
    assert "numpy.unwrap(angle, period=360)" in (issue.remedy or "")


def test_a_length_is_no_angle(write_log: WriteFile) -> None:
    """In millimetres there are no turns, however far it jumps."""
    told = (150.0 + 3.0 * np.arange(20) + 180.0) % 360.0 - 180.0
    log = load(write_log(rows_of(told, "time_s;pressure_kpa;position_mm")))
    np.testing.assert_allclose(log.channels["position"].values, told, atol=1e-9)
    assert "wrapped-angle" not in {issue.code for issue in inspect(log).issues}
