"""Recipes: what a file means, and one sentence for each mistake in it."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import pytest

from softid.errors import InputError
from softid.synthesis import Arc, bundled_recipes, load_recipe
from softid.synthesis.bending_law import Bender
from softid.synthesis.recipe import parse_recipe

GOOD = """
name = "log"
model = "muscle"
seed = 4
assumed = ["M", "diameter_mm"]
[parameters]
M = 0.003
a1 = 0.0143
b1 = 3
c1 = 0.95
a2 = 0
b2 = -1.0
c2 = 0.28
[geometry]
fixed_length_mm = 150
diameter_mm = 20
[excitation]
kind = "steps"
levels_kpa = [0, 100]
hold_s = 1
[valve]
time_constant_s = 0.04
[sampling]
rate_hz = 50
[sensors.pressure_bar]
decimals = 4
[sensors.distance_mm]
decimals = 2
noise_sd = 0.3
[sensors.angle_deg]
decimals = 2
"""


def parsed(text: str):
    return parse_recipe(text.encode(), where="log.toml")


def test_a_good_recipe() -> None:
    """Every table arrives in its place; columns keep their order; whole numbers become floats."""
    recipe = parsed(GOOD)
    assert recipe.geometry == Arc(150.0, 20.0)
    assert list(recipe.sensors) == ["pressure_bar", "distance_mm", "angle_deg"]
    assert recipe.output_channels == ("distance", "angle")
    assert recipe.parameters["b1"] == 3.0
    assert recipe.units["a2"] == "s/mm"
    assert recipe.role == "fit"
    assert recipe.valve is not None
    assert parsed(GOOD.replace("[valve]\ntime_constant_s = 0.04", "")).valve is None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name = "log"\n', "", "the key name is missing"),
        ('name = "log"', 'name = "../log"', "cannot be the stem of a file.*'../log'"),
        ('"muscle"', '"dee"', r"log.toml, model: this is not a choice.*'dee'.*oscillator"),
        ("seed = 4", "seed = -4", "seed is out of range.*-4.*at least 0"),
        ("seed = 4", "seed = 4.5", "log.toml, seed: a whole number is expected"),
        ("seed = 4", "sede = 4", "this key is unknown.*'sede'"),
        ("[valve]", "[hide]", "this key is unknown.*'hide'"),
        ("M = 0.003\n", "", "the parameter M is missing"),
        ("M = 0.003", "M = -0.003", "the parameter M must be positive.*-0.003"),
        ("M = 0.003", 'M = "3e-3"', r"\[parameters\], M: a number is expected"),
        ("M = 0.003", "M = inf", "the parameter M must be positive"),
        ("a2 = 0", "a2 = nan", "the parameter a2 must be finite"),
        ("a2 = 0", "a3 = 0", r"log.toml, parameters: this key is unknown.*'a3'"),
        ('"diameter_mm"]', '"radius_mm"]', "assumed.*'radius_mm'.*diameter_mm"),
        ("diameter_mm = 20", "", r"\[geometry\]: the key diameter_mm is missing"),
        ("diameter_mm = 20", "diameter_mm = 0", r"\[geometry\]: diameter_mm is out of range"),
        ("[sampling]\nrate_hz = 50", "", r"the table sampling is missing"),
        ("rate_hz = 50", "rate_hz = 50\njiter_s = 1", r"\[sampling\].*unknown.*'jiter_s'"),
        ("[sensors.angle_deg]", "[sensors.angle]", "no.* a channel with its unit.*'angle'"),
        ("[sensors.angle_deg]", "[sensors.angle_kpa]", "channel with its unit.*'angle_kpa'"),
        ("[sensors.angle_deg]", "[sensors.torque_nmm]", "no such column.*'torque_nmm'"),
        ("[sensors.angle_deg]", "[sensors.distance_cm]", "each channel once"),
        ("[sensors.pressure_bar]", "[sensors.contraction_mm]", "no pressure is recorded"),
        ("time_constant_s = 0.04", "time_constant_s = [1]", r"\[valve\], time_constant_s: a num"),
        ("hold_s = 1", "hold_s = 1\nhold_s = 2", "the recipe is no TOML"),
    ],
)
def test_mistakes(old: str, new: str, message: str) -> None:
    """What, where, the value and the remedy, in one sentence that names the file."""
    assert old in GOOD
    with pytest.raises(InputError, match=message) as error:
        parsed(GOOD.replace(old, new))
    assert str(error.value).startswith("log.toml")
    assert "\n" not in str(error.value)


def test_geometry_decides_the_columns() -> None:
    """Without an arc there is no distance; with x in rad there is only the angle."""
    lengths = "[geometry]\nfixed_length_mm = 150\ndiameter_mm = 20\n"
    bare = GOOD.replace(lengths, "").replace(', "diameter_mm"', "")
    with pytest.raises(InputError, match=r"without geometry has no such column.*'distance_mm'"):
        parsed(bare)
    angle = bare.replace("[sensors.distance_mm]\ndecimals = 2\nnoise_sd = 0.3\n", "")
    assert parsed('x_unit = "rad"\n' + angle).output_channels == ("angle",)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    """Missing, a folder, bytes that are no text, too large: each an input error."""
    with pytest.raises(InputError, match=r"absent\.toml: the recipe cannot be read"):
        load_recipe(tmp_path / "absent.toml")
    with pytest.raises(InputError, match="the recipe cannot be read"):
        load_recipe(tmp_path)
    (tmp_path / "a.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match=r"a\.toml, byte 1: the recipe is not text in UTF-8"):
        load_recipe(tmp_path / "a.toml")
    (tmp_path / "big.toml").write_bytes(b"#" * 1_000_001)
    with pytest.raises(InputError, match="too large"):
        load_recipe(tmp_path / "big.toml")


def test_bundled_recipes_label_what_no_paper_prints() -> None:
    """Ru prints no value at all: each muscle and oscillator parameter and length is assumed.

    Zhao's coefficients are printed, so none of them is; of the bi-directional actuator only the
    neutral layer's modulus is.
    """
    for path in bundled_recipes():
        recipe = load_recipe(path)
        lengths = ["fixed_length_mm", "diameter_mm"] if recipe.geometry else []
        wanted = [] if recipe.model == "polynomial" else [*recipe.parameters, *lengths]
        if recipe.actuator is not None:
            wanted += [f.name for f in fields(Bender) if f.name != "layer_modulus_gpa"]
        assert sorted(recipe.assumed) == sorted(wanted), path.name
        assert any("assum" in note for note in recipe.notes), path.name
