"""Residual statistics against sums written out, closed forms and false-alarm rates."""

from __future__ import annotations

import numpy as np
import pytest
from noise import ar1

from softid.errors import InputError, UsageError
from softid.residuals import autocorrelation, cross_correlation, ljung_box, whiteness


def test_autocorrelation_without_gaps_is_the_textbook_sum() -> None:
    """Definition: Σ x_t x_{t+k} / Σ x_t² of centred samples, to rounding."""
    x = np.random.default_rng(1).normal(size=50) + 7.0
    c = x - x.mean()
    expected = [c[: 50 - k] @ c[k:] / (c @ c) for k in range(11)]
    found = autocorrelation(x, 10)
    np.testing.assert_allclose(found.values, expected, atol=1e-12)
    assert found.white_band == pytest.approx(1.96 / np.sqrt(50), rel=1e-4)


def test_autocorrelation_with_gaps_runs_over_available_pairs() -> None:
    """Definition with gaps, written out by loops over the pairs."""
    x = np.random.default_rng(2).normal(size=60)
    x[[3, 4, 20, 41, 42, 43]] = np.nan
    used = np.isfinite(x)
    c, n = x - np.nanmean(x), int(used.sum())
    found = autocorrelation(x, 5)
    for k in range(1, 6):
        pairs = [c[t] * c[t + k] for t in range(60 - k) if used[t] and used[t + k]]
        expected = (1 - k / n) * np.mean(pairs) / np.nanmean(c**2)
        assert found.values[k] == pytest.approx(expected, abs=1e-12)
    assert found.n == n


def test_autocorrelation_of_ar1_falls_geometrically() -> None:
    """Closed form ρ^k; n = 50,000 gives a standard error below 0.02 at these lags."""
    found = autocorrelation(ar1(np.random.default_rng(3), 50_000, 0.8), 6)
    np.testing.assert_allclose(found.values, 0.8 ** np.arange(7), atol=0.04)


def test_bartlett_band_grows_with_what_lies_before() -> None:
    """Closed form: half-width 1.96 √[(1 + 2 r_1²)/n] at lag 2, the white one at lag 1."""
    found = autocorrelation(ar1(np.random.default_rng(4), 400, 0.7), 4)
    assert found.bartlett_band[1] == pytest.approx(found.white_band)
    expected = found.white_band * np.sqrt(1.0 + 2.0 * found.values[1] ** 2)
    assert found.bartlett_band[2] == pytest.approx(expected)


def test_cross_correlation_sign_and_size() -> None:
    """A residual that is the input three samples later has its peak, nearly 1, at lag +3."""
    u = np.random.default_rng(5).normal(size=500)
    found = cross_correlation(np.concatenate((np.zeros(3), u[:-3])), u, 8)
    assert found.lags[np.argmax(found.values)] == 3
    assert found.values.max() == pytest.approx(1.0, abs=0.02)


def test_cross_correlation_band_knows_the_memory_of_both() -> None:
    """Unrelated AR(1) series, 0.9 each, leave the band at 5 % of lags, the white one far oftener.

    40 series × 81 correlated lags: the rate has a standard error of about 1.5 %.
    """
    rng = np.random.default_rng(6)
    out, out_white = [], []
    for _ in range(40):
        found = cross_correlation(ar1(rng, 1000, 0.9), ar1(rng, 1000, 0.9), 40)
        out.append(np.mean(np.abs(found.values) > found.band))
        out_white.append(np.mean(np.abs(found.values) > found.white_band))
    assert 0.01 < np.mean(out) < 0.10
    assert np.mean(out_white) > 0.3


def test_ljung_box_statistic_by_hand() -> None:
    """x = 1, −1, 1, −1: r = −3/4, 1/2, so Q = 4·6·(0.75²/3 + 0.5²/2) = 7.5; χ²₂ tail e^{−Q/2}."""
    found = ljung_box(np.array([1.0, -1.0, 1.0, -1.0]), 2)
    assert found.statistic == pytest.approx(7.5)
    assert found.p_value == pytest.approx(np.exp(-3.75))


@pytest.mark.parametrize("missing", [0.0, 0.3])
def test_ljung_box_keeps_its_level_on_white_noise(missing: float) -> None:
    """False alarms at 5 % in 400 white records: 20 ± 3 binomial standard deviations (13)."""
    rng = np.random.default_rng(7)
    alarms = 0
    for _ in range(400):
        x = rng.normal(size=300)
        x[rng.random(300) < missing] = np.nan
        alarms += ljung_box(x, 15).p_value < 0.05
    assert 7 <= alarms <= 33


def test_ljung_box_finds_a_memory_and_counts_fitted_coefficients() -> None:
    """AR(1) 0.4 over 500 samples is beyond doubt; its innovations are white again."""
    x = ar1(np.random.default_rng(8), 500, 0.4)
    assert ljung_box(x, 10).p_value < 1e-6
    whitened = ljung_box(x[1:] - 0.4 * x[:-1], 10, 1)
    assert whitened.p_value > 0.01
    assert whitened.degrees_of_freedom == 9


def test_whiteness_of_segments_is_that_of_their_own_pairs() -> None:
    """Lags of a fifth of the samples, twenty at most; no pair spans two segments."""
    x = np.random.default_rng(5).standard_normal(120)
    assert whiteness([x]) == ljung_box(x, 20)
    assert whiteness([x[:30]]) == ljung_box(x[:30], 6)
    assert whiteness([x[:4]]) == ljung_box(x[:4], 1)
    apart = np.concatenate([x[:50], np.full(20, np.nan), x[50:]])
    assert whiteness([x[:50], x[50:]]) == ljung_box(apart, 20)
    assert whiteness([x]).is_white
    assert not whiteness([np.cumsum(x)]).is_white


def test_ljung_box_of_a_constant_residual_does_not_alarm() -> None:
    """Nothing varies, so nothing speaks against whiteness."""
    assert ljung_box(np.full(30, 0.1), 5).p_value == 1.0


def test_mistakes_are_named() -> None:
    """Every edge check raises its own error."""
    x = np.arange(10.0)
    with pytest.raises(UsageError, match="largest lag"):
        autocorrelation(x, 10)
    with pytest.raises(InputError, match="does not vary"):
        autocorrelation(np.full(10, 0.1), 2)
    with pytest.raises(InputError, match="differ in length"):
        cross_correlation(x, x[:5], 2)
    with pytest.raises(UsageError, match="degrees of freedom"):
        ljung_box(x, 3, 3)
    with pytest.raises(InputError, match="fewer than two"):
        ljung_box(np.array([1.0, np.nan, np.nan]), 1)
