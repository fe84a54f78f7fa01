"""Quadratic damping: a body that is pushed steadily comes to its terminal speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from textbook_effects import oscillation, round_scale, segment

from softid.effects.quadratic_damping import PowerDamping, QuadraticDamping
from softid.kernels.terms import FORCE
from softid.models.oscillator import Oscillator


@pytest.mark.parametrize("push", [3.0, -3.0])
def test_fall_to_terminal_speed(push: float) -> None:
    """M v' = F − d2 v|v| from rest: x = ± (M/d2) ln cosh(t √(F d2)/M), to 1e-5 of the way."""
    mass, drag = 0.5, 2.0
    time_s = np.arange(200) * 0.01
    found = oscillation(
        QuadraticDamping(), {"d2": drag}, segment(time_s, np.full(200, push)), (mass, 0.0, 0.0),
        start=(0.0, 0.0), model=Oscillator(spring="none"),
    )  # fmt: skip
    expected = mass / drag * np.log(np.cosh(time_s * np.sqrt(abs(push) * drag) / mass))
    np.testing.assert_allclose(found, np.sign(push) * expected, atol=1e-5 * expected[-1])


@pytest.mark.parametrize(
    ("force_unit", "unit"), [("kPa", "kPa·s²/rad²"), ("N·m", "N·m·s²/rad²"), ("1", "s²/rad²")]
)
def test_a_force_without_a_unit_is_no_factor(force_unit: str, unit: str) -> None:
    """A muscle's equation is divided by its force, and its own parameters have no 1· either."""
    scale = replace(round_scale(), force_unit=force_unit, x_unit="rad")
    for law in (QuadraticDamping(), PowerDamping()):
        assert law.parameters(scale)["d2"].unit == unit


@pytest.mark.parametrize("power", [1.5, 3.0, 4.0])
def test_fall_of_a_free_body_in_a_power_law(power: float) -> None:
    """M v' = −D v^n from v0 gives v^(1−n) = v0^(1−n) + (n − 1) D t/M, and x by its integral.

    With D = d2 vm^(2−n) and nothing else that acts; to 1e-4 of the way, for the law bends into a
    line below a thousandth of vm.
    """
    mass, drag, v0, vm = 0.5, 2.0, 1.3, round_scale().v_max
    time_s = np.arange(200) * 0.01
    found = oscillation(
        PowerDamping(), {"d2": drag, "n": power}, segment(time_s, np.zeros(200)), (mass, 0.0, 0.0),
        start=(0.0, v0), model=Oscillator(spring="none"),
    )  # fmt: skip
    factor = (power - 1.0) * drag * vm ** (2.0 - power) / mass
    end = (2.0 - power) / (1.0 - power)
    grown = v0 ** (1.0 - power) + factor * time_s
    expected = (grown**end - grown[0] ** end) / (factor * end)
    np.testing.assert_allclose(found, expected, atol=1e-4 * expected[-1])


def test_at_the_exponent_of_two_it_is_the_square() -> None:
    """The plain form's law, to the smoothing's 1e-6 of the force at the largest speed."""
    scale = round_scale()
    eta = np.array([0.7, 2.0, *PowerDamping().constants(scale)])
    for v in np.linspace(-scale.v_max, scale.v_max, 41):
        power, square = np.zeros(6), np.zeros(6)
        PowerDamping.step(0.0, v, 0.0, 0.0, 0.0, eta, power)
        QuadraticDamping.step(0.0, v, 0.0, 0.0, 0.0, eta, square)
        assert power[FORCE] == pytest.approx(square[FORCE], abs=1e-6 * 0.7 * scale.v_max**2)
