"""Clock findings on times that were made to order."""

from __future__ import annotations

import numpy as np
import pytest

from softid.log import Log
from softid.quality import inspect
from softid.quality.sampling import describe_sampling


def log_at(time_s: np.ndarray) -> Log:
    pressure = 40.0 + 30.0 * np.sin(time_s)
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": 0.01 * pressure})


def test_a_regular_clock() -> None:
    """200 Hz without jitter, gaps or stalls."""
    found = describe_sampling(log_at(np.arange(1000) / 200.0))
    assert (found.n, found.segments, found.gaps, found.stalls) == (1000, 1, (), ())
    assert found.rate_hz == pytest.approx(200.0)
    assert found.mean_rate_hz == pytest.approx(200.0)
    assert found.duration_s == pytest.approx(999 / 200.0)
    assert found.jitter == pytest.approx(0.0, abs=1e-9)


def test_jitter_is_a_robust_standard_deviation() -> None:
    """Gaussian intervals of 10 ± 1 ms: 0.1, although three intervals are stalls.

    The median absolute deviation of 4000 samples scatters by 1.8 %.
    """
    rng = np.random.default_rng(0)
    intervals = 0.010 + 0.001 * rng.standard_normal(4000)
    intervals[[500, 1500, 3000]] = 1.1
    found = describe_sampling(log_at(np.cumsum(intervals)))
    assert found.jitter == pytest.approx(0.1, rel=0.06)
    assert len(found.stalls) == 3
    assert found.segments == 4
    assert found.stalls[0].length_s == pytest.approx(1.1)
    assert found.stalls[0].index == 499


def test_gaps_are_shorter_than_stalls() -> None:
    """At 100 Hz a gap of 0.2 s is below the limit of 0.5 s, one of 0.6 s above."""
    intervals = np.full(600, 0.01)
    intervals[100], intervals[400] = 0.2, 0.6
    found = describe_sampling(log_at(np.cumsum(intervals)))
    assert [round(g.length_s, 6) for g in found.gaps] == [0.2]
    assert [round(g.length_s, 6) for g in found.stalls] == [0.6]
    codes = {i.code for i in inspect(log_at(np.cumsum(intervals))).issues}
    assert {"gaps", "stalls"} <= codes


def test_a_coarse_clock() -> None:
    """Milliseconds in the file, intervals of 16 or 17 of them."""
    time_s = np.round(np.arange(800) / 60.0, 3)
    assert describe_sampling(log_at(time_s)).clock_step_s == pytest.approx(0.001, rel=1e-6)


def test_close_samples() -> None:
    """Every tenth sample is followed by another within 1 ms."""
    time_s = np.sort(np.concatenate([np.arange(900) * 0.02, np.arange(0, 900, 10) * 0.02 + 0.001]))
    found = describe_sampling(log_at(time_s))
    assert found.close_share == pytest.approx(90 / 989, rel=0.02)


def test_a_regular_clock_far_from_zero() -> None:
    """Seconds since 1970 resolve 0.24 µs, so the median interval is off by a little; the sampling
    stays regular and is no coarse clock."""
    time_s = 1.7e9 + np.arange(2700) * 0.01
    channels = {"pressure": np.sin(0.01 * np.arange(2700)), "angle": np.arange(2700.0)}
    found = describe_sampling(Log.from_arrays(time_s, channels))
    assert found.clock_step_s is None


def test_the_limit_of_a_gap_is_told() -> None:
    """With a jitter of 50 % a gap is an interval far above three periods; the sentence says how
    long, and two single samples between stalls are told apart from segments."""
    rng = np.random.default_rng(0)
    intervals = 0.01 * rng.choice([0.5, 1.0, 1.5], 2000)
    intervals[700] = 0.3
    intervals[[1000, 1001]] = 3.0
    time_s = np.concatenate([[0.0], np.cumsum(intervals)])
    channels = {"pressure": np.sin(time_s), "angle": np.sin(time_s)}
    found = inspect(Log.from_arrays(time_s, channels))
    messages = {i.code: i.message for i in found.issues}
    assert found.sampling.gap_limit_s > 0.03
    assert f"1 gap longer than {1e3 * found.sampling.gap_limit_s:.3g} ms" in messages["gaps"]
    assert (len(found.sampling.stalls), found.sampling.segments) == (2, 2)
    assert "(1 single sample between stalls left out)" in messages["stalls"]
