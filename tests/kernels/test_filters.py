"""Filters that are exact between the samples, against closed forms."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline
from scipy.linalg import expm

from softid.kernels.filters import cubic, hermite, lag, lag_with_relief, resonance

IRREGULAR_S = np.concatenate(([0.0], np.cumsum(np.random.default_rng(1).uniform(1e-3, 0.3, 60))))


def lagged(time_s: np.ndarray, u: np.ndarray, rising_s: float, falling_s: float) -> np.ndarray:
    values = np.array(u)
    lag(np.diff(time_s), values, rising_s, falling_s)
    return values


def test_lag_follows_a_ramp() -> None:
    """y = s (t − τ (1 − e^{−t/τ})) at irregular times, to rounding."""
    found = lagged(IRREGULAR_S, 3.0 * IRREGULAR_S, 0.2, 0.2)
    expected = 3.0 * (IRREGULAR_S - 0.2 * (1.0 - np.exp(-IRREGULAR_S / 0.2)))
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(("tau_s", "tolerance"), [(0.0, 0.0), (1e-12, 1e-9), (1e9, 1e-4)])
def test_lag_at_its_limits(tau_s: float, tolerance: float) -> None:
    """Without a lag the input itself; with an endless one nothing but the first value."""
    u = np.cos(IRREGULAR_S)
    expected = np.full(u.size, u[0]) if tau_s > 1.0 else u
    np.testing.assert_allclose(
        lagged(IRREGULAR_S, u, tau_s, tau_s), expected, rtol=0.0, atol=tolerance
    )


def test_lag_switches_inside_an_interval() -> None:
    """A division of every interval into a thousand, which needs no switching, gives the same.

    On the fine grid an interval straddles the switch by at most a thousandth, where the difference
    that decays wrongly is itself below 1e-4; tolerance 1e-6 of the range of 1.
    """
    coarse_s = np.arange(0.0, 3.0, 0.1)
    u = np.interp(coarse_s, [0.0, 0.5, 0.8, 1.6, 2.1, 3.0], [0.0, 1.0, 0.3, 0.9, 0.0, 0.5])
    fine_s = np.linspace(0.0, coarse_s[-1], 1000 * (coarse_s.size - 1) + 1)
    fine = lagged(fine_s, np.interp(fine_s, coarse_s, u), 0.1, 0.4)
    np.testing.assert_allclose(lagged(coarse_s, u, 0.1, 0.4), fine[::1000], rtol=0.0, atol=1e-6)
    assert np.max(np.abs(lagged(coarse_s, u, 0.1, 0.4) - lagged(coarse_s, u, 0.1, 0.1))) > 0.05


def relieved(time_s: np.ndarray, u: np.ndarray, opens: float, lost: float) -> np.ndarray:
    values = np.array(u)
    lag_with_relief(np.diff(time_s), values, 0.1, opens, lost)
    return values


def test_a_relief_that_never_opens_or_always_is_a_lag() -> None:
    """Below the level that of τ; above it that of τ/(1 + ℓ), towards y0 + (u − y0)/(1 + ℓ)."""
    u = 2.0 + np.cos(IRREGULAR_S)
    np.testing.assert_allclose(relieved(IRREGULAR_S, u, 9.0, 0.5), lagged(IRREGULAR_S, u, 0.1, 0.1))
    open_ = 0.5 + (lagged(IRREGULAR_S, u, 0.1 / 1.5, 0.1 / 1.5) - 0.5) / 1.5
    np.testing.assert_allclose(relieved(IRREGULAR_S, u, 0.5, 0.5), open_, rtol=0.0, atol=1e-12)


def test_a_relief_opens_and_closes_inside_an_interval() -> None:
    """Against an integrator of SciPy that is restarted at every corner of the input.

    The level lies between the samples' values; the integrator is not restarted there.
    """
    coarse_s = np.arange(0.0, 3.0, 0.1)
    u = np.interp(coarse_s, [0.0, 0.5, 0.8, 1.6, 2.1, 3.0], [0.0, 1.0, 0.3, 0.9, 0.0, 0.5])
    opens, lost, tau = 0.55, 2.0, 0.1

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        relief = lost * np.maximum(y - opens, 0.0)
        return (np.interp(t, coarse_s, u) - y - relief) / tau

    expected = [u[0]]
    for begin, end in pairwise(coarse_s):
        solved = solve_ivp(rate, (begin, end), [expected[-1]], rtol=1e-11, atol=1e-12)
        expected.append(solved.y[0, -1])
    found = relieved(coarse_s, u, opens, lost)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-7)
    assert np.max(np.abs(found - lagged(coarse_s, u, tau, tau))) > 0.15


def test_a_relief_begins_settled() -> None:
    """A constant input stays: beyond the level only a share of it arrives."""
    flat = np.full(IRREGULAR_S.size, 2.0)
    np.testing.assert_allclose(relieved(IRREGULAR_S, flat, 1.0, 1.0), 1.5, rtol=1e-14)


@pytest.mark.parametrize("zeta", [0.02, 0.3, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.5, 3.0])
def test_resonance_is_the_matrix_exponential(zeta: float) -> None:
    """(y, ẏ, u, u̇) under its 4 × 4 generator, at any damping, within 1e-7 of the range.

    At ζ = 1 ± 1e-9 the closed form subtracts numbers that differ in their ninth digit.
    """
    omega = 7.0
    u = np.interp(IRREGULAR_S, [0.0, 1.0, 1.2, 4.0, 20.0], [0.0, 0.0, 1.0, 1.0, -2.0])
    found = np.array(u)
    resonance(np.diff(IRREGULAR_S), found, omega, zeta)
    generator = np.zeros((4, 4))
    generator[0, 1] = generator[2, 3] = 1.0
    generator[1, :3] = -(omega**2), -2.0 * zeta * omega, omega**2
    state = np.array([u[0], 0.0])
    for k, h in enumerate(np.diff(IRREGULAR_S)):
        slope = (u[k + 1] - u[k]) / h
        state = (expm(generator * h) @ np.array([*state, u[k], slope]))[:2]
        assert found[k + 1] == pytest.approx(state[0], abs=1e-7)


def test_resonance_far_beyond_the_sampling_is_none() -> None:
    """At ω h = 1e9 the line follows at once and nothing overflows."""
    u = np.cos(IRREGULAR_S)
    for zeta in (0.02, 1.0, 3.0):
        found = np.array(u)
        resonance(np.diff(IRREGULAR_S), found, 1e12, zeta)
        np.testing.assert_allclose(found, u, rtol=0.0, atol=1e-9)


def test_cubic_is_exact_for_a_cubic() -> None:
    """Any polynomial of degree three, also in the outermost intervals, to rounding."""
    at_s = np.linspace(IRREGULAR_S[0], IRREGULAR_S[-1], 333)
    found = np.empty(at_s.size)
    coefficients = [0.1, -0.7, 0.3, 2.0]
    cubic(IRREGULAR_S, np.polyval(coefficients, IRREGULAR_S), at_s, found)
    np.testing.assert_allclose(found, np.polyval(coefficients, at_s), rtol=1e-9, atol=1e-9)


def test_cubic_at_100_hz() -> None:
    """A motion of 3 Hz, within (ωh)⁴/43 of its amplitude, which is 1.5e-5 of its range.

    The bound is the remainder (3h/2)(h/2)(h/2)(3h/2)/24 times the fourth derivative, which holds
    only where the cubic lies through two samples on either side; at the ends 1e-4 of the range.
    """
    time_s = np.arange(0.0, 3.0, 0.01)
    at_s = np.linspace(0.0, time_s[-1], 5000)
    found = np.empty(at_s.size)
    cubic(time_s, np.sin(6.0 * np.pi * time_s), at_s, found)
    off = np.abs(found - np.sin(6.0 * np.pi * at_s)) / 2.0
    inside = (at_s > 0.01) & (at_s < time_s[-2])
    assert np.max(off[inside]) < 1.01 * (0.06 * np.pi) ** 4 * 9.0 / 384.0 / 2.0
    assert np.max(off) < 1e-4


@pytest.mark.parametrize("jitter", [0.0, 0.4])
def test_hermite_is_that_of_scipy_with_slopes_of_numpy(jitter: float) -> None:
    rng = np.random.default_rng(5)
    time_s = np.cumsum(0.01 * (1.0 + jitter * rng.uniform(-1.0, 1.0, 60)))
    y = np.cumsum(rng.standard_normal(60))
    finer_s, finer = np.empty(59 * 3), np.empty(59 * 3 + 1)
    hermite(np.diff(time_s), y, finer_s, finer)
    between_s = time_s[0] + np.concatenate([[0.0], np.cumsum(finer_s)])
    expected = CubicHermiteSpline(time_s, y, np.gradient(y, time_s, edge_order=2))(between_s)
    assert between_s[::3] == pytest.approx(time_s, abs=1e-12)
    assert finer == pytest.approx(expected, abs=1e-9)
