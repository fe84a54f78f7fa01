"""Logs of the linear actuator whose angle is read by a camera that is slower than the rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from linear_motion import RATE_HZ, linear_angle, pressure_course

from softid.log import Log

EVERY = 3

FINE = 40
"""Times per row at which a camera with a clock of its own may take a frame."""


def slow(log: Log) -> Log:
    """The log with an angle at every third row only."""
    angle = log.channels["angle"]
    values = np.where(np.arange(len(log)) % EVERY == 0, angle.values, np.nan)
    return replace(log, channels={**log.channels, "angle": replace(angle, values=values)})


def free_camera(frames_hz: float, *, repeated: bool, noise: float = 0.002) -> Log:
    """A log of 40 s with a camera that is not led by it; rows without a new frame repeat, or lack.

    A row shows the last frame that was taken before it.
    """
    fine_s = np.arange(40 * RATE_HZ * FINE) / (RATE_HZ * FINE)
    time_s = fine_s[::FINE]
    pressure = pressure_course(time_s)
    angle = linear_angle(fine_s, np.interp(fine_s, time_s, pressure))
    frames = np.arange(7, fine_s.size, RATE_HZ * FINE / frames_hz).astype(int)
    seen = angle[frames] + noise * np.random.default_rng(0).standard_normal(frames.size)
    last = np.searchsorted(fine_s[frames], time_s, side="right") - 1
    values = np.where(last >= 0, seen[np.maximum(last, 0)], np.nan)
    if not repeated:
        values[1:][last[1:] == last[:-1]] = np.nan
    channels = {"pressure": pressure, "angle": values}
    return Log.from_arrays(time_s, channels, outputs=("angle",), name="free-camera")
