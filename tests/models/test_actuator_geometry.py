"""Section properties against golden numbers and by bands; the geometry file."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from softid.errors import InputError, UsageError
from softid.models.actuator_geometry import VALUES, Actuator, load_actuator, read_actuator
from softid.synthesis import bundled_datasets

FILE = """
title = "Actuator on the bench"
assumed = ["wall", "rib"]
[geometry]
chamber_width = "2 cm"
chamber_height = "12 mm"
wall = "0.002 m"
layer = "500 µm"
rib = "3 mm"
chamber_length = "8 mm"
chambers = 10
[material]
rubber_density = "1.07 g/cm^3"
c10 = "0.017 MPa"
"""


def test_golden_section() -> None:
    """DEE Eq 9, and Eq 11 corrected, of the reference actuator, to their printed digits."""
    found = Actuator()
    assert found.line_densities_kg_m == pytest.approx((0.21792, 0.73152), rel=1e-12)
    assert found.rotations_kg_m == pytest.approx((2.331342e-5, 4.953912e-5), rel=1e-9)
    assert found.length_m == pytest.approx(0.113, rel=1e-15)


def test_rotation_by_bands() -> None:
    """J is ∫ρ·y² dA: neutral layer, side walls (a rib fills the chamber) and top walls."""
    a = Actuator(chamber_width_m=0.03, chamber_height_m=0.01, wall_m=0.0015, layer_m=0.001)

    def band(low: float, high: float) -> float:
        return 2.0 * (high**3 - low**3) / 3.0

    inner, top, out = 0.0005, 0.0105, 0.012
    core = a.layer_density_kg_m3 * a.outer_width_m * 0.001**3 / 12.0
    walls = a.rubber_density_kg_m3 * (0.003 * band(inner, top) + a.outer_width_m * band(top, out))
    rib = a.rubber_density_kg_m3 * a.outer_width_m * band(inner, out)
    assert a.rotations_kg_m == pytest.approx((core + walls, core + rib), rel=1e-12)


def test_the_length_is_covered_once() -> None:
    """Ribs at i·(a + t_r), chambers between: no gap, no overlap, eleven ribs, ten chambers."""
    parts = Actuator().stretches
    assert len(parts) == 21
    assert parts[0].start_m == 0.0
    assert parts[-1].stop_m == pytest.approx(0.113, rel=1e-14)
    for one, two in pairwise(parts):
        assert two.start_m == pytest.approx(one.stop_m, rel=1e-14)


def test_a_file_in_any_unit(tmp_path: Path) -> None:
    """pint converts; what the file leaves out is softid's, and labelled with what the user said."""
    path = tmp_path / "actuator.toml"
    path.write_text(FILE, encoding="utf-8")
    found = load_actuator(path)
    reference = Actuator()
    for name in VALUES:
        assert getattr(found, name) == pytest.approx(getattr(reference, name), rel=1e-12), name
    assert found.assumed_names == ("wall_m", "rib_m", "layer_density_kg_m3", "c20_pa")


def test_only_the_printed_value_is_not_assumed() -> None:
    """The paper prints 2 GPa, and no dimension, density or rubber coefficient."""
    assert set(VALUES) - set(Actuator().assumed_names) == {"layer_modulus_pa"}


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('wall = "0.002 m"\n', "", "wall is missing"),
        ('"2 cm"', "20", "a number with its unit is expected"),
        ('"2 cm"', '"20"', "a number with its unit is expected"),
        ('"2 cm"', '"20 kg"', "not a quantity in m"),
        ('"2 cm"', '"20 flops"', "not a quantity in m"),
        ('"2 cm"', '"2 9**9**9"', "a number with its unit is expected"),
        ('"2 cm"', '"-2 cm"', "actuator.toml, chamber_width: a value between 1e-06 and 10 m"),
        ('"2 cm"', '"2e400 m"', "a value between 1e-06 and 10 m"),
        ('"2 cm"', '"20 m"', "a value between 1e-06 and 10 m"),
        ('"2 cm"', '"1e-200 m"', "a value between 1e-06 and 10 m"),
        ("chambers = 10", "chambers = 10.5", "a whole number is expected"),
        ("chambers = 10", "chambers = 0", "chambers: a value between 1 and 1000 is expected"),
        ("chambers = 10", "chambers = 100000000", "a value between 1 and 1000 is expected"),
        ("[material]", "[matter]", "this key is unknown"),
        ('c10 = "0', 'c30 = "0', "this key is unknown"),
        ('"rib"]', '"ribs"]', "this key is unknown"),
        ('["wall", "rib"]', '"wall"', "a list of names is expected"),
        ("[geometry]", "[geometry", "the geometry is no TOML"),
    ],
)
def test_one_sentence_for_each_mistake(old: str, new: str, told: str) -> None:
    assert old in FILE
    with pytest.raises(InputError, match=told):
        read_actuator(FILE.replace(old, new), where="actuator.toml")


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        load_actuator(tmp_path / "none.toml")
    with pytest.raises(InputError, match="cannot be read"):
        load_actuator(tmp_path)


def test_values_and_assumed_names_are_checked() -> None:
    """params.json is edited by hand; a wrong name or number there is an error too."""
    with pytest.raises(InputError, match="no such value"):
        Actuator(assumed="wall")
    with pytest.raises(InputError, match="geometry, rib_m: a value between"):
        Actuator(rib_m=0.0)
    with pytest.raises(UsageError, match="option c20_pa: this is no number"):
        Actuator(c20_pa=float("nan"))


def test_the_file_in_the_readme_is_the_reference() -> None:
    """What a reader copies gives the actuator behind the bundled logs, labels and all."""
    text = (bundled_datasets() / "README.md").read_text(encoding="utf-8")
    found = read_actuator(text.split("```toml\n")[1].split("```")[0], where="README.md")
    for name in VALUES:
        assert getattr(found, name) == pytest.approx(getattr(Actuator(), name), rel=1e-14), name
    assert found.assumed == Actuator().assumed
