"""Bounds and plausible values of the time constants of lags."""

from __future__ import annotations

import numpy as np

from softid.effects.base import Scale

SHORTEST_PERIODS = 1e-3
LONGEST_SHARE = 0.25
"""Bounds of the time constant, in sampling intervals and as a share of the log."""


def lag_bounds(scale: Scale) -> tuple[float, float]:
    """Shortest and longest time constant of a lag that a log could show.

    Parameters
    ----------
    scale
        Sizes of the logs.
    """
    shortest = SHORTEST_PERIODS * scale.period_s
    return shortest, max(LONGEST_SHARE * scale.duration_s, 10.0 * shortest)


def lag_times(scale: Scale) -> tuple[float, ...]:
    """Three plausible time constants, from two samples to the motion's own.

    Parameters
    ----------
    scale
        Sizes of the logs.
    """
    _, longest = lag_bounds(scale)
    shortest = min(2.0 * scale.period_s, 0.1 * longest)
    slowest = min(max(scale.motion_s, 8.0 * shortest), longest)
    return tuple(np.geomspace(shortest, slowest, 3).tolist())
