"""The interval of the gain by a block bootstrap."""

from __future__ import annotations

import numpy as np
import pytest

from softid.diagnosis.verdict.gain_interval import BOOTSTRAP_BLOCKS, gain_interval


def test_the_interval_covers_a_known_gain() -> None:
    """Closed form: noise of 1 under a misfit of 2 that is mended, 1 − 1/√5.

    Of 300 intervals 95 % cover it; the share itself is known to ±1.3 %, of which four are allowed.
    """
    true, hits, widths = 1.0 - 1.0 / np.sqrt(5.0), 0, []
    for seed in range(300):
        rng = np.random.default_rng(seed)
        noise, misfit = rng.standard_normal(480), 2.0 * rng.standard_normal(480)
        interval = gain_interval(noise + misfit, noise, rng)
        assert interval is not None
        hits += interval[0] <= true <= interval[1]
        widths.append(interval[1] - interval[0])
    assert 0.90 <= hits / 300 <= 1.0
    assert np.median(widths) < 0.1


def test_no_interval_of_few_samples() -> None:
    """Eight samples a block are the least, and both errors belong to the same samples."""
    rng = np.random.default_rng(0)
    values = rng.standard_normal(8 * BOOTSTRAP_BLOCKS)
    assert gain_interval(values, 0.5 * values, rng) == pytest.approx((0.5, 0.5))
    assert gain_interval(values[1:], 0.5 * values[1:], rng) is None
    assert gain_interval(values, values[1:], rng) is None
    assert gain_interval(np.empty(0), np.empty(0), rng) is None


def test_no_interval_of_a_response_that_ran_away() -> None:
    """Before or after: a model without an error has no gain either."""
    rng = np.random.default_rng(0)
    values = rng.standard_normal(480)
    lost = np.full(480, np.nan)
    assert gain_interval(values, lost, rng) is None
    assert gain_interval(lost, values, rng) is None


def test_no_gain_and_a_loss() -> None:
    """Closed form: the same error gains nothing, a doubled one loses its whole size."""
    rng = np.random.default_rng(0)
    values = rng.standard_normal(400)
    assert gain_interval(values, values, rng) == pytest.approx((0.0, 0.0))
    assert gain_interval(values, 2.0 * values, rng) == pytest.approx((-1.0, -1.0))
