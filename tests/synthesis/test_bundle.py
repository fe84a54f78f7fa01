"""The bundled folder: the same bytes again, and nothing replaced unasked."""

from __future__ import annotations

import json
import math
import random
import shutil
from pathlib import Path

import pytest

from softid.errors import InputError, OutputError, UsageError
from softid.synthesis import (
    bundle,
    bundled_datasets,
    bundled_recipes,
    check_dataset,
    laws,
    load_recipe,
    make_dataset,
    read_manifest,
    synthesize,
    to_csv_bytes,
    write_dataset,
)

MOST_ROWS = 6_000
QUICK = "quick_log"


def recipe_path(name: str) -> Path:
    return bundled_datasets() / "recipes" / f"{name}.toml"


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recipe that takes no time: a bundled one, its sweep shortened from 60 s to 2 s."""
    path = tmp_path_factory.mktemp("recipes") / f"{QUICK}.toml"
    text = recipe_path("zhao_middle").read_text(encoding="utf-8")
    path.write_text(
        text.replace("period_s = 60", "period_s = 2").replace("zhao_middle", QUICK),
        encoding="utf-8",
    )
    return path


@pytest.fixture(scope="module")
def other(quick: Path) -> Path:
    """A second one of another name."""
    path = quick.with_name("other_log.toml")
    path.write_text(quick.read_text(encoding="utf-8").replace(QUICK, "other_log"), encoding="utf-8")
    return path


def test_everything_is_made_again_byte_for_byte(tmp_path: Path) -> None:
    """All bundled recipes into a new folder: CSVs, recipes and manifest equal those bundled."""
    bundled = bundled_datasets()
    written = write_dataset(make_dataset(bundled_recipes()), tmp_path / "new")
    names = [path.relative_to(tmp_path / "new") for path in written]
    assert len(names) == 14
    names += [Path("recipes") / path.name for path in bundled_recipes()]
    for name in names:
        assert (tmp_path / "new" / name).read_bytes() == (bundled / name).read_bytes(), name
    assert len(list((bundled / "data").iterdir())) == 13  # and nothing that no recipe makes


def test_bytes_do_not_hang_on_the_last_binary_digit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another machine's exp may differ by one unit in the last place: the CSV stays the same.

    Measured difference of the response: below 1e-10 mm against a last decimal of 0.01 mm.
    """
    recipe = load_recipe(recipe_path("muscle_steps"))
    usual = synthesize(recipe)
    noise = random.Random(1)

    def other_exp(argument: float) -> float:
        value = math.exp(argument)
        return math.nextafter(value, noise.choice((0.0, value, math.inf)))

    monkeypatch.setattr(laws, "exp", other_exp)
    shaken = synthesize(recipe)
    moved = abs(usual.truth_columns["contraction_mm"] - shaken.truth_columns["contraction_mm"])
    assert 0.0 < moved.max() < 1e-9
    assert to_csv_bytes(usual) == to_csv_bytes(shaken)


def test_manifest_tells_the_truth() -> None:
    """Truth, geometry, seed and roles are those of the recipes; logs are small."""
    known = {log.name: log for log in read_manifest(bundled_datasets())}
    assert sorted(known) == sorted(path.stem for path in bundled_recipes())
    for name, log in known.items():
        recipe = load_recipe(log.recipe)
        assert log.truth == dict(recipe.parameters), name
        assert (log.seed, log.model) == (recipe.seed, recipe.model)
        assert 1_000 < len(log.file.read_text().splitlines()) - 1 <= MOST_ROWS
    muscle = [log for log in known.values() if log.group == "muscle"]
    assert sorted((log.name, log.role) for log in muscle) == [
        ("muscle_sine_025", "hold_out"), ("muscle_sine_050", "fit"), ("muscle_steps", "fit"),
    ]  # fmt: skip
    assert len({tuple(log.truth.items()) for log in muscle}) == 1
    assert (muscle[0].fixed_length_mm, muscle[0].diameter_mm) == (150.0, 20.0)
    assert known["demo_step"].units["M"] == "s²/rad"
    assert known["demo_step"].zero["angle_deg"] == 2.5
    assert known["zhao_middle"].truth["torque.p5"] == 38.29
    assert known["zhao_middle"].units["torque.p4"] == "N·mm/kPa"


def test_assumptions_are_flagged() -> None:
    """Every muscle value is marked as assumed, no coefficient of Zhao's is."""
    document = json.loads((bundled_datasets() / "manifest.json").read_text(encoding="utf-8"))
    for entry in document["logs"]:
        values = [*entry["truth"].values(), *(entry["geometry"] or {}).values()]
        assert {v["assumed"] for v in values} == {entry["model"] != "polynomial"}


