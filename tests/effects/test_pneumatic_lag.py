"""Lag of the pneumatics, with one time constant and with two."""

from __future__ import annotations

import numpy as np
import pytest
from muscle_rig import (
    SCALE,
    extended,
    fine_times,
    jacobian_error,
    pressure,
    response,
    segment,
)
from scipy.special import exp1, expi

from softid.effects.pneumatic_lag import LevelPneumaticLag, PneumaticLag, SeparatePneumaticLag


def test_a_step_and_a_ramp() -> None:
    """1 − e^{−t/τ}, and t − τ (1 − e^{−t/τ}), at irregular times, to 1e-9."""
    time_s = np.concatenate(([-1.0, -1e-12], fine_times()))
    since_s = np.maximum(time_s, 0.0)
    eta = np.array([0.3])
    step = PneumaticLag().apply(eta, time_s, np.where(time_s < 0.0, 0.0, 1.0), SCALE)
    np.testing.assert_allclose(step[2:], -np.expm1(-since_s[2:] / 0.3), rtol=0.0, atol=1e-9)
    ramp = PneumaticLag().apply(eta, time_s, since_s, SCALE)
    expected = since_s + 0.3 * np.expm1(-since_s / 0.3)
    np.testing.assert_allclose(ramp, expected, rtol=0.0, atol=1e-9)


def test_filling_and_venting_differ() -> None:
    """Half of a step is passed after τ ln 2 of its own direction, to a time of 2 ms."""
    time_s = fine_times()
    u = np.where((time_s > 1.0) & (time_s < 7.0), 100.0, 0.0)
    found = SeparatePneumaticLag().apply(np.array([0.4, 2.0]), time_s, u, SCALE)
    up_s = time_s[np.flatnonzero(found > 50.0)[0]] - 1.0
    down_s = time_s[np.flatnonzero((time_s > 7.0) & (found < 50.0))[0]] - 7.0
    assert up_s == pytest.approx(0.4 * np.log(2.0), abs=0.004)
    assert down_s == pytest.approx(0.8 * np.log(2.0), abs=0.004)


def test_a_supply_that_sags_while_it_fills_is_such_a_lag() -> None:
    """T ṗa + s T max(ṗa, 0) + pa = p by small Euler steps, within 1e-3 of the range."""
    recovers_s, sags, step_s = 0.4, 0.5, 1e-4
    time_s = np.arange(0.0, 3.0, step_s)
    u = np.interp(time_s, [0.0, 0.5, 0.6, 1.5, 1.7, 3.0], [0.0, 0.0, 80.0, 100.0, 10.0, 60.0])
    inside = np.zeros(u.size)
    for k in range(u.size - 1):
        behind = u[k] - inside[k]
        slowed = 1.0 + sags if behind > 0.0 else 1.0
        inside[k + 1] = inside[k] + step_s * behind / (slowed * recovers_s)
    eta = np.array([(1.0 + sags) * recovers_s, 1.0 / (1.0 + sags)])
    found = SeparatePneumaticLag().apply(eta, time_s, u, SCALE)
    np.testing.assert_allclose(found, inside, rtol=0.0, atol=0.1)


def test_a_ratio_of_one_is_the_plain_lag() -> None:
    """The richer law holds the plain one, to rounding."""
    time_s = fine_times()
    u = pressure(time_s)
    plain = PneumaticLag().apply(np.array([0.1]), time_s, u, SCALE)
    found = SeparatePneumaticLag().apply(np.array([0.1, 1.0]), time_s, u, SCALE)
    np.testing.assert_allclose(found, plain, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("ratio", [0.3, 4.0])
@pytest.mark.parametrize("size", [40.0, 120.0])
def test_a_step_into_a_chamber_that_swells(ratio: float, size: float) -> None:
    """Behind a step to U a pressure p is reached at ∫ τ e^{gq}/(U − q) dq from 0 to p.

    It is τ e^{gU} [E(g (U − p)) − E(gU)] with g = ln ρ/(p_h − p_l) and E the exponential integral,
    E1(z) or −Ei(−z) for a negative z; τ = 0.3 s holds at no pressure, √ρ times that in the middle.
    To 0.2 µs at times 1 ms apart, by an integrator of order 3.
    """
    middle, growth = 0.3 * np.sqrt(ratio), np.log(ratio) / SCALE.u_span
    time_s = np.arange(0.0, 1.5, 1e-3)
    u = np.full(time_s.size, size)
    u[0] = 0.0
    found = LevelPneumaticLag().apply(np.array([middle, ratio]), time_s, u, SCALE)
    rising = (time_s > 0.0) & (found < 0.99 * size)
    to_go = exp_integral(growth * (size - found[rising]))
    reached_s = 0.3 * np.exp(growth * size) * to_go
    passed_s = time_s[rising]
    np.testing.assert_allclose(reached_s - reached_s[0], passed_s - passed_s[0], atol=2e-7)


def exp_integral(z: np.ndarray) -> np.ndarray:
    """E1(z), continued to negative z as −Ei(−z)."""
    return exp1(z) if z[0] > 0.0 else -expi(-z)


def test_a_lag_of_one_level_is_the_plain_one() -> None:
    """At a ratio of one, to rounding; whatever the ratio, a lag of zero is none."""
    time_s = fine_times()
    u = pressure(time_s)
    plain = PneumaticLag().apply(np.array([0.1]), time_s, u, SCALE)
    found = LevelPneumaticLag().apply(np.array([0.1, 1.0]), time_s, u, SCALE)
    np.testing.assert_allclose(found, plain, rtol=0.0, atol=1e-10)


def test_two_input_effects_follow_each_other() -> None:
    """Delay and lag commute: lagging the delayed input is delaying the lagged one."""
    model, theta = extended("delay", "pneumatic_lag")
    other, by_other = extended("pneumatic_lag", "delay")
    assert list(other.parameters())[-2:] == ["pneumatic_lag_tau", "delay_tau"]
    assert list(model.parameters())[-2:] == ["delay_tau", "pneumatic_lag_tau"]
    s = segment("irregular")
    found = response(model, theta, s)
    np.testing.assert_allclose(
        found, response(other, by_other, s), rtol=0.0, atol=2e-4 * np.ptp(found)
    )
    assert jacobian_error(model, theta, segment()) < 1e-4
