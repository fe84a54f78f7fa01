"""Whether logs hold a sine of one frequency alone, and how far an output lags behind it there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from softid.excitation import Stretch, segment_excitation
from softid.log import Log

SAME_FREQUENCY = 1.05
"""Largest ratio of frequencies that count as one."""


def sine_lag(
    logs: Sequence[Log], output: str, *, falls: bool = False
) -> tuple[float, float] | None:
    """Frequency of the only sine that the inputs hold, and the time by which an output lags behind.

    The lag is that of the ratio of the two sines fitted to output and input, and negative where the
    output leads by less than half a turn.

    Parameters
    ----------
    logs
        The logs.
    output
        Channel that lags.
    falls
        Whether the output falls as the input rises slowly.

    Returns
    -------
    tuple of float, or None
        Hz and s; None where an input is anything but rests and sines of one frequency.

    Examples
    --------
    >>> t = np.arange(0.0, 20.0, 0.02)
    >>> u, y = (np.sin(np.pi * (t - lag)) for lag in (0.0, 0.1))
    >>> log = Log.from_arrays(t, {"pressure": 50.0 + 40.0 * u, "angle": 0.5 * y})
    >>> [round(value, 3) for value in sine_lag([log], "angle")]
    [0.5, 0.1]
    """
    stretches = [(log, stretch) for log in logs for stretch in _moving(log)]
    frequencies = [s.frequency_hz for _, s in stretches if s.kind == "sine" and s.frequency_hz]
    if not frequencies or len(frequencies) < len(stretches):
        return None
    if max(frequencies) > SAME_FREQUENCY * min(frequencies):
        return None
    hz = float(np.median(frequencies))
    cross = sum(_cross(log, stretch, output, hz) for log, stretch in stretches)
    return hz, -float(np.angle(-cross if falls else cross)) / (2.0 * np.pi * hz)


def _moving(log: Log) -> list[Stretch]:
    u = log.channels[log.input].values
    if not np.isfinite(u).all():
        return []
    return [stretch for stretch in segment_excitation(log.time_s, u) if stretch.kind != "rest"]


def _cross(log: Log, stretch: Stretch, output: str, hz: float) -> complex:
    """Amplitude of the output's sine times the conjugate of that of the input's."""
    span = slice(stretch.start, stretch.stop)
    u, y = log.channels[log.input].values[span], log.channels[output].values[span]
    used = np.isfinite(y) & ~log.masked[span]
    angle = 2.0 * np.pi * hz * log.time_s[span][used]
    columns = np.column_stack((np.cos(angle), np.sin(angle), np.ones(angle.size)))
    fitted = np.linalg.lstsq(columns, np.column_stack((u[used], y[used])))[0]
    (u_amplitude, y_amplitude) = fitted[0] - 1j * fitted[1]
    return complex(y_amplitude * np.conj(u_amplitude))
