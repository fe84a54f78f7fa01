"""Noise models of channels."""

from __future__ import annotations

import numpy as np
import pytest
from noise import ar1
from scipy.linalg import toeplitz

from softid.uncertainty.autoregression import AutoRegression, autocovariance
from softid.uncertainty.noise import effective_n, noise_model


def test_effective_n_is_that_of_the_dense_covariance() -> None:
    """n_e = N² γ_0 / Σ_s 1ᵀ Γ_s 1, dense, for two segments."""
    ar = AutoRegression((0.7,), 1.0, (1.0 / 0.51) ** 0.5, 0, 0.0, 0.0)
    gamma = autocovariance(ar, 30)
    total = sum(toeplitz(gamma[:n]).sum() for n in (30, 12))
    assert effective_n(ar, [30, 12]) == pytest.approx(42**2 * gamma[0] / total)


def test_effective_n_of_a_long_ar1() -> None:
    """Limit n (1 − ρ)/(1 + ρ): 500 of 9500 at ρ = 0.9, to 1 %."""
    ar = AutoRegression((0.9,), 1.0, (1.0 / 0.19) ** 0.5, 0, 0.0, 0.0)
    assert effective_n(ar, [9500]) == pytest.approx(500.0, rel=0.01)


def test_white_noise_is_called_white() -> None:
    """Whiteness is kept at 1 %: of 60 white records at most 4 alarms (binomial, 0.3 % beyond)."""
    rng = np.random.default_rng(1)
    found = [noise_model("angle", [rng.normal(size=400), rng.normal(size=300)]) for _ in range(60)]
    assert sum(not m.white for m in found) <= 4
    assert np.median([m.effective_n for m in found]) == pytest.approx(700.0, rel=0.05)


def test_coloured_noise_is_called_coloured_and_counts_for_less() -> None:
    """AR(1) 0.9 over 4000 samples: n_e = 210, to 25 % (standard error of ρ 0.007)."""
    y = ar1(np.random.default_rng(2), 4000, 0.9)
    y[1000:1010] = np.nan
    found = noise_model("angle", [y])
    assert not found.white
    assert found.effective_n == pytest.approx(210.0, rel=0.25)
    assert found.ar[0] == pytest.approx(0.9, abs=0.06)


def test_fitted_parameters_enlarge_the_standard_deviation() -> None:
    """σ² = Σ r²/(n − k): four residuals of size 1 and two parameters give √2."""
    found = noise_model("angle", [np.array([1.0, -1.0, 1.0, -1.0])], fitted_parameters=2)
    assert found.sigma == pytest.approx(np.sqrt(2.0))
    assert found.channel == "angle"


def test_a_perfect_fit_has_a_noise_model() -> None:
    """Zero residuals: no noise, white, nothing divided by zero."""
    found = noise_model("angle", [np.zeros(100)])
    assert (found.sigma, found.white, found.effective_n) == (0.0, True, 100.0)


def test_a_noise_model_counts_no_more_samples_than_there_are() -> None:
    """±1 in turn has a mean far better known than by as many white samples, yet only 20 of them."""
    rng = np.random.default_rng(0)
    residual = (-1.0) ** np.arange(20) + 0.3 * rng.standard_normal(20)
    ar = AutoRegression((-0.7,), 1.0, (1 / 0.51) ** 0.5, 20, 0.0, 0.0)
    assert effective_n(ar, [20]) > 50.0
    assert noise_model("angle", [residual], ar=ar).effective_n == 20.0
