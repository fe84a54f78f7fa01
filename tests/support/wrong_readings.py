"""Logs with a channel that was read with an error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.log import Log


def read_with(log: Log, name: str, error: npt.NDArray[np.float64]) -> Log:
    """The log with an error in what a channel reads, in its unit."""
    channel = log.channels[name]
    wrong = replace(channel, values=channel.values + error)
    return replace(log, channels={**log.channels, name: wrong})
