"""Smoothing of a record afterwards."""

from __future__ import annotations

import numpy as np
import pytest
from muscle_rig import SCALE, times
from scipy.signal import butter, filtfilt

from softid.effects import OutputEffect
from softid.effects.smoothing import MeanSmoothing, PastSmoothing, Smoothing


@pytest.mark.parametrize("order", [1, 2, 4])
def test_it_is_a_filter_that_runs_there_and_back(order: int) -> None:
    """scipy's digital Butterworth filter of a smooth motion, to 2e-3 away from the ends: a digital
    one has its own cut-off, (πh/T)²/3 = 0.5 % off."""
    time_s = times("100 Hz")
    motion = np.sin(2.0 * np.pi * 1.3 * time_s) + np.tanh(8.0 * (time_s - time_s.mean()))
    found = Smoothing().apply(np.array([0.25, order]), time_s, motion, SCALE)
    expected = filtfilt(*butter(order, 2.0 * 0.01 / 0.25), motion)
    inner = slice(50, -50)
    np.testing.assert_allclose(found[inner], expected[inner], rtol=0.0, atol=2e-3)


@pytest.mark.parametrize("sampling", ["100 Hz", "irregular"])
def test_a_swing_keeps_its_phase(sampling: str) -> None:
    """Of cos ωt a share 1/(1 + (fT)⁴) is left, at the cut-off a half, and nothing is late; lines
    between uneven samples miss (ωh)²/8 of it, 5e-3."""
    time_s, period = times(sampling), 0.5
    for frequency in (1.0 / period, 0.5 / period):
        swing = np.cos(2.0 * np.pi * frequency * (time_s - time_s[0]))
        found = Smoothing().apply(np.array([period, 2.0]), time_s, swing, SCALE)
        left = 1.0 / (1.0 + (frequency * period) ** 4)
        inner = (time_s > time_s[0] + 1.0) & (time_s < time_s[-1] - 1.0)
        np.testing.assert_allclose(found[inner], left * swing[inner], rtol=0.0, atol=6e-3)


@pytest.mark.parametrize("order", [1.0, 2.0, 4.0, 8.0])
def test_a_line_stays_to_its_ends(order: float) -> None:
    """A record is turned about its ends, so that what goes on straight is not bent there."""
    time_s = times("100 Hz")
    found = Smoothing().apply(np.array([0.3, order]), time_s, 2.0 * time_s, SCALE)
    np.testing.assert_allclose(found, 2.0 * time_s, rtol=0.0, atol=1e-11 * np.ptp(time_s))
    two = Smoothing().apply(np.array([0.3, order]), time_s[:2], time_s[:2], SCALE)
    np.testing.assert_array_equal(two, time_s[:2])


@pytest.mark.parametrize("order", [2.0, 8.0])
def test_a_step_is_not_heard_at_the_other_end(order: float) -> None:
    """Ten periods after it a filter of any order leaves a thousandth of a step: what the first
    sample is off would be a jump from the last one to it."""
    time_s = 0.01 * np.arange(2001)
    step = np.where(time_s > 10.0, 100.0, 0.0)
    found = Smoothing().apply(np.array([0.5, order]), time_s, step, SCALE)
    assert found[[0, -1]] == pytest.approx([0.0, 100.0], abs=1e-11)
    far = np.abs(time_s - 10.0) > 5.0
    np.testing.assert_allclose(found[far], step[far], rtol=0.0, atol=0.1)


def test_a_mean_is_of_what_comes_before_and_after() -> None:
    """Closed form: a line stays, t² gains w²/12, and a window that is cut off at the begin is
    centred elsewhere; the integral is that of straight lines, which adds h²/6 to t²."""
    h, w = 0.01, 0.3
    time_s = h * np.arange(301)
    law, inner = MeanSmoothing(), slice(20, -20)
    found = law.apply(np.array([w]), time_s, 2.0 * time_s, SCALE)
    np.testing.assert_allclose(found[inner], 2.0 * time_s[inner], atol=1e-12)
    assert found[0] == pytest.approx(2.0 * w / 4.0)
    bent = law.apply(np.array([w]), time_s, time_s**2, SCALE) - time_s**2
    np.testing.assert_allclose(bent[inner], w**2 / 12.0 + h**2 / 6.0, rtol=1e-6)
    np.testing.assert_array_equal(law.apply(np.array([0.0]), time_s, time_s**2, SCALE), time_s**2)


