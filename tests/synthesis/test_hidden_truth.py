"""The integrator of hidden effects against another solver, and its laws against closed forms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib import import_module
from math import exp, pi, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from softid.errors import InputError
from softid.synthesis import HIDDEN, Actuator, Rig, hidden_pair, hidden_truth
from softid.synthesis.hidden_base import Occasion, OutputLaw
from softid.synthesis.hidden_log import measured_sizes
from softid.synthesis.hidden_truth import HiddenTruth, chain_of, integrate_hidden
from softid.synthesis.waveforms import Hold, Rest, Sequence, Sweep, Waveform

QUICK = {"M": 1e-7, "N": 5e-4, "Q": 0.5, "G": 1.0, "offset": 0.0}
"""An oscillator that settles within milliseconds: 100 kPa hold it at 200 mm."""

SLOW = {"M": 1e-4, "N": 0.05, "Q": 0.5, "G": 1.0, "offset": 0.0}
QUIET = Rig(noise=0.0, pressure_noise_kpa=0.0, zero=0.0)


def response(
    names: str | tuple[str, ...],
    values: Mapping[str, float],
    command: Waveform,
    time_s: np.ndarray,
    *,
    actuator: Mapping[str, float] = QUICK,
    valve_s: float = 0.02,
) -> HiddenTruth:
    """The truth of an oscillator with one effect of given parameters."""
    names = (names,) if isinstance(names, str) else names
    moved = Actuator("oscillator", actuator)
    pieces = command.pieces(0.0, np.random.default_rng(0))
    sizes = measured_sizes(moved, pieces, replace(QUIET, valve_s=valve_s))
    occasion = Occasion(pieces[-1].stop_s, seed=1)
    laws = [HIDDEN[name].build(values, sizes, occasion) for name in names]
    return integrate_hidden(pieces, time_s, chain_of(moved.motion, valve_s, laws))


def step(to_kpa: float = 100.0, hold_s: float = 3.0) -> Sequence:
    return Sequence((Rest(1.0), Hold(to_kpa, hold_s)))


TIME_S = np.arange(0.0, 4.0, 0.01)
AFTER_S = np.maximum(TIME_S - 1.0, 0.0)


def lagged(time_s: np.ndarray, *tau: float) -> np.ndarray:
    """Unit step response of first-order lags in a row, all different."""
    weights = [t ** (len(tau) - 1) / np.prod([t - o for o in tau if o != t]) for t in tau]
    return 1.0 - sum(w * np.exp(-time_s / t) for w, t in zip(weights, tau, strict=True))


@pytest.mark.parametrize("names", [(name,) for name in HIDDEN] + [("delay", "creep", "sensor_lag")])
def test_another_solver_finds_the_same(
    names: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Within 1e-6 of the range of DOP853 at 1e-9, on either model in turn."""
    model = ("muscle", "oscillator")[list(HIDDEN).index(names[0]) % 2]
    plain = hidden_pair(names, seed=4, protocol="step", model=model, rig=QUIET)

    def solved(pieces, wanted_s, chain, tolerance):
        layout = hidden_truth._Layout(chain)
        state = hidden_truth._rest_state(pieces, chain, layout)
        found = np.empty((layout.count, wanted_s.size))
        end_s = max(pieces[-1].stop_s, wanted_s[-1]) + 1e-3
        for start_s, stop_s, *commands in hidden_truth._spans(pieces, chain.delay_s, end_s):
            rates = hidden_truth._rates(chain, layout, *commands)
            first, stop = np.searchsorted(wanted_s, (start_s - 1e-9, stop_s - 1e-9))
            times = np.append(np.maximum(wanted_s[first:stop], start_s), stop_s)
            done = solve_ivp(
                rates, (start_s, stop_s), state, "DOP853", times, rtol=1e-9, atol=1e-10,
                max_step=0.01,
            )  # fmt: skip
            assert done.success
            found[:, first:stop], state = done.y[:, :-1], done.y[:, -1]
        return found

    monkeypatch.setattr(hidden_truth, "_solve", solved)
    # One law holds the largest speed, which another solver finds a millionth larger.
    sizing = import_module("softid.synthesis.hidden_log")
    monkeypatch.setattr(sizing, "measured_sizes", lambda *args: plain.sizes)
    values = {name: dict(plain.hidden[name]) for name in names}
    other = hidden_pair(
        names, seed=4, protocol="step", rig=QUIET, actuator=plain.actuator, values=values
    )
    span = plain.sizes.x_span
    for mine, theirs in ((plain.train, other.train), (plain.hold_out, other.hold_out)):
        np.testing.assert_allclose(mine.truth.reading, theirs.truth.reading, atol=1e-6 * span)


