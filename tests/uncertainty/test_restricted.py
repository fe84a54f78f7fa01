"""Restricted likelihood against dense algebra and its purpose: no loss from fitted regressors."""

from __future__ import annotations

import numpy as np
import pytest
from noise import ar1
from scipy.linalg import toeplitz
from scipy.signal import lfilter

from softid.errors import IdentificationError
from softid.uncertainty.autoregression import AutoRegression, autocovariance, fit_ar, to_phi
from softid.uncertainty.moments import gather_moments
from softid.uncertainty.restricted import Stencil, differences, draw_in, evaluate, restricted_ar


def dense_objective(parts: list[tuple[np.ndarray, np.ndarray]], reflection: np.ndarray) -> float:
    """−2ℓ with the innovation variance profiled out, from dense covariance matrices."""
    ar = AutoRegression(tuple(to_phi(reflection)), 1.0, 1.0, 0, 0.0, 0.0)
    n = sum(r.size for _, r in parts)
    width = parts[0][0].shape[1]
    form, determinant = np.zeros((width + 1, width + 1)), 0.0
    for basis, residual in parts:
        v = toeplitz(autocovariance(ar, residual.size))
        y = np.column_stack((basis, residual))
        form += y.T @ np.linalg.solve(v, y)
        determinant += np.linalg.slogdet(v)[1]
    inner, cross = form[:-1, :-1], form[:-1, -1]
    left = form[-1, -1] - cross @ np.linalg.solve(inner, cross)
    return (n - width) * np.log(left / (n - width)) + determinant + np.linalg.slogdet(inner)[1]


def test_objective_is_the_dense_restricted_likelihood() -> None:
    """Two segments, one gap, one run shorter than the order; 1e-5 is the nugget of 1e-6."""
    rng = np.random.default_rng(1)
    design = rng.normal(size=(60, 2))
    residual = rng.normal(size=60)
    residual[20] = residual[23] = np.nan
    runs = [slice(0, 20), slice(21, 23), slice(24, 40), slice(40, 60)]
    parts = [(design[s], residual[s]) for s in runs]
    moments = gather_moments([residual[:40], residual[40:]], [design[:40], design[40:]], 4)
    assert (moments.n, moments.longest) == (58, 20)
    trials = np.array([[0.5, -0.3, 0.2], [-0.4, 0.6, 0.1], [0.0, 0.0, 0.0]])
    expected = [dense_objective(parts, k) for k in trials]
    np.testing.assert_allclose(evaluate(moments, trials).value, expected, atol=1e-3, rtol=1e-5)


def test_lower_order_is_the_same_as_zero_coefficients() -> None:
    """Orders share the moments: order 1 equals order 3 with two zeros."""
    rng = np.random.default_rng(2)
    moments = gather_moments([rng.normal(size=50)], [rng.normal(size=(50, 2))], 3)
    short = evaluate(moments, np.array([[0.6]])).value
    np.testing.assert_allclose(short, evaluate(moments, np.array([[0.6, 0.0, 0.0]])).value)


def smooth_regressors(n: int) -> np.ndarray:
    t = np.linspace(0.0, 1.0, n)
    columns = (np.ones(n), np.sin(10 * np.pi * t), 1.0 - np.exp(-t / 0.1), t)
    return np.linalg.qr(np.column_stack(columns))[0]


def test_restricted_fit_undoes_what_the_regressors_took() -> None:
    """AR(1) 0.98, n = 1000, four smooth regressors, 60 draws.

    The plain fit to residuals loses some 0.01 of ρ and 15 % of σ; the restricted fit loses less
    than the standard error of the mean, 0.001 and 3 %, allowed three times.
    """
    basis = smooth_regressors(1000)
    rng = np.random.default_rng(3)
    plain, restricted = [], []
    for _ in range(60):
        y = ar1(rng, 1000, 0.98)
        residual = y - basis @ (basis.T @ y)
        start = fit_ar([residual], max_order=1)
        fit = restricted_ar(gather_moments([residual], [basis], 1), start)
        plain.append((start.phi[0], start.sigma))
        restricted.append((fit.ar.phi[0], fit.ar.sigma))
    assert np.mean(plain, axis=0)[0] < 0.975
    assert np.mean(plain, axis=0)[1] < 0.88
    assert np.mean(restricted, axis=0)[0] == pytest.approx(0.98, abs=0.003)
    assert np.median(restricted, axis=0)[1] == pytest.approx(1.0, abs=0.09)


def test_optimum_is_stationary() -> None:
    """The gradient at the result is small against one unit of log likelihood."""
    y = lfilter([1.0], [1.0, -1.3, 0.5], np.random.default_rng(4).normal(size=800))
    basis = smooth_regressors(800)
    residual = y - basis @ (basis.T @ y)
    moments = gather_moments([residual], [basis], 2)
    fit = restricted_ar(moments, fit_ar([residual], max_order=2))
    assert np.abs(differences(moments, fit.position, Stencil.of(fit.position.size))[0]).max() < 0.05


def test_a_memory_beyond_the_record_is_drawn_in() -> None:
    """A random walk: the root stays below exp(−1/n) and the variance finite."""
    walk = np.cumsum(np.random.default_rng(5).normal(size=400))
    basis = np.full((400, 1), 0.05)
    residual = walk - walk.mean()
    fit = restricted_ar(gather_moments([residual], [basis], 1), fit_ar([residual], max_order=1))
    assert fit.ar.phi[0] <= np.exp(-1.0 / 400) + 1e-9
    assert residual.std() <= fit.ar.sigma < 10.0 * residual.std()


def test_drawing_in_scales_the_roots() -> None:
    """Roots 0.999 and 0.5, limit exp(−1/100): the largest lands there, both by one factor."""
    limit = np.exp(-0.01)
    phi, capped = draw_in(np.array([1.499, -0.4995]), 100)
    roots = np.sort(np.abs(np.roots([1.0, *-phi])))
    assert capped
    np.testing.assert_allclose(roots, np.array([0.5, 0.999]) * limit / 0.999, rtol=1e-9)
    assert not draw_in(np.array([0.5]), 100)[1]


def test_nothing_left_to_learn_from_is_an_error() -> None:
    """As many reachable directions as samples."""
    rng = np.random.default_rng(6)
    moments = gather_moments([rng.normal(size=4)], [np.eye(4)], 2)
    with pytest.raises(IdentificationError, match="follow all"):
        restricted_ar(moments, fit_ar([rng.normal(size=4)], max_order=0))
