"""The white part of a signal's noise."""

from __future__ import annotations

import numpy as np
import pytest

from softid.excitation.noise import noise_std, second_difference_noise

TIME_S = 0.005 * np.arange(4000)
NOISE = np.random.default_rng(0).normal(0.0, 0.2, TIME_S.size)
SIGNAL = 3.0 * np.sin(2.0 * TIME_S) + NOISE


def test_even_and_uneven_sampling_agree() -> None:
    """Intervals that differ by 1e-5 take the general weights: the same to some 1e-5."""
    uneven = TIME_S + 1e-5 * 0.005 * np.random.default_rng(1).uniform(size=TIME_S.size)
    even, general = noise_std(TIME_S, SIGNAL), noise_std(uneven, SIGNAL)
    assert even == pytest.approx(general, rel=1e-4)
    assert even == pytest.approx(0.2, rel=0.03)  # a quantile of 4000 samples is known to 2 %


def test_samples_that_do_not_count_are_left_out() -> None:
    """Ten times the noise in the second half is not seen when only the first counts."""
    louder = SIGNAL + np.where(TIME_S > 10.0, 10.0, 0.0) * NOISE
    first = noise_std(TIME_S, louder, where=TIME_S < 10.0)
    assert first == pytest.approx(0.2, rel=0.03)


def test_second_differences_show_the_noise_below_a_slow_motion_and_a_jump() -> None:
    """A median of 4000 dependent sizes is known to 2 %; two that a jump takes part in do not count.

    The sine bends by 3·(2·0.005)² = 3e-4 from sample to sample, a thousandth of the noise.
    """
    jumping = SIGNAL + np.where(TIME_S > 10.0, 50.0, 0.0)
    assert second_difference_noise(jumping) == pytest.approx(0.2, rel=0.04)
    assert second_difference_noise(jumping[:2]) == 0.0