def test_without_effects_the_valve_alone() -> None:
    """p = 1 − e^{−t/τ} after a step, x = p/Q once settled; the reading is the position."""
    found = response((), {}, step(), TIME_S)
    np.testing.assert_allclose(found.pressure_kpa, 100.0 * lagged(AFTER_S, 0.02), atol=1e-5)
    assert np.array_equal(found.pressure_kpa, found.arriving_kpa)
    assert found.position[-1] == pytest.approx(200.0, rel=1e-7)
    assert np.array_equal(found.reading, found.position)


def test_a_sensor_takes_in_the_pressure() -> None:
    """Of 100 kPa it makes 7 mm at once, whatever the actuator does by then."""
    found = response("pressure_pickup", {"gain": 0.07}, step(), TIME_S, actuator=SLOW)
    np.testing.assert_allclose(found.reading - found.position, 0.07 * found.pressure_kpa, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "values", "pull"),
    [
        ("saturating_spring", {"force": 30.0, "reach": 20.0}, lambda x: 30.0 * np.tanh(x / 20.0)),
        ("wavy_spring", {"force": 9.0, "period": 120.0}, lambda x: 9.0 * np.sin(2 * pi * x / 120)),
    ],
)
def test_a_spring_holds_up_the_pressure(
    name: str, values: dict[str, float], pull: Callable[[float], float]
) -> None:
    """Once settled Q x and the spring's own force carry the pressure; the rest is at x = 0."""
    found = response(name, values, step(), TIME_S)
    settled = float(found.position[-1])
    assert 0.5 * settled + pull(settled) == pytest.approx(100.0, rel=1e-5)


def test_a_part_of_the_tip_swings() -> None:
    """Of a step to 200 mm a quarter rings, 1 − e^{−ζωt} (cos ω_d t + ζω/ω_d sin ω_d t)."""
    values = {"share": 0.25, "period": 0.5, "zeta": 0.1}
    found = response("swinging_tip", values, step(), TIME_S, valve_s=1e-4)
    omega, zeta = 2.0 * pi / 0.5, 0.1
    turning = omega * sqrt(1.0 - zeta**2)
    angle = turning * AFTER_S
    ring = np.cos(angle) + zeta * omega / turning * np.sin(angle)
    swung = 1.0 - np.exp(-zeta * omega * AFTER_S) * ring
    late = TIME_S > 1.05
    told = 200.0 * (0.75 + 0.25 * swung)
    np.testing.assert_allclose(found.reading[late], told[late], atol=1.0)
    assert np.ptp(found.reading[late]) > 30.0


def test_delay_of_a_ramp() -> None:
    """A ramp of 50 kPa/s behind the valve, read τ later: s (t − τ − τv (1 − e^{−(t−τ)/τv}))."""
    found = response("delay", {"tau": 0.313}, Sweep(0.0, 200.0, 4.0), TIME_S)
    passed = np.maximum(TIME_S - 0.313, 0.0)
    expected = 50.0 * (passed - 0.02 * (1.0 - np.exp(-passed / 0.02)))
    np.testing.assert_allclose(found.arriving_kpa, expected, atol=1e-5)
    plain = response((), {}, Sweep(0.0, 200.0, 4.0), TIME_S)
    np.testing.assert_allclose(found.pressure_kpa, plain.pressure_kpa, atol=1e-5)


def test_lags_of_a_step() -> None:
    """The partial fractions of two and three different lags in a row."""
    one = response("pneumatic_lag", {"tau": 0.3}, step(), TIME_S)
    np.testing.assert_allclose(one.arriving_kpa, 100.0 * lagged(AFTER_S, 0.02, 0.3), atol=1e-5)
    two = response("two_lags", {"tau1": 0.3, "tau2": 0.1}, step(), TIME_S)
    expected = 100.0 * lagged(AFTER_S, 0.02, 0.3, 0.1)
    np.testing.assert_allclose(two.arriving_kpa, expected, atol=1e-5)
    sensor = response("sensor_lag", {"tau": 0.3}, step(), TIME_S, valve_s=0.05)
    # The actuator itself lags by N/Q = 1 ms; what M adds is a thousandth of that.
    expected = 200.0 * lagged(AFTER_S, 0.05, 0.3, 1e-3)
    np.testing.assert_allclose(sensor.reading, expected, atol=0.05)
    np.testing.assert_allclose(sensor.position, 200.0 * lagged(AFTER_S, 0.05, 1e-3), atol=0.1)


