"""Logs of the linear actuator whose input jumps while samples are lost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from linear_motion import Array, linear_angle

from softid.log import Log

NOISE = 0.01
LEVEL_KPA = 60.0
JUMP_S = 5.03
LOST = (250, 251, 252)
"""Samples about the jump; those at 4.98 s and 5.06 s on either side of the gap stay."""


def recorded(pressure: Array, *, lost: tuple[int, ...] = LOST, seed: int = 0) -> Log:
    """A log of the linear actuator at rates of 1 kHz, of which every 20th sample was kept."""
    fine_s = np.arange(pressure.size) / 1000.0
    angle = linear_angle(fine_s, pressure)[::20]
    angle = angle + NOISE * np.random.default_rng(seed).standard_normal(angle.size)
    log = Log.from_arrays(
        fine_s[::20], {"pressure": pressure[::20], "angle": angle}, name=f"lost-{seed}"
    )
    kept = np.ones(len(log), bool)
    kept[list(lost)] = False
    channels = {k: replace(c, values=c.values[kept]) for k, c in log.channels.items()}
    return replace(log, time_s=log.time_s[kept], channels=channels, masked=None)


def fine(duration_s: float = 20.0) -> Array:
    return np.arange(round(1000 * duration_s)) / 1000.0


def jump(duration_s: float = 20.0) -> Array:
    return np.where(fine(duration_s) >= JUMP_S, LEVEL_KPA, 0.0)
