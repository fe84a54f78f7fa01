"""Logs whose pressure gauge lags behind."""

from __future__ import annotations

import numpy as np

from softid.kernels.filters import lag
from softid.log import Log


def with_a_late_gauge(log: Log, tau_s: float) -> Log:
    """The log with a pressure that follows what it was by a lag."""
    late = log.pressure_kpa.copy()
    lag(np.diff(log.time_s), late, tau_s, tau_s)
    channels = {name: channel.values for name, channel in log.channels.items()}
    return Log.from_arrays(log.time_s, {**channels, "pressure": late}, name=log.name)
