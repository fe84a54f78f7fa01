"""Absolute pressures are pointed out, gauge pressures are not."""

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