def test_check_finds_what_differs(tmp_path: Path, quick: Path, other: Path) -> None:
    """Equal at first; then a changed CSV, a changed truth, a lost CSV, a lost recipe, a new one."""
    folder = tmp_path / "set"
    write_dataset(make_dataset([quick]), folder)
    assert check_dataset(folder) == ()
    file, recipe, manifest = (
        folder / "data" / f"{QUICK}.csv",
        folder / "recipes" / f"{QUICK}.toml",
        folder / "manifest.json",
    )
    good, text = file.read_bytes(), recipe.read_text()
    file.write_bytes(good[:-2] + (b"0\n" if good[-2:] != b"0\n" else b"1\n"))
    assert ["other bytes than the log made again" in s for s in check_dataset(folder)] == [True]
    file.unlink()
    assert "is missing" in check_dataset(folder)[0]
    file.write_bytes(good)
    recipe.write_text(text.replace("p5 = 38.29", "p5 = 38.30"))
    told = " ".join(check_dataset(folder))
    assert "other bytes than the manifest says" in told
    assert "something else about truth" in told
    recipe.rename(folder / "recipes" / "renamed.toml")
    assert any("recipe is missing" in s for s in check_dataset(folder))
    shutil.copy(other, folder / "recipes")
    assert any("has no log other_log" in s for s in check_dataset(folder))
    manifest.write_text("{")
    with pytest.raises(InputError, match="the manifest is damaged"):
        check_dataset(folder)
    manifest.write_text('{"schema": "softid.synthetic/9"}')
    with pytest.raises(InputError, match=r"another kind or version.*softid\.synthetic/9"):
        read_manifest(folder)
    manifest.unlink()
    with pytest.raises(InputError, match="the manifest cannot be read"):
        read_manifest(folder)


def test_another_seed_is_kept_in_the_manifest(tmp_path: Path, quick: Path) -> None:
    """The recipe's seed is 201; the check takes the manifest's 9."""
    write_dataset(make_dataset([quick], seed=9), tmp_path)
    assert read_manifest(tmp_path)[0].seed == 9
    assert check_dataset(tmp_path) == ()


def test_nothing_is_replaced_unasked(tmp_path: Path, quick: Path) -> None:
    """A file in the way stops the whole write before the first byte; asked for, it is replaced."""
    (tmp_path / "data").mkdir()
    mine = tmp_path / "data" / f"{QUICK}.csv"
    mine.write_text("mine")
    made = make_dataset([quick])
    with pytest.raises(OutputError, match=r"exists already.*--force \(overwrite=True in Python\)"):
        write_dataset(made, tmp_path)
    assert mine.read_text() == "mine"
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["data", f"{QUICK}.csv"]
    write_dataset(made, tmp_path, overwrite=True)
    assert check_dataset(tmp_path) == ()


def test_other_logs_of_the_folder_stay_known(tmp_path: Path, quick: Path, other: Path) -> None:
    """A second recipe joins the manifest of the first."""
    write_dataset(make_dataset([quick]), tmp_path)
    second = make_dataset([other])
    with pytest.raises(OutputError, match=r"manifest\.json"):
        write_dataset(second, tmp_path)
    write_dataset(second, tmp_path, overwrite=True)
    assert [log.name for log in read_manifest(tmp_path)] == ["other_log", QUICK]
    assert check_dataset(tmp_path) == ()


def test_two_recipes_of_one_name(tmp_path: Path, quick: Path) -> None:
    """Their CSVs would fall on one another."""
    shutil.copy(quick, tmp_path / "copy.toml")
    with pytest.raises(UsageError, match=f"two recipes have one name.*{QUICK}"):
        make_dataset([quick, tmp_path / "copy.toml"])


def test_folder_is_found_in_an_installation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a checkout around the package, share/softid of the environment is taken."""
    lonely = tmp_path / "site-packages" / "softid" / "synthesis" / "bundle.py"
    monkeypatch.setattr(bundle, "__file__", str(lonely))
    paths = {"get_path": lambda *_: str(tmp_path / "env"), "get_scheme_names": lambda: ()}
    for name, stand_in in paths.items():
        monkeypatch.setattr(bundle.sysconfig, name, stand_in)
    for name in ("prefix", "base_prefix"):
        monkeypatch.setattr(bundle.sys, name, str(tmp_path / "elsewhere"))
    with pytest.raises(InputError, match=r"not there.*install softid again"):
        bundled_datasets()
    folder = tmp_path / "env" / "share" / "softid" / "datasets_synthetic"
    (folder / "recipes").mkdir(parents=True)
    assert bundled_datasets() == folder