def test_filters_of_the_reading() -> None:
    """A resonance overshoots by e^{−πζ/√(1−ζ²)}; a moving average of a step is a ramp of its width.

    The actuator follows the step by 200 within milliseconds.
    """
    values = {"period": 0.4, "zeta": 0.2}
    rung = response("sensor_resonance", values, step(), TIME_S, valve_s=1e-3)
    overshoot = exp(-pi * 0.2 / sqrt(1.0 - 0.04))
    assert rung.reading.max() == pytest.approx(200.0 * (1.0 + overshoot), rel=2e-3)
    fine_s = np.arange(0.0, 3.0, 1e-3)
    mean = response("smoothing.past", {"width": 0.5}, step(), fine_s, valve_s=1e-3)
    expected = 200.0 * np.clip((fine_s - 1.0) / 0.5, 0.0, 1.0)
    np.testing.assert_allclose(mean.reading, expected, atol=2.0)


def test_venting_takes_its_own_time() -> None:
    """Filling with τ and venting with ratio·τ, each a lag behind the valve's."""
    command = Sequence((Hold(100.0, 1.0), Hold(0.0, 3.0)))
    values = {"tau": 0.1, "ratio": 4.0}
    found = response("pneumatic_lag.separate", values, command, TIME_S)
    expected = 100.0 - 100.0 * lagged(AFTER_S, 0.02, 0.4)
    np.testing.assert_allclose(found.arriving_kpa, expected, atol=1e-5)
    filling = response("pneumatic_lag.separate", values, step(), TIME_S)
    np.testing.assert_allclose(filling.arriving_kpa, 100 * lagged(AFTER_S, 0.02, 0.1), atol=1e-5)


def test_ringing_line() -> None:
    """Overshoot e^{−πζ/√(1−ζ²)} half a damped period after a step through a valve of 0.1 ms."""
    fine_s = np.arange(1.0, 2.0, 0.0005)
    values = {"period": 0.4, "zeta": 0.2}
    found = response("line_resonance", values, step(), fine_s, valve_s=1e-4)
    overshoot = exp(-pi * 0.2 / sqrt(1.0 - 0.04))
    assert found.arriving_kpa.max() == pytest.approx(100.0 * (1.0 + overshoot), rel=1e-4)
    peak_s = fine_s[np.argmax(found.arriving_kpa)] - 1.0
    assert peak_s == pytest.approx(0.2 / sqrt(1.0 - 0.04), abs=1e-3)


def test_choked_flow() -> None:
    """Below the critical ratio the pressure rises by the absolute supply in τ."""
    found = response("valve_flow", {"tau": 2.0, "b": 0.4}, step(400.0), TIME_S, valve_s=0.005)
    choked = (AFTER_S > 0.1) & (found.arriving_kpa + 101.325 < 0.4 * 501.325)
    rates = np.diff(found.arriving_kpa[choked]) / 0.01
    assert rates.size > 10
    np.testing.assert_allclose(rates, 501.325 / 2.0, rtol=1e-6)
    assert found.arriving_kpa[-1] < 400.0


def test_static_laws_of_the_input() -> None:
    """The dead zone's closed form at each sample; a relief leak holds its share once open."""
    found = response("dead_zone", {"p0": 30.0, "softness": 0.1}, step(), TIME_S)
    p = found.pressure_kpa
    expected = 3.0 * (np.logaddexp(0, (p - 30) / 3) - np.logaddexp(0, (-p - 30) / 3))
    np.testing.assert_allclose(found.arriving_kpa, expected, atol=1e-9)
    leak = {"opens": 80.0, "closes": 40.0, "lost": 0.2}
    open_kpa = response("relief_leak", leak, step(), TIME_S).arriving_kpa[-1]
    shut_kpa = response("relief_leak", leak, step(70.0), TIME_S).arriving_kpa[-1]
    assert open_kpa == pytest.approx(100.0 / 1.2, rel=5e-3)
    assert shut_kpa == pytest.approx(70.0, rel=5e-3)


def test_a_supply_gives_no_more_than_its_limit() -> None:
    """Below it what comes out of the valve arrives, and 40 kPa of 100 above it."""
    whole = response("supply_limit", {"top": 200.0}, step(), TIME_S).arriving_kpa
    limited = response("supply_limit", {"top": 40.0}, step(), TIME_S).arriving_kpa
    np.testing.assert_allclose(limited, np.minimum(whole, 40.0), atol=1e-6)
    assert whole[-1] == pytest.approx(100.0)


