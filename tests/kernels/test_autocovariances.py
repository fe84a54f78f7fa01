"""Autocovariances side by side, against the closed form of one coefficient."""

from __future__ import annotations

import numpy as np

from softid.kernels.autocovariances import fill_autocovariances


def test_one_coefficient_falls_by_powers_until_it_has_faded() -> None:
    """γ_k = φᵏ/(1 − φ²), to rounding; below the share, 30 halvings for the first, it is 0."""
    reflection, gamma = np.array([[0.5], [-0.9]]), np.zeros((60, 2))
    fill_autocovariances(reflection, 1e-9, gamma)
    expected = reflection[:, 0] ** np.arange(60)[:, None] / (1.0 - reflection[:, 0] ** 2)
    np.testing.assert_allclose(gamma[:30], expected[:30], rtol=1e-14)
    assert gamma[29:31, 0].tolist() == [expected[29, 0], 0.0]
    np.testing.assert_allclose(gamma[:, 1], expected[:, 1], rtol=1e-13)


def test_levinson_gives_what_the_coefficients_continue() -> None:
    """Of order 3: every autocovariance is Σ φ_j γ_{k−j} of those before, also across zero."""
    reflection = np.array([[0.6, -0.3, 0.2]])
    gamma = np.zeros((12, 1))
    fill_autocovariances(reflection, 0.0, gamma)
    whole = np.concatenate((gamma[:0:-1, 0], gamma[:, 0]))
    table = np.lib.stride_tricks.sliding_window_view(whole, 3)[9 : 9 + 11]
    phi = np.linalg.solve(table[:3], whole[12 : 12 + 3])
    np.testing.assert_allclose(table @ phi, whole[12 : 12 + 11], atol=1e-13)
