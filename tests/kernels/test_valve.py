"""Flow through a valve against quadrature and an independent integrator."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from softid.kernels import valve
from softid.kernels.valve import LAMINAR_ABOVE, MAX_SWITCHES, valve_flow


def behind(
    time_s: np.ndarray, supply: np.ndarray, tau_s: float, b: float, ratio: float = 1.0
) -> np.ndarray:
    values = np.array(supply)
    valve_flow(np.diff(time_s), values, tau_s, b, ratio, 1e-9 * np.ptp(supply))
    return values


def psi(ratio: float, b: float) -> float:
    """The flow function of the standard, without its laminar part."""
    return 1.0 if ratio <= b else float(np.sqrt(1.0 - ((ratio - b) / (1.0 - b)) ** 2))


def rate(supply: float, actuator: float, tau_s: float, b: float, ratio: float) -> float:
    """ṗa of the standard, whose flow function goes straight to zero where the flow is laminar."""
    high, low = max(supply, actuator), min(supply, actuator)
    r = low / high
    laminar = psi(LAMINAR_ABOVE, b) * (1.0 - r) / (1.0 - LAMINAR_ABOVE)
    flow = high * (laminar if r > LAMINAR_ABOVE else psi(r, b))
    return flow / tau_s if supply > actuator else -flow / (tau_s * ratio)


@pytest.mark.parametrize("b", [0.2, 0.5])
def test_filling_time_by_quadrature(b: float) -> None:
    """From p1 to p the filling takes ∫ τ dp/(ps ψ(p/ps)) at a constant supply ps.

    The first part is choked; the last is compared up to the laminar range. Tolerance 1e-6 of τ.
    """
    low, high, tau = 100.0, 700.0, 0.3
    time_s = np.concatenate(([0.0, 1.0, 1.0 + 1e-9], np.linspace(1.01, 1.6, 60)))
    found = behind(time_s, np.where(time_s > 1.0, high, low), tau, b)
    for t, p in zip(time_s[3:], found[3:], strict=True):
        if p / high > 0.998:
            break
        points = [b * high] if low < b * high < p else None
        needed, _ = quad(lambda a: tau / (high * psi(a / high, b)), low, p, points=points)
        assert needed == pytest.approx(t - 1.0, abs=1e-6 * tau)
    assert p / high > 0.998


def test_choked_venting_is_exponential() -> None:
    """ṗa = −pa/τ until the ratio reaches b: 900 kPa into 100 kPa, b = 0.4, until 250 kPa."""
    time_s = np.concatenate(([0.0, 1.0, 1.0 + 1e-9], np.linspace(1.05, 1.3, 26)))
    found = behind(time_s, np.where(time_s > 1.0, 100.0, 900.0), 0.2, 0.4)
    expected = 900.0 * np.exp(-(time_s - 1.0) / 0.2)
    choked = (time_s > 1.0) & (expected > 255.0)
    assert choked.sum() > 20
    np.testing.assert_allclose(found[choked], expected[choked], rtol=0.0, atol=1e-5)


@pytest.mark.parametrize("ratio", [1.0, 0.4, 3.0])
@pytest.mark.parametrize("tau_s", [0.01, 0.1, 1.0, 10.0])
def test_any_profile_against_lsoda(tau_s: float, ratio: float) -> None:
    """Steps and ramps both ways, within 1e-6 of the span (1e-5 is asked for)."""
    corners_s = np.array([0.0, 0.2, 0.21, 1.0, 1.02, 2.0, 3.0])
    time_s = np.linspace(0.0, 3.0, 901)
    supply = np.interp(time_s, corners_s, [101.0, 101.0, 300.0, 300.0, 150.0, 150.0, 260.0])
    found = behind(time_s, supply, tau_s, 0.3, ratio)
    expected, reached = np.full(time_s.size, 101.0), 101.0
    for begin, end in pairwise(corners_s):
        inside = (time_s > begin + 1e-9) & (time_s <= end + 1e-9)
        solved = solve_ivp(
            lambda t, a: rate(np.interp(t, time_s, supply), a[0], tau_s, 0.3, ratio),
            (begin, end), [reached], method="LSODA", rtol=1e-10, atol=1e-9, max_step=0.01,
            t_eval=np.minimum(time_s[inside], end),
        )  # fmt: skip
        expected[inside] = solved.y[0]
        reached = solved.y[0, -1]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-6 * 199.0)


@pytest.mark.parametrize("tau_s", [1e-9, 1e-6])
def test_a_wide_valve_is_none(tau_s: float) -> None:
    """The laminar lag is τ/53: what is left is the slope of the supply times it."""
    time_s = np.linspace(0.0, 3.0, 301)
    supply = 200.0 + 90.0 * np.sin(9.0 * time_s) + np.random.default_rng(2).normal(0, 0.3, 301)
    steepest = np.max(np.abs(np.diff(supply))) / 0.01
    off = np.max(np.abs(behind(time_s, supply, tau_s, 0.3) - supply))
    assert off < steepest * tau_s / 40.0 + 1e-9


def test_it_is_smooth_in_its_parameter() -> None:
    """Forward and central differences agree though the steps are adaptive, within 1e-3.

    Noise in the supply lets the flow turn laminar and turbulent hundreds of times.
    """
    rng = np.random.default_rng(4)
    time_s = np.linspace(0.0, 5.0, 4001)
    held = np.interp(time_s, [0.0, 0.5, 0.51, 2.5, 2.52, 5.0], [101.0, 101.0, 300, 300, 150, 240])
    samples = rng.normal(0.0, 0.3, 501)
    supply = held + np.interp(time_s, np.linspace(0.0, 5.0, 501), samples)
    forward = (
        behind(time_s, supply, 0.1 * (1 + 1e-6), 0.3) - behind(time_s, supply, 0.1, 0.3)
    ) / 1e-6
    ends = [behind(time_s, supply, 0.1 * (1.0 + sign * 1e-4), 0.3) for sign in (1.0, -1.0)]
    central = (ends[0] - ends[1]) / 2e-4
    np.testing.assert_allclose(forward, central, rtol=0.0, atol=2e-3 * np.max(np.abs(central)))


@pytest.mark.parametrize("omega", [15.0, 25.0, 40.0])
@pytest.mark.parametrize("tau_s", [0.5, 1.5])
def test_passing_through_the_laminar_range_leaves_no_trace(tau_s: float, omega: float) -> None:
    """A supply that swings passes the actuator's pressure hundreds of times, within one step each.

    Critical ratios that differ by rounding must give pressures that do, by 1e-9 of the span: an
    instant that rounding hid left one of them 1e-5 to 1e-3 off for long after.
    """
    corners_s = np.arange(0.0, 20.0, 0.01)
    supply = 250.0 + 120.0 * np.sin(omega * corners_s) + 50.0 * np.sin(2.3 * corners_s)
    time_s = np.arange(0.0, 19.99, 0.01 / 16)
    fine = np.interp(time_s, corners_s, supply)
    for b in np.linspace(0.15, 0.5, 8).tolist():
        here = behind(time_s, fine, tau_s, b)
        for k in range(1, 6):
            there = behind(time_s, fine, tau_s, b * (1.0 + k * 1e-11))
            np.testing.assert_allclose(there, here, rtol=0.0, atol=1e-9 * np.ptp(fine))


@pytest.mark.parametrize("tau_s", [0.01, 0.3, 3.0])
def test_values_along_a_straight_supply_cost_no_accuracy(tau_s: float) -> None:
    """Sixteen values on each line of a bent supply against its corners alone, to 1e-7 of the span.

    Between the ends of a step its interpolant is of order four; jumps within microseconds, along
    which times are known to a millionth only, are lines, too.
    """
    rng = np.random.default_rng(8)
    corners_s = np.sort(np.concatenate((np.arange(0.0, 40.0, 0.05), np.arange(2.0, 40.0, 5.0))))
    corners_s[np.searchsorted(corners_s, np.arange(2.0, 40.0, 5.0))] -= 1e-5
    level = 101.0 + 200.0 * (np.floor((corners_s + 2e-6) / 5.0 + 0.6) % 2)
    supply = level + rng.normal(0.0, 0.3, corners_s.size)
    shares = np.arange(1, 17) / 16.0
    time_s = np.concatenate(
        (corners_s[:1], *(a + (b - a) * shares for a, b in pairwise(corners_s)))
    )
    fine = np.concatenate((supply[:1], *(a + (b - a) * shares for a, b in pairwise(supply))))
    coarse = behind(corners_s, supply, tau_s, 0.3)
    np.testing.assert_allclose(behind(time_s, fine, tau_s, 0.3)[::16], coarse, atol=2e-5, rtol=0.0)
    between = behind(time_s[::4], fine[::4], tau_s, 0.3)
    np.testing.assert_allclose(behind(time_s, fine, tau_s, 0.3)[::4], between, atol=2e-5, rtol=0.0)


def at_the_border(
    rng: np.random.Generator, tau_s: float, b: float, p: float
) -> tuple[float, float]:
    """A supply and the time in which it gets there, so fast that the flow is just about laminar."""
    laminar_per_s = 1.0 / valve._laminar_time(tau_s, b)
    off = 1.0 + 10.0 ** rng.uniform(-16.0, -1.0) * rng.choice([-1.0, 1.0])
    slope = 1e-3 * p * laminar_per_s * off
    reached = p * 10.0 ** rng.uniform(-1.0, 1.0)
    return reached, abs(reached - p) / slope


@pytest.mark.parametrize("kind", ["wide", "narrow", "border"])
def test_the_flow_turns_three_times_at_most(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two straight pieces of a supply with any valve, 700 draws: far fewer turns than are allowed,
    so no flow is ever followed in the range that it has left."""
    turns: list[int] = []
    locate = valve._crossing
    monkeypatch.setattr(valve, "_crossing", lambda *at: turns.append(1) or locate(*at))
    rng, most = np.random.default_rng(7), 0
    for _ in range(700):
        tau_s, b = 10.0 ** rng.uniform(-4.0, 1.5), rng.uniform(0.1, 0.528)
        ratio = 10.0 ** rng.uniform(-1.3, 1.3)
        spread = 1.0 if kind == "wide" else 10.0 ** rng.uniform(-6.0, -2.0)
        supply = 10.0 ** rng.uniform(0.0, 3.3) * 10.0 ** (spread * rng.uniform(-1.0, 1.0, 3))
        step_s = 10.0 ** rng.uniform(-5.0, 2.0, 2) * tau_s
        if kind == "border":
            supply[2], step_s[1] = at_the_border(rng, tau_s, b, supply[1])
            step_s[1] /= rng.choice([1.0, ratio])
        turns.clear()
        valve_flow.py_func(step_s, supply, tau_s, b, ratio, 1e-8 * np.ptp(supply))
        assert np.isfinite(supply).all()
        most = max(most, len(turns))
    assert 2 <= most <= 3 < MAX_SWITCHES
