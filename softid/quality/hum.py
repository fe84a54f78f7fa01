"""Lines in the noise: mains hum, also when it is folded down by the sampling."""

from __future__ import annotations

from math import log

import numpy as np
import numpy.typing as npt

from softid.excitation import SettledWindow
from softid.quality.findings import Hum

Array = npt.NDArray[np.float64]

MAINS_HZ = (50.0, 60.0, 100.0, 120.0)
"""Mains frequencies and their second harmonics, which rectified supplies leave behind."""

MIN_SAMPLES = 128
"""Samples of the rest at least: half as many lines, of which 50 are wanted beside the largest."""

MOST_JITTER = 0.1
"""Standard deviation of the intervals over their mean, beyond which samples are too irregular for
the periodogram, which takes them as regular; a judgement."""

LINE_CHANCE = 1e-5
"""Chance that white noise gives such a line anywhere in the spectrum. A judgement on the strict
side: what is left of a motion is not white."""

NEIGHBOURING_LINES = 25
"""Lines on either side whose median is the floor: it is known to 20 %, and noise that is not white
is nearly as strong there."""

LOWEST_HZ = 2.0
"""Lowest frequency of a hum: slower lines are what a motion leaves after the cubic is taken away,
or drift."""

LEAST_CYCLES = 8.0
"""Fewest cycles of a hum in a rest of less than 4 s; a judgement."""

LINE_WIDTH = 4
"""Lines from the top one at which the skirts are looked at: there a pure line under a window of
Hann has fallen to 1e-4 of its power."""

MOST_SKIRT = 0.1
"""Share of its power that a line's skirts may hold, `LINE_WIDTH` lines from the top one; what is
broader is no hum."""

LEAST_AMPLITUDE = 0.2
"""Amplitude of a line at least, in units of the noise: a fifth is 2 % of the noise's power."""


def find_hum(
    time_s: Array, values: Array, rests: tuple[SettledWindow, ...], noise_std: float | None
) -> Hum | None:
    """Find a narrow line in the noise of the longest rest.

    A line of the periodogram counts when white noise with the power of its 50 neighbours would
    give it once in 100,000 logs, when it falls off at once on both sides, and when its amplitude
    is at least a fifth of the noise. Irregular or repeated samples smear every line, so they are
    not searched.

    Parameters
    ----------
    time_s, values
        Samples, shape (n,), without NaN.
    rests
        Windows of the input at rest; the longest is used, without its first third.
    noise_std
        Noise of the channel.
    """
    if not rests or not noise_std:
        return None
    longest = max(rests, key=lambda w: w.stop - w.start)
    span = slice(longest.start + (longest.stop - longest.start) // 3, longest.stop)
    times, noise = time_s[span], values[span]
    n = times.size
    if n < MIN_SAMPLES:
        return None
    intervals = np.diff(times)
    period_s = float(times[-1] - times[0]) / (n - 1)
    if float(np.sqrt(np.mean((intervals / period_s - 1.0) ** 2))) > MOST_JITTER:
        return None
    place = np.linspace(-1.0, 1.0, n)
    noise = noise - np.polyval(np.polyfit(place, noise, 3), place)
    window = np.hanning(n)
    power = np.abs(np.fft.rfft(noise * window)) ** 2
    frequency = np.fft.rfftfreq(n, period_s)
    lowest = max(LOWEST_HZ, LEAST_CYCLES / (n * period_s))
    usable = np.flatnonzero((frequency > lowest) & (frequency < frequency[-1]))
    if usable.size < 2 * NEIGHBOURING_LINES or not power[usable].max() > 0.0:
        return None
    k = int(usable[power[usable].argmax()])
    beside = power[max(k - NEIGHBOURING_LINES, 1) : k + NEIGHBOURING_LINES + 1]
    floor = float(np.median(beside)) / log(2.0)
    if power[k] <= floor * (log(usable.size) - log(LINE_CHANCE)):
        return None
    skirts = power[[max(k - LINE_WIDTH, 0), min(k + LINE_WIDTH, power.size - 1)]]
    shift, gain = _between_bins(power, k)
    amplitude = 2.0 * gain * float(np.sqrt(power[k])) / float(window.sum())
    line_hz = float(frequency[k]) + shift * float(frequency[1])
    if float(skirts.max()) > MOST_SKIRT * power[k] or amplitude < LEAST_AMPLITUDE * noise_std:
        return None
    return Hum(line_hz, amplitude, _mains(line_hz, period_s, n))


def _between_bins(power: Array, k: int) -> tuple[float, float]:
    """Place of a line between the bins of a Hann window, in bins, and what the top bin lacks.

    The bin beside the top one has the share r = (1 + d)/(2 − d) of its height at a shift d, so
    d = (2r − 1)/(r + 1); the height falls as sinc(d)/(1 − d²).
    """
    if not 0 < k < power.size - 1:
        return 0.0, 1.0
    left, right = float(power[k - 1]), float(power[k + 1])
    ratio = float(np.sqrt(max(left, right) / power[k]))
    d = min(max((2.0 * ratio - 1.0) / (ratio + 1.0), 0.0), 0.5)
    gain = (1.0 - d * d) / float(np.sinc(d))
    return (d if right >= left else -d), gain


def _mains(frequency_hz: float, period_s: float, n: int) -> float | None:
    """The mains line that is sampled as this frequency, None when it is none."""
    rate_hz, resolution_hz = 1.0 / period_s, 1.5 / (n * period_s)
    for mains_hz in MAINS_HZ:
        folded_hz = abs(mains_hz - round(mains_hz * period_s) * rate_hz)
        if abs(folded_hz - frequency_hz) <= resolution_hz:
            return mains_hz
    return None
