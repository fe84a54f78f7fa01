"""Coulomb friction: amplitudes that fall by equal amounts, sticking, and the Stribeck form."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import MODEL, TRUTH, linear_angle, linear_log, linear_problem
from scipy.interpolate import CubicSpline
from textbook_effects import oscillation, round_scale, segment

from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.effects import ExtendedModel
from softid.effects.coulomb_friction import (
    SHARPEST,
    CoulombFriction,
    PressureFriction,
    StribeckFriction,
)
from softid.kernels.terms import FORCE
from softid.log import Log
from softid.simulation import simulate


def force(effect: CoulombFriction, v: float, eta: list[float], *, u: float = 0.0) -> float:
    """Friction at a speed and an input, by the effect's own step."""
    out = np.zeros(6)
    effect.step(0.0, v, 0.0, u, 0.0, np.array(eta), out)
    return float(out[FORCE])


def free_decay(friction: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Times, positions and half period of a spring and a mass let go at 0.5."""
    mass, spring = 0.02, 2.0
    half_s = np.pi * np.sqrt(mass / spring)
    time_s = np.linspace(0.0, 8 * half_s, 641)
    values = {"Fc": friction, "vs": 2e-3}
    drive = segment(time_s, np.zeros(641))
    found = oscillation(CoulombFriction(), values, drive, (mass, 0.0, spring), start=(0.5, 0.0))
    return time_s, found, half_s


def test_amplitude_falls_by_equal_amounts() -> None:
    """After each half period the turning point is closer by 2 Fc/Q, to 1e-3 of the first.

    Textbook solution of M x'' + Fc sign(x') + Q x = 0; vs is 1/2500 of the largest speed.
    """
    _, x, _ = free_decay(0.08)
    turns = x[::80][:6]
    expected = [(-1) ** n * (0.5 - n * 0.08) for n in range(6)]
    np.testing.assert_allclose(turns, expected, atol=1e-3 * 0.5)


def test_it_sticks() -> None:
    """Once |Q x| < Fc at a turn nothing moves but by x' = −vs artanh(Q x/Fc), to 1e-6."""
    time_s, x, half_s = free_decay(0.35)
    late = time_s > 2.2 * half_s
    rest = x[late]
    assert abs(rest[0]) * 2.0 < 0.35
    creeping = -2e-3 * np.arctanh(2.0 * rest / 0.35)
    np.testing.assert_allclose(np.gradient(rest, time_s[late])[1:-1], creeping[1:-1], atol=1e-5)


def test_stribeck_is_larger_slowly_and_the_same_fast() -> None:
    """Fc (1 + β) between vs and vb, Fc far above vb, and Fc tanh(v/vs) at β = 0."""
    stribeck, plain = StribeckFriction(), CoulombFriction()
    eta = [2.0, 1e-4, 0.5, 0.1]
    assert abs(force(stribeck, 1e-3, eta) - 3.0) < 1e-3
    assert abs(force(stribeck, -1.0, eta) + 2.0) < 1e-9
    for v in (-0.2, 1e-4, 0.05):
        assert force(stribeck, v, [2.0, 1e-4, 0.0, 0.1]) == force(plain, v, eta[:2])


def test_friction_grows_with_the_pressure() -> None:
    """Fc (1 + k |u|) beyond vs, for pressure and vacuum, and Fc tanh(v/vs) without either."""
    pressed, plain = PressureFriction(), CoulombFriction()
    eta = [2.0, 1e-4, 0.01]
    assert abs(force(pressed, 1.0, eta, u=150.0) - 5.0) < 1e-9
    assert abs(force(pressed, -1.0, eta, u=-50.0) + 3.0) < 1e-9
    for v in (-0.2, 1e-4, 0.05):
        assert force(pressed, v, eta) == force(plain, v, eta[:2])


def test_sharp_friction_asks_for_small_steps() -> None:
    """The rate grows as vs falls, and stops where the friction is a jump for any step."""
    scale, effect = round_scale(), CoulombFriction()
    rates = [effect.rate(np.array([0.1, vs]), scale) for vs in (0.6, 0.1, 0.01, 1e-3, 1e-5)]
    assert rates == sorted(rates)
    assert rates[-1] == rates[-2]
    assert effect.rate(np.array([0.0, 1e-3]), scale) == 0.0


@pytest.mark.parametrize("share", [0.03, 0.2])
def test_a_jump_of_the_friction_is_found_by_the_steps(
    share: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside steps 40 times as fine: 1e-4 of the range at most, and 2e-5 rms, at the sharpest."""
    log = linear_log()
    problem = linear_problem([log])
    scale = scale_of(problem, problem.unknowns(TRUTH))
    model = ExtendedModel(MODEL, (CoulombFriction(),), scale)
    friction = {
        "coulomb_friction_Fc": share * scale.force,
        "coulomb_friction_vs": scale.v_max / SHARPEST,
    }
    values = model.parameters().values_dict() | TRUTH | friction
    usual = simulate(model, values, log).outputs["angle"]
    rate = CoulombFriction.rate
    monkeypatch.setattr(CoulombFriction, "rate", lambda *given: 40.0 * rate(*given))
    error = (simulate(model, values, log).outputs["angle"] - usual) / scale.x_span
    assert 0.0 < np.abs(error).max() < 1e-4
    assert np.sqrt(np.mean(error**2)) < 2e-5


def test_a_drive_that_turns_round_within_a_sample_is_followed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A mass on a weak spring under a chirp, whose speed passes ±vs within a sampling interval.

    Beside steps 40 times as fine: 1e-6 of the range. Steps that go by how fast the motion crosses
    its range, which is slow without a stiff spring, are too long for that.
    """
    time_s = np.arange(2500) * 0.02
    pressure = 60.0 * np.sin(2.0 * np.pi * (0.1 + 0.014 * time_s) * time_s)
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": np.sin(time_s)})
    mass = {"M": 4e-3, "N": 0.02, "Q": 2.5e-3}
    problem = linear_problem([log])
    scale = scale_of(problem, problem.unknowns(mass))
    model = ExtendedModel(MODEL, (StribeckFriction(),), scale)
    friction = {"Fc": 12.0, "vs": 0.02 * scale.v_max, "beta": 1.0, "vb": 0.3 * scale.v_max}
    values = model.parameters().values_dict() | mass
    values |= {f"coulomb_friction_{name}": value for name, value in friction.items()}
    usual = simulate(model, values, log).outputs["angle"]
    rate = StribeckFriction.rate
    monkeypatch.setattr(StribeckFriction, "rate", lambda *given: 40.0 * rate(*given))
    error = simulate(model, values, log).outputs["angle"] - usual
    assert 0.0 < np.abs(error).max() < 1e-6 * np.ptp(usual)


def test_jerks_of_the_sharpest_friction_are_simulated() -> None:
    """Friction that is larger by two thirds where the motion sticks, and where it breaks away."""
    time_s = np.arange(1000) / 50.0
    knob = np.random.default_rng(0).uniform(0.0, 100.0, 20)
    pressure = np.clip(CubicSpline(np.arange(20.0) * 1.25, knob)(time_s), 0.0, 100.0)
    angle = linear_angle(time_s, pressure)
    log = Log.from_arrays(time_s, {"pressure": pressure, "angle": angle})
    problem = linear_problem([log])
    scale = scale_of(problem, problem.unknowns(TRUTH))
    model = ExtendedModel(MODEL, (StribeckFriction(),), scale)
    sharpest = {"Fc": 0.2 * scale.force, "vs": scale.v_max / SHARPEST}
    jerky = {"beta": 0.63, "vb": 0.01 * scale.v_max}
    values = {f"coulomb_friction_{name}": value for name, value in (sharpest | jerky).items()}
    found = simulate(model, model.parameters().values_dict() | TRUTH | values, log)
    late = found.outputs["angle"] - angle
    assert np.all(np.isfinite(late))
    assert 0.01 < np.ptp(late) / scale.x_span < 1.0