def test_rate_limit_and_backlash() -> None:
    """A straight rise at the limit; a band that stays open on either side."""
    found = response("rate_limit", {"limit": 60.0}, step(), TIME_S)
    rising = (AFTER_S > 0.2) & (found.arriving_kpa < 90.0)
    np.testing.assert_allclose(np.diff(found.arriving_kpa[rising]), 0.6, rtol=1e-6)
    command = Sequence((Hold(0.0, 1.0), Hold(100.0, 1.5), Hold(50.0, 1.5)))
    held = response("input_backlash", {"band": 5.0}, command, TIME_S).arriving_kpa
    assert held[240] == pytest.approx(95.0, abs=1e-6)
    assert held[-1] == pytest.approx(55.0, abs=1e-6)


def test_creep_relaxes() -> None:
    """x = F/Q (1 − k/(Q + k) e^{−t Q/(τ (Q + k))}) for a quick actuator behind a quick valve."""
    found = response("creep", {"k": 0.25, "tau": 0.8}, step(), TIME_S, valve_s=1e-3)
    slow = np.exp(-AFTER_S * 0.5 / (0.8 * 0.75))
    expected = 200.0 * (1.0 - slow * 0.25 / 0.75)
    settled = AFTER_S > 0.02
    np.testing.assert_allclose(found.position[settled], expected[settled], rtol=3e-3)


def test_balances_at_rest() -> None:
    """Static laws: Q x + f(x) = p for stiffening and contact, x shifted by the static curve."""
    k3 = 1e-6
    x = response("stiffening", {"k3": k3}, step(), TIME_S).position[-1]
    assert 0.5 * x + k3 * x**3 == pytest.approx(100.0, rel=1e-6)
    x = response("contact", {"kw": 0.5, "xw": 100.0}, step(), TIME_S).position[-1]
    assert 0.5 * x + 0.5 * (x - 100.0) == pytest.approx(100.0, rel=1e-6)
    knots = {f"k{i}": height for i, height in enumerate((-2.0, 5.0, 1.0, 0.0, -4.0), start=2)}
    found = response("static_curve", knots, step(), TIME_S)
    assert found.position[0] == pytest.approx(0.0, abs=1e-6)
    # The top of the recorded range of a valve that has not quite settled: 1e-3 is ample.
    assert found.position[-1] == pytest.approx(200.0 - 4.0, abs=1e-3)


def test_stiffness_over_time() -> None:
    """x = p/(Q (1 + r t)), and the same with what the path W took away."""
    found = response("ageing", {"r": 0.05}, step(), TIME_S)
    assert found.position[-1] == pytest.approx(200.0 / (1.0 + 0.05 * TIME_S[-1]), rel=2e-4)
    found = response("softening", {"s": 0.3, "W0": 100.0}, step(), TIME_S)
    path = found.position[-1]  # it only rises
    assert path == pytest.approx(200.0 / (1.0 - 0.3 * (1.0 - exp(-path / 100.0))), rel=1e-5)


def test_friction_on_a_slow_ramp() -> None:
    """Q x = p − Fc − N v while sliding, and α (1 − e^{−x/zs}) of Dahl's loop at any speed."""
    ramp = Sweep(0.0, 200.0, 4.0)
    found = response("coulomb_friction", {"Fc": 5.0, "vs": 1.0}, ramp, TIME_S, actuator=SLOW)
    half = TIME_S > 2.0
    balance = 0.5 * found.position + 0.05 * found.velocity + 5.0
    np.testing.assert_allclose(balance[half], found.pressure_kpa[half], atol=1e-3)
    found = response("hysteresis", {"alpha": 8.0, "zs": 40.0}, ramp, TIME_S)
    loop = 8.0 * (1.0 - np.exp(-found.position / 40.0))
    balance = 0.5 * found.position + 5e-4 * found.velocity + loop
    np.testing.assert_allclose(balance[half], found.pressure_kpa[half], atol=1e-3)


def test_slip_elements_end_at_alpha() -> None:
    """After a long way in one direction every element has slipped, at half the speed too."""
    for duration_s in (2.0, 4.0):
        ramp = Sweep(0.0, 200.0, duration_s)
        time_s = np.linspace(0.0, duration_s, 301)[:-1]
        found = response("maxwell_slip", {"alpha": 8.0, "distance": 20.0}, ramp, time_s)
        balance = 0.5 * found.position + 5e-4 * found.velocity + 8.0
        assert balance[-1] == pytest.approx(found.pressure_kpa[-1], abs=1e-2)