@pytest.mark.parametrize(("order", "off"), [(1.0, 0.16), (1.5, 0.1), (2.0, 0.06), (3.0, 0.16)])
def test_noise_is_another_one_beyond_the_time_that_is_told(order: float, off: float) -> None:
    """Second differences of smoothed white noise over that time are those of white noise of the
    same power, 6 σ², but for what the order makes of it."""
    time_s = 0.001 * np.arange(400_000)
    noise = np.random.default_rng(5).normal(size=time_s.size)
    values = {"period": 0.2, "order": order}
    smooth = Smoothing().apply(np.array([*values.values()]), time_s, noise, SCALE)
    apart = round(Smoothing().alike_within(values) / 0.001)
    second = smooth[2 * apart :] - 2.0 * smooth[apart:-apart] + smooth[: -2 * apart]
    assert np.mean(second**2) / (6.0 * np.var(smooth)) == pytest.approx(1.0, abs=off)


def test_a_moving_average_is_a_late_centred_mean() -> None:
    """Half a window earlier, to rounding where the window is within the record; a step has arrived
    when the window has passed, in a straight line."""
    time_s = 0.01 * np.arange(600)
    motion = np.sin(2.0 * np.pi * 0.7 * time_s)
    past = PastSmoothing().apply(np.array([0.4]), time_s, motion, SCALE)
    centred = MeanSmoothing().apply(np.array([0.4]), time_s, motion, SCALE)
    np.testing.assert_allclose(past[40:], centred[20:-20], atol=1e-12)
    step = np.where(time_s > 2.0, 1.0, 0.0)
    arrived = PastSmoothing().apply(np.array([0.4]), time_s, step, SCALE)
    since_s = time_s - 2.005  # between two samples the step counts as straight
    np.testing.assert_allclose(arrived, np.clip(since_s / 0.4, 0.0, 1.0), atol=0.01)


def test_the_cut_off_is_told() -> None:
    told = Smoothing().wording({"period": 0.2, "order": 2.0})
    assert "cut-off is 5 Hz" in told.meaning


def test_pairs_of_samples_are_smoothed_as_others_are() -> None:
    """Pairs 10 µs apart every 50 ms: the share 1/(1 + (fT)⁴) of a swing, as lines between the pairs
    leave it, 5e-3; over a grid of median intervals it would take 3,000,000 values."""
    first_s, period = 0.05 * np.arange(600), 2.0
    time_s = np.sort(np.concatenate((first_s, first_s + 1e-5)))
    swing = np.cos(2.0 * np.pi * 0.4 * time_s)
    found = Smoothing().apply(np.array([period, 2.0]), time_s, swing, SCALE)
    inner = (time_s > 4.0) & (time_s < time_s[-1] - 4.0)
    left = 1.0 / (1.0 + (0.4 * period) ** 4)
    np.testing.assert_allclose(found[inner], left * swing[inner], rtol=0.0, atol=5e-3)


@pytest.mark.parametrize("seconds_apart", [1e-5, 1.0])
def test_the_grid_of_the_filter_is_bounded(
    seconds_apart: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ten values per sample and two periods beyond either end, as many again at most."""
    sizes: list[int] = []
    transform = np.fft.rfft
    monkeypatch.setattr(np.fft, "rfft", lambda y: sizes.append(y.size) or transform(y))
    time_s = np.sort(np.concatenate([4.0 * np.arange(50), 4.0 * np.arange(50) + seconds_apart]))
    Smoothing().apply(np.array([500.0, 2.0]), time_s, np.sin(time_s), SCALE)
    assert max(sizes) <= 3 * (10 * time_s.size + 1)


@pytest.mark.parametrize("law", [Smoothing(), MeanSmoothing(), PastSmoothing()])
@pytest.mark.parametrize("count", [1, 2])
def test_one_sample_stays_as_it_is(law: OutputEffect, count: int) -> None:
    """What rests before and after is its own mean, at the first sample of two as well."""
    eta = np.array([0.3, 2.0][: len(law.parameters(SCALE))])
    found = law.apply(eta, np.array([1.0, 9.0])[:count], np.array([0.7, 0.7])[:count], SCALE)
    np.testing.assert_allclose(found, np.full(count, 0.7))
