"""Absolute pressures and vacuums are pointed out, gauge pressures are not."""

from __future__ import annotations

import numpy as np
import pytest

from softid.log import Log
from softid.quality import inspect, misleading_channels

CODE = "absolute-pressure"
TIME_S = np.arange(600) * 0.02
SWING = 30.0 * (1.0 - np.cos(2.0 * np.pi * TIME_S / 4.0))


def log_at(pressure_kpa: np.ndarray) -> Log:
    """A log whose angle follows a pressure in kPa."""
    noise = np.random.default_rng(5).normal(0.0, 0.2, (2, TIME_S.size))
    channels = {"pressure": pressure_kpa + noise[0], "angle": 0.01 * SWING + 1e-3 * noise[1]}
    return Log.from_arrays(TIME_S, channels, input="pressure", outputs=("angle",))


@pytest.mark.parametrize(
    ("pressure_kpa", "is_told"),
    [
        (101.3 + SWING, True),
        (93.0 + SWING, True),  # in a town at 700 m
        (SWING, False),
        (160.0 + SWING, False),
        (100.0 + 0.1 * SWING, False),  # held at a bar
        (101.3 + np.roll(SWING, 100), False),  # begins and ends high
    ],
)
def test_an_absolute_pressure_is_told(pressure_kpa: np.ndarray, is_told: bool) -> None:
    """It rests at an atmosphere and never goes below."""
    log = log_at(pressure_kpa)
    assert (CODE in {issue.code for issue in misleading_channels(log)}) == is_told
    told = [issue for issue in inspect(log).issues if issue.code == CODE]
    assert len(told) == is_told
    low = log.channels["pressure"].values.min()
    assert all(f"rests at {low:.4g} kPa" in issue.message for issue in told)


@pytest.mark.parametrize(
    ("pressure_kpa", "is_told"),
    [
        (-SWING, True),
        (-SWING - 20.0, True),
        (np.where(TIME_S < 0.1, 20.0, -SWING), True),  # vented with a puff
        (SWING, False),
        (SWING - 30.0, False),  # both ways
        (-0.1 * SWING, False),  # hardly any
    ],
)
def test_a_vacuum_is_told(pressure_kpa: np.ndarray, is_told: bool) -> None:
    """Its own sign is the one to turn, and not that of an output which goes against it."""
    log = log_at(pressure_kpa)
    assert ("vacuum" in {issue.code for issue in misleading_channels(log)}) == is_told
    found = {issue.code: issue for issue in inspect(log).issues}
    assert ("vacuum" in found) == is_told
    assert not ("vacuum" in found and "inverted-sign" in found)
    if is_told:
        assert "--channel pressure=pressure:-kPa" in (found["vacuum"].remedy or "")
