"""Whether a jump of the input was held is decided by what fits better, and stays in the record."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linear_motion import TRUTH, swinging_log

from softid.fitters.output_error import draft_fit
from softid.fitters.problem import Problem
from softid.identification import fit
from softid.identification.intersample_choice import (
    LONG,
    Explained,
    explains_better,
    held_choices,
)
from softid.log import Log, LogSet
from softid.models import Oscillator
from softid.records import load_params, save_fit
from softid.synthesis import hidden_pair
from softid.synthesis.rig import Rig
from softid.validation import validate

PERIOD_S, TAU_S, NOISE = 0.02, 0.1, 0.005


def stepped(seed: int, *, is_held: bool, levels: int = 16, rest: int = 0) -> Log:
    """A first-order lag of 0.1 s behind random levels that jump at samples, in closed form."""
    rng = np.random.default_rng(seed)
    u = np.repeat(rng.uniform(0.0, 100.0, levels), 50)
    u = np.concatenate([np.full(rest, u[0]), u])
    decay = np.exp(-PERIOD_S / TAU_S)
    x = np.empty(u.size)
    x[0] = u[0]
    for k in range(u.size - 1):
        rise = 0.0 if is_held else u[k + 1] - u[k]
        # Exact over a straight piece: x follows u with the slope times τ behind it.
        lag = rise / PERIOD_S * TAU_S
        x[k + 1] = u[k] + rise - lag + (x[k] - u[k] + lag) * decay
    y = 0.01 * x + rng.normal(0.0, NOISE, x.size)
    time_s = PERIOD_S * np.arange(u.size)
    return Log.from_arrays(time_s, {"pressure": u, "angle": y}, name=f"steps_{seed}")


@pytest.mark.parametrize("is_held", [True, False])
def test_the_true_intersample_behaviour_is_taken(is_held: bool, tmp_path: Path) -> None:
    """Known truth: the time constant within its interval, the residual at the noise, and the same
    behaviour for another log, also from the file. Straight in place of held is 10 ms early."""
    found = fit(
        stepped(0, is_held=is_held), model="oscillator", hold_out=stepped(1, is_held=is_held)
    )
    assert (found.intersample == "held") is is_held
    assert any(issue.code == "held-input" for issue in found.issues) is is_held
    interval = found.parameter("N").ci95
    assert interval is not None
    assert interval[0] <= 100.0 * TAU_S <= interval[1]
    for row in found.statistics:
        assert row.rmse == pytest.approx(NOISE, rel=0.1)
    save_fit(found, tmp_path / "params.json")
    for fitted in (found, load_params(tmp_path / "params.json")):
        (row,) = validate(fitted, stepped(2, is_held=is_held)).statistics
        assert row.rmse == pytest.approx(NOISE, rel=0.1)


@pytest.mark.parametrize("polyline", [True, False])
def test_an_input_that_swings_is_smooth(polyline: bool, tmp_path: Path) -> None:
    """Known truth: straight lines cut the input by up to 3 %, and bias N by 5 standard errors.

    What went straight stays straight, also from the file.
    """
    logs = [swinging_log(seed, polyline=polyline) for seed in (1, 2, 3)]
    found = fit(logs[0], model="oscillator", hold_out=logs[1])
    assert found.intersample == ("straight" if polyline else "smooth")
    assert any(issue.code == "smooth-input" for issue in found.issues) is not polyline
    for name, truth in TRUTH.items():
        estimate = found.parameter(name)
        assert estimate.value == pytest.approx(truth, abs=3.0 * float(estimate.stderr or 0.0))
    save_fit(found, tmp_path / "params.json")
    fits = [validate(one, logs[2]) for one in (found, load_params(tmp_path / "params.json"))]
    noise = 0.003 * float(np.ptp(logs[2].channels["angle"].values))
    assert [v.statistics[0].rmse for v in fits] == pytest.approx([noise, noise], rel=0.1)


@pytest.mark.parametrize("seed", range(3))
def test_steps_behind_a_valve_are_smooth(seed: int) -> None:
    """Levels that a valve of 40 ms reaches between samples of 10 ms, known truth: the damping is
    nearer to it than with straight lines, which the residual hardly tells, and nothing is said."""
    quiet = Rig(noise=0.002, pressure_noise_kpa=0.1)
    pair = hidden_pair((), seed=seed, model="oscillator", protocol="levels", rig=quiet)
    log, truth = pair.logs[0], pair.actuator.values["N"]
    found = fit(log, model="oscillator")
    straight = fit(log.with_intersample("straight"), model="oscillator")
    assert found.intersample == "smooth"
    assert not any(issue.code == "smooth-input" for issue in found.issues)
    off = [abs(one.values["N"] / truth - 1.0) for one in (found, straight)]
    assert off[0] < 0.7 * off[1]
    assert off[1] > 0.002


def test_a_log_that_says_it_is_believed() -> None:
    """Declared as straight, a held input is not looked at again."""
    log = replace(stepped(0, is_held=True), intersample="straight")
    assert held_choices(LogSet((log,))) == ()
    assert fit(log, model="oscillator").intersample == "straight"


@pytest.mark.parametrize(
    ("name", "intersample"), [("pressure_command", "zoh"), ("pressure", "smooth")]
)
def test_a_command_may_be_held_at_every_sample(name: str, intersample: str) -> None:
    """A held sine has no jump, but half a sample of it is many times the noise, and the truth is
    found with it; a measured pressure is not asked, for no actuator sees samples of a gauge."""
    time_s = PERIOD_S * np.arange(1500)
    u = 50.0 + 40.0 * np.sin(4.0 * time_s + 0.05 * time_s**2)
    decay, x = np.exp(-PERIOD_S / TAU_S), np.empty(time_s.size)
    x[0] = u[0]
    for k in range(time_s.size - 1):
        x[k + 1] = u[k] + (x[k] - u[k]) * decay
    y = 0.01 * x + np.random.default_rng(0).normal(0.0, NOISE, x.size)
    log = Log.from_arrays(time_s, {name: u, "angle": y}, input=name)
    found = fit(log, model=Oscillator(order="first"))
    assert found.intersample == intersample
    interval = found.parameter("N").ci95
    assert interval is not None
    assert (interval[0] <= 100.0 * TAU_S <= interval[1]) is (intersample == "zoh")


def swung(seed: int, *, is_held: bool) -> Log:
    """The same lag behind a sine of 0.4 Hz from rest, in closed form."""
    time_s = PERIOD_S * np.arange(1000)
    omega = 2.0 * np.pi * 0.4
    u = 50.0 - 40.0 * np.cos(omega * time_s)
    x = np.full(time_s.size, u[0])
    decay = np.exp(-PERIOD_S / TAU_S)
    for k in range(time_s.size - 1):
        x[k + 1] = u[k] + (x[k] - u[k]) * decay
    if not is_held:
        turned = np.exp(1j * omega * time_s) / (1.0 + 1j * omega * TAU_S)
        x = 50.0 - 40.0 * turned.real
        x += (10.0 - x[0]) * np.exp(-time_s / TAU_S)
    y = 0.01 * x + np.random.default_rng(seed).normal(0.0, NOISE, x.size)
    return Log.from_arrays(time_s, {"pressure": u, "angle": y}, name=f"sine_{seed}")


@pytest.mark.parametrize("is_held", [True, False])
def test_a_sine_tells_what_fitted_steps_do_not(is_held: bool, tmp_path: Path) -> None:
    """Held at their jumps or at every sample is one for them, and half an interval for the sine."""
    sine = swung(1, is_held=is_held)
    found = fit(stepped(0, is_held=True), model="oscillator", hold_out=sine)
    assert found.intersample == "held"
    save_fit(found, tmp_path / "params.json")
    for judged in (found, validate(load_params(tmp_path / "params.json"), sine)):
        (row,) = (row for row in judged.statistics if row.log == sine.name)
        assert row.rmse == pytest.approx(NOISE, rel=0.1)
        told = [issue for issue in judged.issues if issue.code == "held-otherwise"]
        assert [issue.message.split(":")[0] for issue in told] == [sine.name] * is_held


@pytest.mark.parametrize("rest", [0, 110_000])
@pytest.mark.parametrize("is_held", [True, False])
def test_a_long_log_is_told_by_a_beginning_that_moves(is_held: bool, rest: int) -> None:
    """However long it rests first: what is looked at holds half of its share of the way."""
    log = stepped(3, is_held=is_held, levels=2400, rest=rest)
    found = fit(log, model=Oscillator(order="first"))
    assert len(log) > LONG
    assert (found.intersample == "held") is is_held
    assert found.parameter("N").value == pytest.approx(100.0 * TAU_S, rel=0.01)


def test_the_same_logs_explain_nothing_better() -> None:
    """No gain without a jump that is taken otherwise."""
    logs = LogSet((stepped(0, is_held=False),))
    model = Oscillator(order="first", x_unit="rad", u_unit="kPa")
    problem = Problem(model, model.parameters(), logs.logs)
    values = {"N": 100.0 * TAU_S, "Q": 100.0}
    optimum = draft_fit(problem, [values])
    assert not explains_better(Explained(problem, optimum), logs)


@pytest.mark.parametrize(
    ("name", "choices"),
    [("valve command (V)", ("zoh",)), ("pwm_setpoint", ("zoh",)), ("valve", ())],
)
def test_what_is_commanded_in_any_unit_may_be_held(name: str, choices: tuple[str, ...]) -> None:
    """By definition: a controller holds what it sets, however slowly it moves."""
    time_s = np.arange(400) * 0.02
    channels = {name: 5.0 + np.sin(time_s), "angle": np.sin(time_s)}
    log = Log.from_arrays(time_s, channels, input=name, units={name: "1"})
    assert held_choices([log]) == choices
