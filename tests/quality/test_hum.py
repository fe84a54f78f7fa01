"""A line in the noise is found with its frequency, also when the sampling folds it down."""

from __future__ import annotations

import numpy as np
import pytest

from softid.excitation import SettledWindow
from softid.quality.hum import find_hum


def noisy_line(rate_hz: float, line_hz: float, *, amplitude: float, seed: int = 0):
    time_s = np.arange(int(20 * rate_hz)) / rate_hz
    noise = np.random.default_rng(seed).standard_normal(time_s.size)
    values = amplitude * np.sin(2 * np.pi * line_hz * time_s + 0.7) + noise
    return time_s, values, (SettledWindow(0, time_s.size, 0.0),)


@pytest.mark.parametrize(
    ("rate_hz", "line_hz", "seen_hz", "mains_hz"),
    [
        (500.0, 50.0, 50.0, 50.0),
        (60.0, 50.0, 10.0, 50.0),
        (90.0, 60.0, 30.0, 60.0),
        (100.0, 13.7, 13.7, None),
    ],
)
def test_a_line(rate_hz: float, line_hz: float, seen_hz: float, mains_hz: float | None) -> None:
    """Frequency |f − k·fs| to the resolution of the rest, amplitude to 20 % at σ = 1."""
    time_s, values, rests = noisy_line(rate_hz, line_hz, amplitude=1.0)
    found = find_hum(time_s, values, rests, 1.0)
    assert found is not None
    assert found.frequency_hz == pytest.approx(seen_hz, abs=0.1)
    assert found.amplitude == pytest.approx(1.0, rel=0.2)
    assert found.mains_hz == mains_hz


def test_a_line_between_two_bins() -> None:
    """Half a bin off, the top of a Hann window is 15 % low; corrected for it, the amplitude is
    good to 3 % and the frequency to a tenth of a bin. Two thirds of 40 s at 333 Hz are searched,
    8880 samples, so bins are 0.0375 Hz apart and the line lies at bin 1333.5."""
    rate_hz, line_hz = 333.0, 1333.5 * 0.0375
    time_s = np.arange(int(40 * rate_hz)) / rate_hz
    noise = 0.2 * np.random.default_rng(1).standard_normal(time_s.size)
    values = np.sin(2 * np.pi * line_hz * time_s) + noise
    found = find_hum(time_s, values, (SettledWindow(0, time_s.size, 0.0),), 0.2)
    assert found is not None
    assert found.amplitude == pytest.approx(1.0, rel=0.03)
    assert found.frequency_hz == pytest.approx(line_hz, abs=0.1 * 0.0375)


@pytest.mark.parametrize("seed", range(50))
def test_no_line_in_white_noise(seed: int) -> None:
    """The threshold is crossed by chance once in 100,000 logs."""
    time_s, values, rests = noisy_line(100.0, 0.0, amplitude=0.0, seed=seed)
    assert find_hum(time_s, values, rests, 1.0) is None


def test_where_no_line_can_be_seen() -> None:
    """Irregular samples smear it; without rest or noise there is nothing to look at."""
    time_s, values, rests = noisy_line(100.0, 13.7, amplitude=1.0)
    jittered = time_s + 0.004 * np.random.default_rng(1).random(time_s.size)
    assert find_hum(jittered, values, rests, 1.0) is None
    assert find_hum(time_s, values, (), 1.0) is None
    assert find_hum(time_s, values, rests, None) is None
