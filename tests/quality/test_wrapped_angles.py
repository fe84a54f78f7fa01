"""Angles of arrays that begin again at the end of a turn are told, and stay as they are."""

from __future__ import annotations

import numpy as np

from softid.log import Log
from softid.quality import inspect, misleading_channels
from softid.readers.turns import TURN_RAD


def test_an_array_that_wraps_is_told() -> None:
    """It is taken as it is: the same warning from an inspection and before a fit."""
    truth = np.radians(150.0 + 3.0 * np.arange(20))
    channels = {"pressure": np.arange(20.0), "angle": (truth + np.pi) % TURN_RAD - np.pi}
    log = Log.from_arrays(0.02 * np.arange(20), channels)
    for issues in (misleading_channels(log), inspect(log).issues):
        (issue,) = [issue for issue in issues if issue.code == "wrapped-angle"]
        assert "angle jumps by a turn, 6.283 rad, once at 0.20 s" in issue.message
        assert "numpy.unwrap(angle, period=6.283)" in (issue.remedy or "")
