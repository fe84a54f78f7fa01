"""Extended models at the command line: tables that name the effects, scores and predictions."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from desk import Desk, Outcome
from extended_fits import extended_fit, log_of

from softid.effects import model_of
from softid.records import save_fit
from softid.results import LogNuisance
from softid.simulation import simulate

Cli = Callable[..., Outcome]
RADIANS = ("--channel", "angle=angle_rad:rad")
"""The motion of these tests goes far beyond a turn, so its unit is confirmed."""


@pytest.fixture
def params(tmp_path: Path) -> Path:
    path = tmp_path / "extended.json"
    rest = LogNuisance("step_1", {"angle": 0.0}, {"angle": None}, ())
    result = extended_fit("muscle", "coulomb_friction", "delay")
    save_fit(replace(result, nuisances=(rest,)), path)
    return path


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """A log with pressure and the response of the extended model itself."""
    result, log = extended_fit("muscle", "coulomb_friction", "delay"), log_of("muscle")
    moved = simulate(model_of(result.model), result.values, log).outputs["angle"]
    path = tmp_path / "recorded.csv"
    table = np.column_stack((log.time_s, log.pressure_kpa, moved))
    np.savetxt(path, table, "%.17g", ",", header="time_s,pressure_kpa,angle_rad", comments="")
    return path


def test_tables_name_the_effects(softid: Cli, desk: Desk) -> None:
    """Parameters of an effect stand under its key, by their own names."""
    desk.answer = extended_fit("muscle", "coulomb_friction.stribeck", "delay")
    told = softid("fit", "step_1.csv").out
    flat = " ".join(told.split())
    assert "+ delay + coulomb_friction.stribeck, pressure → angle" in flat
    first, delay, friction = re.split(r"\nEffect (?:delay|coulomb_friction.stribeck):\n", told)
    assert [first_words(part, 9)[-1] for part in (first, delay)] == ["c2", "tau"]
    assert first_words(friction, 6)[2:] == ["Fc", "vs", "beta", "vb"]


def first_words(text: str, count: int) -> list[str]:
    """The first word of each line of the table in a text: its head, its rule, its rows."""
    lines = text[text.index("parameter  ") :].split("\n\n")[0].splitlines()
    return [line.split()[0] for line in lines][:count]


def test_an_extended_model_predicts(softid: Cli, params: Path, recorded: Path) -> None:
    """The CSV is the simulation by the library, to the 9 digits that it writes."""
    told = softid("simulate", params, "--input", recorded, "--quiet", *RADIANS)
    assert told.code == 0, told.err
    rows = list(csv.DictReader(io.StringIO(told.out)))
    found = np.array([float(row["angle_deg"]) for row in rows])
    expected = np.array([float(row["measured_angle_deg"]) for row in rows])
    np.testing.assert_allclose(found, expected, atol=1e-6)
    assert np.ptp(found) > 10.0


def test_an_extended_model_is_scored(softid: Cli, params: Path, recorded: Path) -> None:
    """On its own response it fits 100 %, and the table names the effects."""
    told = softid("validate", params, recorded, "--threshold", "99.99", *RADIANS)
    assert told.code == 0, told.err + told.out
    assert "+ delay + coulomb_friction" in told.out
