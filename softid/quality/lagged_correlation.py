"""How alike two channels are when one is read later than the other."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.log import Log

Array = npt.NDArray[np.float64]

MOST_POINTS = 2000
"""Points to which a log is interpolated for correlations at most: a lag is then known to 1/2000 of
the log."""

LONGEST_LAG_S = 10.0
"""Longest lag that is tried, in s; a judgement."""

LONGEST_LAG_OF_LOG = 0.1
"""Longest lag that is tried, as a share of the log, nine tenths of which then still overlap."""


def common_grid(log: Log, first: str, second: str) -> tuple[float, Array, Array] | None:
    """Two channels on a regular grid, good enough for correlations, or None when one is still.

    Parameters
    ----------
    log
        The recording.
    first, second
        Names of the channels.

    Returns
    -------
    float, arrays of shape (m,)
        Interval of the grid in s, and the values of both there.
    """
    finite = np.isfinite(log.channels[first].values) & np.isfinite(log.channels[second].values)
    if finite.sum() < 8:
        return None
    times = log.time_s[finite]
    span_s = float(times[-1] - times[0])
    count = int(min(MOST_POINTS, max(span_s / log.period_s, 8.0)))
    regular = np.linspace(times[0], times[-1], count)
    one = np.interp(regular, times, log.channels[first].values[finite])
    two = np.interp(regular, times, log.channels[second].values[finite])
    if np.ptp(one) == 0.0 or np.ptp(two) == 0.0:
        return None
    return span_s / (count - 1), one, two


def longest_lag_s(step_s: float, given: Array) -> float:
    """A quarter of the main period, within a tenth of the log and 10 s.

    Parameters
    ----------
    step_s
        Interval of the samples.
    given
        A channel, shape (m,).
    """
    spectrum = np.abs(np.fft.rfft(given - given.mean()))
    main = max(int(spectrum[1:].argmax()) + 1, 1)
    span_s = step_s * given.size
    return min(0.25 * span_s / main, LONGEST_LAG_OF_LOG * span_s, LONGEST_LAG_S)


def lagged_correlations(given: Array, answered: Array, lags: int) -> Array:
    """Correlations of a channel with another one read up to so many samples later, (lags + 1,).

    Each is that of the samples that overlap; 0 where fewer than five do, or one is still.

    Parameters
    ----------
    given, answered
        The channels, shape (m,) each.
    lags
        Largest lag.
    """
    n = given.size
    lag = np.arange(min(lags + 1, n - 4))
    x, y = given - given.mean(), answered - answered.mean()
    length = 1 << (2 * n - 1).bit_length()
    spectra = np.conj(np.fft.rfft(x, length)) * np.fft.rfft(y, length)
    products = np.fft.irfft(spectra, length)[lag]

    def sums(values: Array) -> Array:
        return np.concatenate(([0.0], np.cumsum(values)))

    first, first_squares = (sums(v)[n - lag] for v in (x, x**2))
    second, second_squares = (sums(v)[n] - sums(v)[lag] for v in (y, y**2))
    overlap = n - lag
    covariance = products - first * second / overlap
    scale = (first_squares - first**2 / overlap) * (second_squares - second**2 / overlap)
    least = np.finfo(float).eps * float(x @ x) * float(y @ y)
    correlations = np.zeros(lags + 1)
    known = scale > least
    correlations[lag[known]] = covariance[known] / np.sqrt(scale[known])
    return correlations
