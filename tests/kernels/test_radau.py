"""The Radau step against closed forms, an independent adaptive solver and its own order."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from softid.kernels.radau import STAGES, propagate, propagate_with_sensitivities
from softid.models.muscle_law import MuscleLaw
from softid.models.second_order import _BLOCK, simulate_law

Array = npt.NDArray[np.float64]
MUSCLE = np.array([2e-3, 1 / 70, 2.8, 1.0, 0.02, 1.6, 0.25])


def run(
    step_s: Array, mass: float, damping: Array, stiffness: Array, force: Array, state: Array
) -> tuple[Array, Array]:
    """States after each step, and ∂x by (x₀, v₀)."""
    n = step_s.size
    plain, states = np.empty((n, 2)), np.empty((n, 2))
    propagate(step_s, mass, damping, stiffness, force, state.copy(), plain)
    tangent, tangents = np.eye(2), np.empty((n, 2))
    none = np.zeros((n, 3, 0))
    propagate_with_sensitivities(
        step_s,
        mass,
        damping,
        stiffness,
        force,
        np.zeros(0),
        none,
        none,
        none,
        state.copy(),
        tangent,
        states,
        tangents,
    )
    np.testing.assert_allclose(states, plain, rtol=1e-12, atol=1e-14)
    return plain, tangents


def constant(value: float, n: int) -> Array:
    return np.full((n, 3), value)


@pytest.mark.parametrize("damping", [0.3, 4.0, 12.0])
def test_constant_coefficients_follow_the_matrix_exponential(damping: float) -> None:
    """Closed form y = y∞ + exp(A t)(y₀ − y∞). A step of 0.05/|λ| leaves h⁵-errors below 1e-7."""
    mass, stiffness, force = 0.5, 9.0, 4.0
    start = np.array([0.2, -1.0])
    n, h = 200, 0.01
    states, tangents = run(
        np.full(n, h),
        mass,
        constant(damping, n),
        constant(stiffness, n),
        constant(force, n),
        start,
    )
    a = np.array([[0.0, 1.0], [-stiffness / mass, -damping / mass]])
    rest = np.array([force / stiffness, 0.0])
    for k in (0, 57, n - 1):
        phi = expm(a * h * (k + 1))
        np.testing.assert_allclose(states[k], rest + phi @ (start - rest), atol=1e-7)
        np.testing.assert_allclose(tangents[k], phi[0], atol=1e-7)


def test_without_mass_it_is_the_first_order_law() -> None:
    """m = 0: x = x∞ + (x₀ − x∞)·exp(−q t/n), whatever velocity is given at the start."""
    n, h = 100, 0.02
    states, tangents = run(
        np.full(n, h),
        0.0,
        constant(2.0, n),
        constant(3.0, n),
        constant(6.0, n),
        np.array([0.5, 99.0]),
    )
    t = h * np.arange(1, n + 1)
    np.testing.assert_allclose(states[:, 0], 2.0 - 1.5 * np.exp(-1.5 * t), atol=1e-9)
    np.testing.assert_allclose(tangents[:, 0], np.exp(-1.5 * t), atol=1e-9)
    assert np.all(tangents[:, 1] == 0.0)


def test_without_mass_and_damping_it_is_the_static_law() -> None:
    """m = n = 0: x = f/q at the end of every step, to rounding, independent of the start."""
    n = 30
    t = 0.1 * (np.arange(n)[:, None] + STAGES[None, :])
    force, stiffness = 2.0 + np.sin(t), 3.0 + np.cos(2 * t)
    states, tangents = run(
        np.full(n, 0.1), 0.0, constant(0.0, n), stiffness, force, np.array([7.0, -3.0])
    )
    np.testing.assert_allclose(states[:, 0], (force / stiffness)[:, 2], rtol=1e-12)
    np.testing.assert_allclose(tangents, 0.0, atol=1e-12)


def test_order_of_convergence_is_five() -> None:
    """Radau IIA with three stages has order 5; halving the step must gain at least 2^4.5."""
    mass = 0.4
    ends, steps = 2.0, np.array([20, 40, 80])

    def coefficients(t: Array) -> tuple[Array, Array, Array]:
        return 1.0 + 0.5 * np.cos(t), 6.0 + np.sin(2 * t), np.sin(3 * t) + 1.0

    def rates(t: float, y: Array) -> list[float]:
        n, q, f = (float(c) for c in coefficients(np.asarray(t)))
        return [y[1], (f - n * y[1] - q * y[0]) / mass]

    exact = solve_ivp(rates, (0, ends), [0.1, 0.0], "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    errors = []
    for n in steps.tolist():
        h = ends / n
        damping, stiffness, force = coefficients(h * (np.arange(n)[:, None] + STAGES[None, :]))
        states, _ = run(np.full(n, h), mass, damping, stiffness, force, np.array([0.1, 0.0]))
        errors.append(np.abs(states[-1] - exact).max())
    assert np.all(np.diff(-np.log2(errors)) >= 4.5), errors


def test_vanishing_mass_tends_to_the_first_order_law() -> None:
    """m → 0 is a regular limit of the step: the difference falls with m and nothing oscillates."""
    n, h = 60, 0.02
    t = h * (np.arange(n)[:, None] + STAGES[None, :])
    force = np.where(t < 0.4, 1.0, 3.0)

    def ended(mass: float) -> Array:
        return run(
            np.full(n, h), mass, constant(0.5, n), constant(4.0, n), force, np.array([0.25, 0.0])
        )[0][:, 0]

    limit = ended(0.0)
    gaps = [float(np.abs(ended(m) - limit).max()) for m in (1e-3, 1e-5, 1e-8, 1e-14)]
    assert gaps == sorted(gaps, reverse=True)
    assert gaps[-1] < 1e-11
    assert np.all(np.diff(ended(1e-10)[25:]) > -1e-12)


@pytest.mark.parametrize("step_s", [1e-4, 1.0, 1e4])
def test_any_stiffness_is_stable(step_s: float) -> None:
    """L-stability: |R(z)| ≤ 1 for Re z ≤ 0 and R(∞) = 0, so the state never exceeds its start."""
    n = 50
    for mass, damping in ((1e-9, 1.0), (1.0, 1e-9), (1e-3, 1e3), (1e3, 0.0)):
        states, _ = run(
            np.full(n, step_s),
            mass,
            constant(damping, n),
            constant(1.0, n),
            constant(0.0, n),
            np.array([1.0, 0.0]),
        )
        energy = 0.5 * mass * states[:, 1] ** 2 + 0.5 * states[:, 0] ** 2
        assert np.all(energy <= 0.5 * (1 + 1e-9)), (mass, damping)


def reference(theta: Array, time_s: Array, p_kpa: Array) -> Array:
    """solve_ivp Radau, rtol 1e-9, restarted at every sample, the pressure straight in between."""
    mass, a1, b1, c1, a2, b2, c2 = theta
    x = np.empty(time_s.size)
    e0 = np.exp(b1 * p_kpa[0] / 100)
    state = np.array([e0 / (a1 * e0 + c1), 0.0])
    x[0] = state[0]
    for k in range(time_s.size - 1):
        t0, t1, p0, p1 = time_s[k], time_s[k + 1], p_kpa[k] / 100, p_kpa[k + 1] / 100
        slope = (p1 - p0) / (t1 - t0)

        def parts(t: float) -> tuple[float, float, float]:
            p = p0 + slope * (t - t0)  # noqa: B023 -- used before the loop goes on
            e1 = np.exp(b1 * p)
            return a2 * np.exp(b2 * p) + c2, a1 * e1 + c1, e1

        def rates(t: float, y: Array) -> list[float]:
            n, q, f = parts(t)
            return [y[1], (f - n * y[1] - q * y[0]) / mass]

        def slopes(t: float, y: Array) -> list[list[float]]:
            n, q, _ = parts(t)
            return [[0.0, 1.0], [-q / mass, -n / mass]]

        state = solve_ivp(rates, (t0, t1), state, "Radau", rtol=1e-9, atol=1e-10, jac=slopes).y[
            :, -1
        ]
        x[k + 1] = state[0]
    return x


def jumps(period_s: float, holds: tuple[float, ...], hold_s: float) -> tuple[Array, Array]:
    n = round(hold_s / period_s)
    levels = np.repeat(holds, n)
    return period_s * np.arange(levels.size), levels


def worst(factor: float, period_s: float, holds: tuple[float, ...], hold_s: float) -> float:
    """Largest error as a fraction of the range."""
    theta = MUSCLE.copy()
    theta[0] *= factor
    time_s, p_kpa = jumps(period_s, holds, hold_s)
    x = simulate_law(MuscleLaw(theta), time_s, p_kpa, None, derivatives=False).x
    exact = reference(theta, time_s, p_kpa)
    return float(np.abs(x - exact).max() / np.ptp(exact))


@pytest.mark.parametrize(
    ("factor", "period_s"), [(1e-5, 0.1), (1e-2, 0.02), (1.0, 0.1), (1e2, 0.02)]
)
def test_jumps_are_followed(factor: float, period_s: float) -> None:
    """Within 1e-4 of the range of an adaptive stiff solver with a relative tolerance of 1e-9."""
    assert worst(factor, period_s, (0.0, 150.0, 60.0), 0.4) <= 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("period_s", [0.005, 0.02, 0.1])
@pytest.mark.parametrize("factor", np.geomspace(1e-5, 1e2, 15).tolist())
def test_jumps_are_followed_at_any_stiffness(factor: float, period_s: float) -> None:
    """As above, over the whole grid of inertia and sampling."""
    assert worst(factor, period_s, (0.0, 240.0, 60.0, 300.0, 0.0), 0.6) <= 1e-4


def test_irregular_sampling() -> None:
    """Jittered times, one pair 20 µs apart and a gap of 0.3 s: within 1e-4 of the range."""
    rng = np.random.default_rng(4)
    time_s = np.cumsum(rng.uniform(0.005, 0.04, 60))
    time_s[30:] += 0.3
    time_s = np.sort(np.append(time_s, time_s[10] + 2e-5))
    p_kpa = 120.0 + 100.0 * np.sin(3.0 * time_s)
    x = simulate_law(MuscleLaw(MUSCLE), time_s, p_kpa, None, derivatives=False).x
    exact = reference(MUSCLE, time_s, p_kpa)
    assert np.abs(x - exact).max() <= 1e-4 * np.ptp(exact)


def test_a_long_log_runs_over_block_boundaries() -> None:
    """The map is a chain: two halves, the second from the first's end state, equal the whole."""
    n = 2 * _BLOCK + 700
    time_s = 0.01 * np.arange(n)
    p_kpa = 120.0 + 100.0 * np.sin(0.7 * time_s) + np.where((time_s % 5) < 2, 40.0, 0.0)
    law = MuscleLaw(MUSCLE)
    whole = simulate_law(law, time_s, p_kpa, None, derivatives=True)
    cut = _BLOCK - 3
    first = simulate_law(law, time_s[: cut + 1], p_kpa[: cut + 1], None, derivatives=False)
    second = simulate_law(
        law, time_s[cut:], p_kpa[cut:], np.array([first.x[-1], first.v[-1]]), derivatives=True
    )
    np.testing.assert_allclose(whole.x[: cut + 1], first.x, rtol=1e-12)
    np.testing.assert_allclose(whole.x[cut:], second.x, rtol=1e-10)
    assert whole.by_parameter is not None
    assert np.isfinite(whole.by_parameter).all()
    # θ of step 1e-6 across the boundary, where a lost tangent would show at once.
    up, down = MUSCLE.copy(), MUSCLE.copy()
    up[3] *= 1 + 1e-6
    down[3] *= 1 - 1e-6
    x_up = simulate_law(MuscleLaw(up), time_s, p_kpa, None, derivatives=False).x
    x_down = simulate_law(MuscleLaw(down), time_s, p_kpa, None, derivatives=False).x
    slope = (x_up - x_down) / (2e-6 * MUSCLE[3])
    late = slice(_BLOCK - 5, None)
    scale = np.abs(slope).max()
    np.testing.assert_allclose(whole.by_parameter[late, 3], slope[late], atol=1e-5 * scale)
