"""Quadratic forms by transforms against dense Toeplitz matrices."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import toeplitz

from softid.uncertainty import lag_form
from softid.uncertainty.lag_form import LagForm


@pytest.mark.parametrize("chunk", [lag_form.CHUNK, 7])
def test_form_is_the_dense_product_summed_over_segments(
    chunk: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Σ_s W_sᵀ T_s W_s, two lengths, to rounding, whole and in parts of the spectrum."""
    monkeypatch.setattr(lag_form, "CHUNK", chunk)
    rng = np.random.default_rng(1)
    series = [rng.normal(size=(37, 3)), rng.normal(size=(12, 3))]
    lags = 0.9 ** np.arange(37) + np.cos(np.arange(37))
    expected = sum(w.T @ toeplitz(lags[: len(w)]) @ w for w in series)
    form = LagForm.of(series)
    np.testing.assert_allclose(form.matrix(lags), expected, atol=1e-10)
    np.testing.assert_allclose(form.diagonal(lags), np.diag(expected), atol=1e-10)


def test_one_sample_is_enough() -> None:
    """The smallest series: w² T_0."""
    form = LagForm.of([np.array([[3.0]])])
    np.testing.assert_allclose(form.matrix(np.array([2.0])), [[18.0]])
