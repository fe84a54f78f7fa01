"""Autoregressions against closed forms and dense linear algebra."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import cholesky, solve_triangular, toeplitz
from scipy.signal import lfilter

from softid.errors import IdentificationError, UsageError
from softid.uncertainty.autoregression import (
    AutoRegression,
    autocovariance,
    contiguous_runs,
    fit_ar,
    log_likelihood,
    order_criteria,
    to_phi,
    to_reflection,
    whiten,
)
from softid.uncertainty.burg import MIN_LEFT, burg

AR3 = to_phi(np.array([0.8, -0.5, 0.3]))


def model(phi: np.ndarray, sigma: float = 1.0) -> AutoRegression:
    left = float(np.prod(1.0 - to_reflection(phi) ** 2))
    return AutoRegression(tuple(phi), sigma, sigma / left**0.5, 0, 0.0, 0.0)


def draw(phi: np.ndarray, n: int, seed: int) -> np.ndarray:
    shocks = np.random.default_rng(seed).normal(size=n + 5000)
    return lfilter([1.0], np.concatenate(([1.0], -phi)), shocks)[5000:]


def test_autocovariance_of_ar1() -> None:
    """Closed form σ² ρ^k/(1 − ρ²), to rounding over 1000 lags; below 1e-18 of γ₀ it is zero."""
    expected = 4.0 * 0.95 ** np.arange(1000) / (1.0 - 0.95**2)
    found = autocovariance(model(np.array([0.95]), 2.0), 1000)
    np.testing.assert_allclose(found, expected, atol=1e-18 * expected[0])
    assert found[-1] == 0.0


def test_autocovariance_of_ar2() -> None:
    """Closed form γ_0 = (1 − φ_2)/[(1 + φ_2)((1 − φ_2)² − φ_1²)], γ_1 = φ_1 γ_0/(1 − φ_2)."""
    a, b = 1.2, -0.5
    first = (1.0 - b) / ((1.0 + b) * ((1.0 - b) ** 2 - a**2))
    second = a * first / (1.0 - b)
    found = autocovariance(model(np.array([a, b])), 4)
    third = a * second + b * first
    np.testing.assert_allclose(found, [first, second, third, a * third + b * second])


def test_autocovariance_is_the_sum_over_the_impulse_response() -> None:
    """γ_k = Σ h_t h_{t+k}, 4000 terms of a response that has died out by then."""
    h = lfilter([1.0], np.concatenate(([1.0], -AR3)), np.eye(1, 4000)[0])
    expected = [h[: 4000 - k] @ h[k:] for k in range(40)]
    np.testing.assert_allclose(autocovariance(model(AR3), 40), expected, rtol=1e-10)


def test_reflection_and_coefficients_are_inverse() -> None:
    """Levinson's step up and step down undo each other."""
    k = np.array([0.9, -0.7, 0.2, 0.95])
    np.testing.assert_allclose(to_reflection(to_phi(k)), k, atol=1e-12)


def test_whitening_is_the_inverse_cholesky_factor() -> None:
    """σ L⁻¹ y with Γ = L Lᵀ: dense algebra, for residual and Jacobian, first samples included."""
    ar = model(AR3, 0.7)
    y = np.random.default_rng(1).normal(size=(40, 3))
    factor = cholesky(toeplitz(autocovariance(ar, 40)), lower=True)
    expected = 0.7 * solve_triangular(factor, y, lower=True)
    np.testing.assert_allclose(whiten(ar, y), expected, atol=1e-10)
    np.testing.assert_allclose(whiten(ar, y[:, 0]), expected[:, 0], atol=1e-10)


def test_whitening_starts_afresh_after_a_gap() -> None:
    """Each run by itself, and zero where a sample is not used."""
    ar = model(AR3)
    y = np.random.default_rng(2).normal(size=30)
    y[[10, 11]] = np.nan
    found = whiten(ar, y)
    np.testing.assert_allclose(found[:10], whiten(ar, y[:10]))
    np.testing.assert_allclose(found[12:], whiten(ar, y[12:]))
    assert not found[10:12].any()


