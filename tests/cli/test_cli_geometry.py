"""`softid fit --geometry`: from a TOML file to a fit, and what is refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from desk import Desk, Outcome

from softid.models.equilibrium import Equilibrium
from softid.synthesis import bundled_datasets

Cli = Callable[..., Outcome]

FILE = """
assumed = ["c10"]
[geometry]
chamber_width = "20 mm"
chamber_height = "12 mm"
wall = "2 mm"
layer = "0.5 mm"
rib = "3 mm"
chamber_length = "8 mm"
chambers = 10
[material]
rubber_density = "1070 kg/m^3"
layer_density = "1040 kg/m^3"
layer_modulus = "2 GPa"
c10 = "17 kPa"
c20 = "-0.2 kPa"
"""


@pytest.fixture
def geometry(tmp_path: Path) -> Path:
    path = tmp_path / "actuator.toml"
    path.write_text(FILE, encoding="utf-8")
    return path


def test_the_geometry_reaches_the_model(softid: Cli, desk: Desk, geometry: Path) -> None:
    """With the model named, with one of its options, and alone, when it is preferred."""
    assert softid("fit", "a.csv", "--model", "equilibrium", "--geometry", geometry).code == 0
    model = desk.asked["model"]
    assert model == Equilibrium(assumed="c10_pa")
    assert desk.asked["preferred"] == ()
    assert softid("fit", "a.csv", "--geometry", geometry, "--option", "drift=linear").code == 0
    assert desk.asked["model"] == Equilibrium(assumed="c10_pa", drift="linear")
    assert softid("fit", "a.csv", "--geometry", geometry).code == 0
    assert desk.asked["model"] is None
    assert desk.asked["preferred"] == (Equilibrium(assumed="c10_pa"),)


@pytest.mark.parametrize("command", ["fit", "diagnose"])
def test_assumed_dimensions_are_told_before_the_work(
    softid: Cli, desk: Desk, geometry: Path, command: str
) -> None:
    """As the result tells them, and only where nobody has given a file."""
    desk.answer = KeyboardInterrupt()
    asked = (command, "a.csv", "--model", "equilibrium")
    told = softid(*asked)
    assert "warning: assumed, neither measured nor printed in the paper: chamber_w" in told.err
    assert "give them with --geometry" in told.err
    assert "assumed" not in softid(*asked, "--geometry", geometry).err
    assert "assumed" not in softid(*asked, "--quiet").err
    assert "assumed" not in softid(command, "a.csv", "--model", "muscle").err


def test_another_model_takes_no_geometry_file(softid: Cli, desk: Desk, geometry: Path) -> None:
    told = softid("fit", "a.csv", "--model", "muscle", "--geometry", geometry)
    assert told.code == 2
    assert "the muscle model takes no geometry file" in told.err


def test_an_option_of_another_model_is_named_alone(softid: Cli, desk: Desk, geometry: Path) -> None:
    """What the file says was not typed, so the error does not name it."""
    told = softid("fit", "a.csv", "--geometry", geometry, "--damping", "constant")
    assert told.code == 2
    assert "--damping: the equilibrium model has no such option" in told.err
    assert "rib_m" not in told.err.split("its options are")[0]


def test_a_wrong_file_is_one_sentence(softid: Cli, desk: Desk, geometry: Path) -> None:
    geometry.write_text(FILE.replace('"20 mm"', "20"), encoding="utf-8")
    told = softid("fit", "a.csv", "--geometry", geometry)
    assert told.code == 3
    assert "a number with its unit is expected" in told.err
    assert softid("fit", "a.csv", "--geometry", "none.toml").code == 3


def test_a_diagnosis_may_choose_it_too(softid: Cli, geometry: Path) -> None:
    """With the file alone, as a fit."""
    log = bundled_datasets() / "data" / "equilibrium_20.csv"
    options = ("--geometry", geometry, "--effects", "creep", "--no-plots", "--out", "out")
    told = softid("diagnose", log, *options)
    assert told.code == 0, told.err
    found = json.loads(Path("out/diagnosis.json").read_text(encoding="utf-8"))
    assert found["base"]["model"]["name"] == "equilibrium"
    refused = softid("diagnose", log, "--geometry", geometry, "--params", "out/params.json")
    assert refused.code == 2
    assert "the base model is given twice" in refused.err


def test_from_a_log_to_a_simulation(softid: Cli, geometry: Path) -> None:
    """The whole way on a bundled log: chosen, labelled, saved, simulated from the file alone."""
    log = bundled_datasets() / "data" / "equilibrium_20.csv"
    told = softid("fit", log, "--geometry", geometry, "--no-plots", "--out", "out")
    assert told.code == 0, told.err
    assert "Model: equilibrium" in told.out
    assert "c10_pa = 17000" in " ".join(told.out.split())
    saved = json.loads(Path("out/params.json").read_text(encoding="utf-8"))
    assert saved["model"]["options"]["rib_m"] == 0.003
    assert saved["model"]["options"]["assumed"] == "c10_pa"
    other = bundled_datasets() / "data" / "equilibrium_minus_20.csv"
    geometry.unlink()
    simulated = softid("simulate", "out/params.json", "--input", other)
    assert simulated.code == 0, simulated.err
    rows = [line.split(",") for line in simulated.out.splitlines()]
    last = dict(zip(rows[0], rows[-1], strict=True))
    assert float(last["angle_deg"]) == pytest.approx(-40.4, abs=0.3)
