"""The model that the logs call for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from softid.errors import UsageError
from softid.identification.model_selection import choose_model
from softid.log import Log, LogSet
from softid.models import Muscle, Oscillator
from softid.readers import load
from softid.simulation import simulate
from softid.synthesis import bundled_datasets, random_muscle_truth

DATA = bundled_datasets() / "data"


@pytest.mark.parametrize(
    ("name", "output", "expected"),
    [
        ("demo_step", "angle", "muscle"),
        ("oscillator_steps", "angle", "oscillator"),
        ("zhao_middle", "angle", "polynomial"),
        ("zhao_middle", "torque", "polynomial"),
    ],
)
def test_each_law_is_recognised(name: str, output: str, expected: str) -> None:
    """The recipe's own law predicts the blocks left out best."""
    log = load(DATA / f"{name}.csv", outputs=(output,))
    choice = choose_model(LogSet((log,)))
    assert choice.model.name == expected
    assert choice.reason.startswith(f"{expected}: ")


def test_plainer_models_that_lost_are_known() -> None:
    """The oscillator with three parameters beside the muscle with seven, none beside itself."""
    for name, plainer in (("demo_step", ["oscillator"]), ("oscillator_steps", [])):
        log = load(DATA / f"{name}.csv", outputs=("angle",))
        choice = choose_model(LogSet((log,)), moving=True)
        assert [model.name for model in choice.plainer] == plainer


def test_the_reason_is_in_the_unit_of_the_log() -> None:
    log = load(DATA / "demo_step.csv")
    choice = choose_model(LogSet((log,)))
    shown = choice.held_out_rmse["muscle"] * log.channels["angle"].display_factor
    assert f"{shown:.3g} deg" in choice.reason


def test_the_pneumatics_alone_are_an_oscillator() -> None:
    """Command to measured pressure: muscle does not explain a pressure, two levels no quartic."""
    time = np.arange(0.0, 20.0, 0.02)
    command = np.where(time % 8 < 4, 10.0, 100.0)
    measured = np.empty_like(time)
    measured[0] = 10.0
    for k in range(1, time.size):
        measured[k] = measured[k - 1] + 0.02 / 0.4 * (command[k - 1] - measured[k - 1])
    noise = 0.3 * np.random.default_rng(1).standard_normal(time.size)
    log = Log.from_arrays(
        time,
        {"pressure_command": command, "pressure": measured + noise},
        input="pressure_command",
        outputs=("pressure",),
    )
    choice = choose_model(LogSet((log,)))
    assert choice.model.name == "oscillator"


def test_channels_that_no_model_links_are_refused() -> None:
    """A distance needs the lengths of the arc, and several outputs the muscle."""
    log = load(DATA / "muscle_steps.csv", outputs=("contraction", "distance"))
    with pytest.raises(UsageError, match="no model explains contraction and distance"):
        choose_model(LogSet((log,)))


def test_a_preferred_model_may_be_a_name_and_is_no_rival_of_itself() -> None:
    logs = LogSet((load(DATA / "muscle_steps.csv"),))
    named, given = (choose_model(logs, preferred=[p]) for p in ("oscillator", Oscillator()))
    assert next(iter(named.held_out_rmse)) == "oscillator"
    assert list(named.held_out_rmse) == list(given.held_out_rmse)
    assert named.reason.count("oscillator") == 1


def test_errors_are_those_of_the_first_output() -> None:
    """0.002 rad of noise on the angle, 2 mm on the contraction, by the model's own response."""
    rng = np.random.default_rng(3)
    time = np.arange(0.0, 12.0, 0.02)
    pressure = np.repeat(rng.uniform(20.0, 280.0, 24), 25)
    outputs = ("angle", "contraction")
    blank = Log.from_arrays(
        time, {"pressure": pressure, **dict.fromkeys(outputs, time)}, outputs=outputs
    )
    arc = Muscle(fixed_length_mm=150.0, diameter_mm=20.0)
    truth = random_muscle_truth(np.random.default_rng(5))
    moved = simulate(arc, truth, blank).outputs
    noise = {"angle": 0.002, "contraction": 2.0}
    measured = {k: moved[k] + noise[k] * rng.standard_normal(time.size) for k in outputs}
    log = Log.from_arrays(time, {"pressure": pressure, **measured}, outputs=outputs)
    choice = choose_model(LogSet((log,)), preferred=(replace(arc, damping="constant"), arc))
    assert choice.held_out_rmse
    for error in choice.held_out_rmse.values():
        assert error == pytest.approx(noise["angle"], rel=0.3)


def moved_by_force(stiffness: float, *, friction: float, seed: int) -> Log:
    """A carriage of 2 kg pushed to and fro; no model has its Coulomb friction."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 24.0, 0.01)
    levels = rng.uniform(20.0, 60.0, 16) * np.where(np.arange(16) % 2, -1.0, 1.0)
    force = np.interp(time, np.linspace(0.0, 24.0, 16), levels)
    place, speed, steps = 0.0, 0.0, 20
    position = np.empty_like(time)
    for k, pushed in enumerate(force):
        position[k] = place
        for _ in range(steps):
            drag = 80.0 * speed + friction * np.tanh(speed / 1e-3) + stiffness * place
            speed += 0.01 / steps * (pushed - 3.0 - drag) / 2.0
            place += 0.01 / steps * speed
    noise = 2e-4 * rng.standard_normal(time.size)
    return Log.from_arrays(
        time, {"force": force, "position": 1e3 * (position + noise)}, input="force"
    )


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("stiffness", "expected"), [(0.0, "oscillator without spring"), (400.0, "oscillator")]
)
@pytest.mark.parametrize("friction", [0.0, 8.0])
def test_a_spring_is_found_where_there_is_one(
    stiffness: float, expected: str, friction: float, seed: int
) -> None:
    """One so soft that it explains no more than none is none: Q → 0 with −Q·zero → −offset."""
    log = moved_by_force(stiffness, friction=friction, seed=seed)
    choice = choose_model(LogSet((log,)))
    assert choice.model.label == expected, choice.reason
