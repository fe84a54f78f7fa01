"""The whiteness of residuals that fitters ask for."""

from __future__ import annotations

import numpy as np
import pytest

from softid.fitters.residual_whiteness import (
    STRUCTURE_SDS,
    TESTED_LAGS,
    WHITE_SDS,
    largest_sum,
    squared_autocorrelation,
)


def test_white_noise_has_the_mean_of_its_chi_square() -> None:
    """n Σ ρ² over 1000 draws of 2000 samples: 19.9 ± 0.2, for lag k has n − k products of n."""
    rng = np.random.default_rng(1)
    sums = [
        2000 * squared_autocorrelation([rng.standard_normal(2000)], TESTED_LAGS)
        for _ in range(1000)
    ]
    assert np.mean(sums) == pytest.approx(19.9, abs=4 * np.sqrt(2 * TESTED_LAGS / 1000))
    assert max(sums) < largest_sum(STRUCTURE_SDS)
    assert np.mean(np.array(sums) > largest_sum(WHITE_SDS)) < 0.01


def test_the_limits_by_hand() -> None:
    """20 + 4·√40 and 20 + 6·√40; a sign that alternates has ρ² = (1 − k/n)² at lag k."""
    assert largest_sum(WHITE_SDS) == pytest.approx(45.2982)
    assert largest_sum(STRUCTURE_SDS) == pytest.approx(57.9473)
    signs = np.where(np.arange(100) % 2, 1.0, -1.0)
    assert squared_autocorrelation([signs], 2) == pytest.approx(0.99**2 + 0.98**2)
