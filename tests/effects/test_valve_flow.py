"""Flow through a valve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from muscle_rig import SCALE, fine_times, pressure

from softid.effects.valve_flow import SeparateValveFlow, ValveFlow


def test_choked_filling_is_straight() -> None:
    """ṗa = (p + 101.325 kPa)/τ as long as pa is below b of the supply, all absolute."""
    time_s = fine_times()
    u = np.where(time_s > 1.0, 500.0, 0.0)
    found = ValveFlow().apply(np.array([2.0, 0.5]), time_s, u, SCALE)
    begin = np.flatnonzero(time_s > 1.0)[0]
    choked = (time_s > 1.0) & (found + 101.325 < 0.5 * 601.325)
    expected = found[begin] + (time_s - time_s[begin]) * 601.325 / 2.0
    assert choked.sum() > 300
    np.testing.assert_allclose(found[choked], expected[choked], rtol=0.0, atol=1e-6)


def test_larger_steps_take_longer() -> None:
    """A lag takes the same time for any step; a choked valve does not."""
    time_s = fine_times()
    halves_s = []
    for size in (20.0, 200.0):
        u = np.where(time_s > 1.0, size, 0.0)
        found = ValveFlow().apply(np.array([1.0, 0.3]), time_s, u, SCALE)
        halves_s.append(time_s[np.flatnonzero(found > 0.5 * size)[0]] - 1.0)
    assert halves_s[1] > 1.5 * halves_s[0]


def test_venting_takes_its_own_time() -> None:
    """By the law: 500 kPa are filled as with τ, and vented as with ρ τ, both choked at first."""
    time_s = fine_times()
    for is_up in (True, False):
        u = np.where((time_s > 1.0) == is_up, 500.0, 0.0)
        found = SeparateValveFlow().apply(np.array([0.6, 0.3, 2.5]), time_s, u, SCALE)
        tau = 0.6 if is_up else 1.5
        alone = ValveFlow().apply(np.array([tau, 0.3]), time_s, u, SCALE)
        np.testing.assert_allclose(found, alone, rtol=0.0, atol=1e-6)


def test_an_input_that_is_no_pressure_in_kpa() -> None:
    """Its range counts as one to two atmospheres, so scaling it scales the result."""
    time_s = fine_times()
    eta = np.array([0.2, 0.3])
    found = []
    for size in (1.0, 8.0):
        other = replace(SCALE, u_low=0.0, u_high=size, u_unit="V")
        u = size / 150.0 * pressure(time_s)
        found.append(ValveFlow().apply(eta, time_s, u, other) / size)
    np.testing.assert_allclose(found[0], found[1], rtol=0.0, atol=1e-6)


def test_nothing_flows_out_of_a_vacuum() -> None:
    """Readings below a vacuum are cut at a hundredth of an atmosphere; all stays finite."""
    time_s = fine_times()
    u = np.where(time_s > 1.0, -150.0, 50.0)
    found = ValveFlow().apply(np.array([0.2, 0.3]), time_s, u, SCALE)
    assert found.min() == pytest.approx(0.01 * 101.325 - 101.325, abs=1e-3)