def test_likelihood_is_that_of_the_dense_normal_law() -> None:
    """Sum over two segments of −½(log|2πΓ| + yᵀΓ⁻¹y)."""
    ar = model(AR3, 1.3)
    parts = [draw(AR3, 25, 3), draw(AR3, 2, 4)]
    expected = 0.0
    for y in parts:
        gamma = toeplitz(autocovariance(ar, y.size))
        expected -= 0.5 * np.linalg.slogdet(2.0 * np.pi * gamma)[1]
        expected -= 0.5 * float(y @ np.linalg.solve(gamma, y))
    assert log_likelihood(ar, parts) == pytest.approx(expected, rel=1e-10)


def test_fit_recovers_an_ar2_from_several_segments() -> None:
    """Four segments of 2000: standard error of φ √[(1 − φ_2²)/8000] = 0.010, allowed 4 times."""
    phi = np.array([1.3, -0.5])
    found = fit_ar([draw(phi, 2000, seed) for seed in range(4)], max_order=2)
    np.testing.assert_allclose(found.phi, phi, atol=0.04)
    assert found.sigma_innovation == pytest.approx(1.0, abs=0.03)


def test_fit_keeps_the_mean_square() -> None:
    """Burg: γ_0 = mean square of the samples, so nothing blows up, whatever the persistence."""
    for rho in (0.5, 0.999):
        y = draw(np.array([rho]), 1500, 5)
        ar = fit_ar([y])
        assert ar.sigma**2 == pytest.approx(float(np.mean(y**2)))
        assert autocovariance(ar, 3)[0] == pytest.approx(float(np.mean(y**2)), rel=1e-6)


@pytest.mark.parametrize("kind", ["walk", "line", "sine", "persistent"])
def test_fit_is_stable_and_bounded_on_what_is_no_noise(kind: str) -> None:
    """Misfit, noise-free residuals: all roots inside the circle, a millionth of the power left."""
    t = np.linspace(0.0, 1.0, 1000)
    rng = np.random.default_rng(6)
    y = {
        "walk": np.cumsum(rng.normal(size=1000)),
        "line": t - 0.5,
        "sine": np.sin(40.0 * t),
        "persistent": draw(np.array([0.999]), 1000, 7),
    }[kind]
    ar = fit_ar([y])
    roots = np.roots(np.concatenate(([1.0], -np.array(ar.phi))))
    assert np.abs(roots).max() < 1.0
    assert ar.sigma_innovation**2 >= 0.99 * MIN_LEFT * ar.sigma**2
    assert np.abs(autocovariance(ar, 1000)).max() <= ar.sigma**2 * (1.0 + 1e-6)


def test_gap_and_segment_break_are_the_same() -> None:
    """NaN between two stretches gives the model of the two stretches."""
    a, b = draw(AR3, 200, 8), draw(AR3, 150, 9)
    joined = fit_ar([np.concatenate((a, [np.nan], b))])
    np.testing.assert_allclose(joined.phi, fit_ar([a, b]).phi)
    assert [run.size for run in contiguous_runs(np.concatenate((a, [np.nan], b)))] == [200, 150]


def test_bic_finds_white_noise_white() -> None:
    """100 white records: BIC errs with probability below 1 % each at n = 1000 (χ²₁ > log 1000)."""
    rng = np.random.default_rng(10)
    records = [rng.normal(size=1000) for _ in range(100)]
    bics = [order_criteria(burg([y], 8), y @ y / y.size, y.size)["bic"] for y in records]
    assert sum(np.argmin(bic) == 0 for bic in bics) >= 93


def test_no_noise_is_a_model_without_noise() -> None:
    """A perfect fit of noise-free data must not divide by zero."""
    ar = fit_ar([np.zeros(50)])
    assert (ar.order, ar.sigma) == (0, 0.0)
    assert not autocovariance(ar, 5).any()


def test_mistakes_are_named() -> None:
    """Too few samples and a negative order."""
    with pytest.raises(IdentificationError, match="three residuals"):
        fit_ar([np.array([1.0, np.nan, 2.0])])
    with pytest.raises(UsageError):
        fit_ar([np.ones(9)], max_order=-1)