def test_what_the_sensor_does() -> None:
    """Line, exponential, limit, clock and slot, each from the position of the same solution."""
    ramp = Sweep(0.0, 200.0, 4.0)
    found = response("sensor_drift", {"rate": -2.0}, ramp, TIME_S)
    np.testing.assert_allclose(found.reading - found.position, -2.0 * TIME_S, atol=1e-9)
    found = response("sensor_gain_drift", {"g": 0.02}, ramp, TIME_S)
    expected = 0.02 * TIME_S * found.position
    np.testing.assert_allclose(found.reading - found.position, expected, atol=1e-9)
    found = response("sensor_warmup", {"size": 7.0, "time": 1.5}, ramp, TIME_S)
    expected = 7.0 * (1.0 - np.exp(-TIME_S / 1.5))
    np.testing.assert_allclose(found.reading - found.position, expected, atol=1e-9)
    found = response("sensor_clipping.both", {"lower": 20.0, "upper": 300.0}, ramp, TIME_S)
    assert (found.reading.min(), found.reading.max()) == (20.0, 300.0)
    plain = response((), {}, ramp, np.arange(0.0, 3.9, 0.01) * 1.02)
    found = response("clock_rate", {"rate": 0.02}, ramp, np.arange(0.0, 3.9, 0.01))
    np.testing.assert_allclose(found.reading, plain.position, atol=1e-4)
    found = response("output_backlash", {"width": 3.0}, ramp, TIME_S)
    assert found.reading[-1] == pytest.approx(found.position[-1] - 3.0, abs=1e-9)
    late = TIME_S > 2.0
    found = response("gain_jump", {"change": -0.1, "at": 2.0}, ramp, TIME_S)
    expected = found.position * np.where(late, 0.9, 1.0)
    np.testing.assert_allclose(found.reading, expected, atol=1e-9)
    found = response("clock_slip", {"slip": 0.1, "at": 2.0}, ramp, TIME_S)
    expected = np.interp(TIME_S - np.where(late, 0.1, 0.0), TIME_S, found.position)
    np.testing.assert_allclose(found.reading, expected, atol=1e-3 * np.ptp(found.position))


def test_a_zero_that_wanders() -> None:
    """Stands on its covariance size² e^{−|t|/time}: 400 recordings of 60 s, a few seconds apart.

    The mean of 400 squares is good for √(2/400) = 7 %; three times that are allowed.
    """
    times = np.arange(0.0, 60.0, 0.5)
    moved = Actuator("oscillator", QUICK)
    sizes = measured_sizes(moved, step().pieces(0.0, np.random.default_rng(0)), QUIET)
    values = {"size": 2.0, "time": 20.0}
    drawn = []
    for seed in range(400):
        law = HIDDEN["zero_wander"].build(values, sizes, Occasion(60.0, seed=seed))
        assert isinstance(law, OutputLaw)
        drawn.append(law.read(times, np.full(times.size, 5.0)) - 5.0)
    rows = np.array(drawn)
    for first, second in ((0, 0), (119, 119), (20, 60), (40, 119)):
        apart_s = times[second] - times[first]
        found = float(np.mean(rows[:, first] * rows[:, second]))
        assert found == pytest.approx(4.0 * exp(-apart_s / 20.0), abs=0.21 * 4.0)


def test_a_clock_that_runs_ahead_reads_beyond_the_end() -> None:
    """With a rate of 4 % the last sample of 4 s shows the motion at 4.16 s, held there."""
    found = response("clock_rate", {"rate": 0.04}, step(), np.append(TIME_S, 4.0))
    assert found.reading[-1] == pytest.approx(200.0, rel=1e-6)


def test_play_remembers_what_lies_between_the_samples() -> None:
    """A visit to 200 mm between two samples leaves the follower 3 mm above the place of return."""
    visit = Sequence((Hold(0.0, 1.0), Hold(100.0, 1.0), Hold(20.0, 1.0)))
    found = response("output_backlash", {"width": 3.0}, visit, np.array([0.0, 0.9, 2.9]))
    assert found.reading[-1] == pytest.approx(43.0, abs=1e-3)


def test_an_effect_beyond_reason_is_an_error() -> None:
    """A spring that goes negative has no finite response; the error says what to do."""
    with pytest.raises(InputError, match="hide a smaller effect"):
        response("stiffening", {"k3": -1.0}, step(), TIME_S)
