"""Burg's recursion and autocovariances against their definitions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_toeplitz

from softid.kernels.autoregression import autocovariances, reflections

RNG = np.random.default_rng(6)


def by_definition(runs: list[np.ndarray], order: int) -> list[float]:
    """k = 2 Σ f b / Σ (f² + b²) with f and b updated sample by sample."""
    pairs, found = [(r[1:], r[:-1]) for r in runs], []
    for _ in range(order):
        cross = sum(float(f @ b) for f, b in pairs)
        k = 2.0 * cross / sum(float(f @ f + b @ b) for f, b in pairs)
        found.append(k)
        pairs = [((f - k * b)[1:], (b - k * f)[:-1]) for f, b in pairs]
    return found


def test_reflections_of_several_stretches() -> None:
    """Three stretches, one shorter than the order: as defined, to rounding."""
    runs = [np.cumsum(RNG.normal(size=n)) * 0.1 + RNG.normal(size=n) for n in (80, 3, 41)]
    edges = np.cumsum([0, 80, 3, 41])
    found = reflections(np.concatenate(runs), edges, 5, 1e-6)
    np.testing.assert_allclose(found, by_definition(runs, 5), rtol=1e-10)


def test_what_can_be_predicted_exactly_ends_the_recursion() -> None:
    """A constant is its own prediction: k stops short of 1 by the least share, zeros follow."""
    found = reflections(np.ones(50), np.array([0, 50]), 3, 1e-6)
    assert found[0] == pytest.approx(np.sqrt(1.0 - 1e-6))
    assert found[1] == 0.0


@pytest.mark.parametrize("phi", [(), (0.7,), (-0.9,), (1.2, -0.5), (0.4, 0.2, 0.1, -0.3)])
def test_autocovariances_solve_yule_and_walker(phi: tuple[float, ...]) -> None:
    """Γ φ = (γ₁ … γ_p), γ₀ − φ·γ = 1, and the recursion from there on; closed form, 1e-10."""
    p, coefficients = len(phi), np.array(phi)
    gamma = autocovariances(coefficients, 200, 1e-18)
    if p:
        np.testing.assert_allclose(solve_toeplitz(gamma[:p], gamma[1 : p + 1]), phi, rtol=1e-10)
    assert gamma[0] - coefficients @ gamma[1 : p + 1] == pytest.approx(1.0, rel=1e-10)
    for k in range(p + 1, 60):
        assert gamma[k] == pytest.approx(coefficients @ gamma[k - p : k][::-1], abs=1e-12)
    np.testing.assert_allclose(autocovariances(coefficients, 2, 1e-18), gamma[:2], rtol=1e-14)
