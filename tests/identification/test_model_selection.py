"""The model that the logs call for."""

from __future__ import annotations

import numpy as np
import pytest

from softid.errors import UsageError
from softid.identification.model_selection import choose_model
from softid.log import Log, LogSet
from softid.readers import load
from softid.synthesis import bundled_datasets

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
    choice = choose_model(LogSet((log,)), rng=np.random.default_rng(0))
    assert choice.model.name == expected
    assert choice.reason.startswith(f"{expected}: ")


def test_the_reason_is_in_the_unit_of_the_log() -> None:
    log = load(DATA / "demo_step.csv")
    choice = choose_model(LogSet((log,)), rng=np.random.default_rng(0))
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
    choice = choose_model(LogSet((log,)), rng=np.random.default_rng(0))
    assert choice.model.name == "oscillator"


def test_channels_that_no_model_links_are_refused() -> None:
    """A distance needs the lengths of the arc, and several outputs the muscle."""
    log = load(DATA / "muscle_steps.csv", outputs=("contraction", "distance"))
    with pytest.raises(UsageError, match="no model explains contraction and distance"):
        choose_model(LogSet((log,)), rng=np.random.default_rng(0))
