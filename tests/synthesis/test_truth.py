"""The true response against closed forms that no solver is needed for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from softid.errors import InputError
from softid.synthesis.laws import muscle_motion, oscillator_motion
from softid.synthesis.truth import STIFF_PER_S, Valve, integrate
from softid.synthesis.waveforms import Hold, Sequence, Sine, Steps, Triangle

MUSCLE = {"M": 0.003, "a1": 0.0143, "b1": 3.0, "c1": 0.95, "a2": 0.0015, "b2": 2.0, "c2": 0.28}
TIGHT = 1e-8  # in mm, kPa or rad: a million times below the noise of any sensor
NONE = np.random.default_rng(0)


def sampled(waveform, rate_hz=200.0, **options):
    pieces = waveform.pieces(0.0, NONE)
    count = int(pieces[-1].stop_s * rate_hz + 1e-9) + 1
    times = np.minimum(np.arange(count) / rate_hz, pieces[-1].stop_s)
    return integrate(pieces, times, **options)


def muscle_step(values, levels_kpa, times):
    """Exact x and v of Ru Eq 7 after a jump: at constant pressure a 2 × 2 matrix exponential."""
    before, after = (pressure_kpa / 100.0 for pressure_kpa in levels_kpa)
    push = np.exp(values["b1"] * after)
    stiffness = values["a1"] * push + values["c1"]
    damping = values["a2"] * np.exp(values["b2"] * after) + values["c2"]
    matrix = np.array([[0.0, 1.0], [-stiffness, -damping]])
    matrix[1] /= values["M"]
    start = np.array([1.0 / (values["a1"] + values["c1"] * np.exp(-values["b1"] * before)), 0.0])
    rest = np.array([push / stiffness, 0.0])
    return start, np.array([rest + expm(matrix * t) @ (start - rest) for t in times])


def test_the_valve_is_a_first_order_lag() -> None:
    """p = p1 + (p0 − p1)·e^(−t/τ) after a jump of the command; another τ when it vents."""
    truth = sampled(
        Steps((0.0, 100.0, 20.0), 0.5), motion=None, valve=Valve(0.04, vent_time_constant_s=0.1)
    )
    t = truth.time_s
    up, down = (t >= 0.5) & (t < 1.0), t >= 1.0
    filled = 100.0 * (1.0 - np.exp(-(t[up] - 0.5) / 0.04))
    end = 100.0 * (1.0 - np.exp(-0.5 / 0.04))
    vented = 20.0 + (end - 20.0) * np.exp(-(t[down] - 1.0) / 0.1)
    assert np.abs(truth.pressure_kpa[up] - filled).max() < TIGHT
    assert np.abs(truth.pressure_kpa[down] - vented).max() < TIGHT
    assert set(truth.command_kpa) == {0.0, 100.0, 20.0}
    assert truth.position is None


@pytest.mark.parametrize("levels", [(0.0, 60.0), (100.0, 140.0), (140.0, 0.0), (250.0, 300.0)])
def test_muscle_step_follows_the_matrix_exponential(levels: tuple[float, float]) -> None:
    """At constant pressure Ru's law is linear, so a step without valve has a closed form."""
    truth = sampled(Steps(levels, 0.8), motion=muscle_motion(MUSCLE), valve=None)
    after = truth.time_s >= 0.8
    start, exact = muscle_step(MUSCLE, levels, truth.time_s[after] - 0.8)
    assert np.abs(truth.position[after] - exact[:, 0]).max() < TIGHT
    assert np.abs(truth.velocity[after] - exact[:, 1]).max() < 1e2 * TIGHT
    assert np.abs(truth.position[~after] - start[0]).max() < TIGHT  # at rest until the jump


def test_a_stiff_muscle_follows_the_matrix_exponential() -> None:
    """With a thousandth of the inertia the implicit solver takes over and stays as exact."""
    values = {**MUSCLE, "M": 3e-6}
    assert (values["a2"] + values["c2"]) / values["M"] > STIFF_PER_S
    truth = sampled(Steps((50.0, 150.0), 0.8), motion=muscle_motion(values), valve=None)
    after = truth.time_s >= 0.8
    _, exact = muscle_step(values, (50.0, 150.0), truth.time_s[after] - 0.8)
    assert np.abs(truth.position[after] - exact[:, 0]).max() < TIGHT


def test_oscillator_step_is_the_textbook_response() -> None:
    """x = x∞·(1 − e^(−ζωt)·(cos ω_d t + ζω/ω_d·sin ω_d t)), ω² = Q/M, ζ = N/(2√(QM))."""
    values = {"M": 0.7, "N": 3.5, "Q": 60.0, "G": 2.0, "offset": 10.0}
    truth = sampled(
        Sequence((Hold(10.0, 0.3), Hold(40.0, 2.0))), motion=oscillator_motion(values), valve=None
    )
    t = truth.time_s[truth.time_s >= 0.3] - 0.3
    omega = np.sqrt(60.0 / 0.7)
    decay = 3.5 / (2 * 0.7)
    damped = np.sqrt(omega**2 - decay**2)
    envelope = np.exp(-decay * t)
    exact = 1.0 - envelope * (np.cos(damped * t) + decay / damped * np.sin(damped * t))
    assert np.abs(truth.position[truth.time_s >= 0.3] - exact).max() < TIGHT


def test_sine_agrees_with_steps_of_a_millisecond_at_most() -> None:
    """No closed form: another tolerance (1e-13) and at least 12 kHz of evaluations must agree."""
    motion, valve = muscle_motion(MUSCLE), Valve(0.04)
    sine = Sine(0.0, 240.0, 0.5, 2.0)
    usual = sampled(sine, motion=motion, valve=valve)
    fine = sampled(sine, motion=motion, valve=valve, tolerance=1e-13, longest_step_s=1e-3)
    assert np.abs(usual.position - fine.position).max() < TIGHT


def test_half_hertz_lags_visibly() -> None:
    """The assumed muscle must show its dynamics: 15° to 40° of lag at 0.5 Hz, 2.4 bar peak."""
    truth = sampled(Sine(0.0, 240.0, 0.5, 6.0), motion=muscle_motion(MUSCLE), valve=Valve(0.04))
    kept = (truth.time_s >= 4.0) & (truth.time_s < 12.0)
    carrier = np.exp(-1j * np.pi * truth.time_s[kept])
    phase = [np.angle(np.sum(y[kept] * carrier)) for y in (truth.pressure_kpa, truth.position)]
    assert 15.0 < np.degrees(phase[0] - phase[1]) < 40.0


def test_terms_add_up() -> None:
    """A further force enters the truth by being named: a constant load moves the rest by F/Q."""
    motion = oscillator_motion({"M": 1.0, "N": 20.0, "Q": 100.0, "G": 1.0, "offset": 0.0})

    def load(time_s: float, pressure_kpa: float, x: float, v: float) -> float:
        return -5.0

    loaded = replace(motion, terms={**motion.terms, "load": load})
    truth = sampled(Hold(30.0, 5.0), motion=loaded, valve=None)
    assert truth.position[-1] == pytest.approx(0.25, abs=1e-9)


def test_overflowing_forces_are_an_input_error() -> None:
    """Pressure in Pa where kPa is meant: e^(b1 p) overflows, and the remedy names the unit."""
    motion = muscle_motion({**MUSCLE, "b1": 900.0})
    with pytest.raises(InputError, match=r"overflow.*kPa"):
        sampled(Triangle(0.0, 200.0, 1.0, 1), motion=motion, valve=Valve(0.04))
