"""Intervals of even times: the median one, unless samples come in bursts."""

from __future__ import annotations

import numpy as np
import pytest

from softid.even_times import MOST_PER_SAMPLE, even_interval_s

PAIRS_S = np.sort(np.concatenate([0.4 * np.arange(100), 0.4 * np.arange(100) + 1e-5]))


def test_the_usual_interval_is_the_median() -> None:
    """To the bit, with a pause in it or where the times of two logs are given."""
    time_s = np.concatenate((0.01 * np.arange(300), 3.7 + 0.01 * np.arange(200)))
    assert even_interval_s(time_s) == np.median(np.diff(time_s))
    longer = 0.02 * np.arange(900)
    assert even_interval_s(time_s, longer) == np.median(np.diff(longer))


def test_bursts_make_no_more_times_than_are_needed() -> None:
    """Pairs 10 µs apart every 0.4 s: four million median intervals, ten even times per sample."""
    assert np.median(np.diff(PAIRS_S)) == pytest.approx(1e-5)
    count = np.ptp(PAIRS_S) / even_interval_s(PAIRS_S)
    assert count == pytest.approx(MOST_PER_SAMPLE * (PAIRS_S.size - 1))


def test_one_sample_has_no_interval() -> None:
    assert even_interval_s(np.array([3.0])) == 0.0
