"""`softid synthesize`: what it writes, prints and returns."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator

from softid.errors import InputError, OutputError, UsageError
from softid.records.reading import load_schema
from softid.synthesis import bundled_datasets
from softid_cli.synthesize import synthesize

RECIPE = str(bundled_datasets() / "recipes" / "zhao_middle.toml")


def run(*arguments: str):
    return CliRunner().invoke(synthesize, list(arguments))


def test_one_recipe(tmp_path: Path) -> None:
    """The folder is complete in itself: recipe, CSV equal to the bundled one, manifest."""
    out = tmp_path / "out"
    result = run(RECIPE, "--out", str(out))
    assert result.exit_code == 0
    assert "zhao_middle" in result.stdout
    assert f"written to {out}" in result.stderr
    files = sorted(p.relative_to(out).as_posix() for p in out.rglob("*") if p.is_file())
    assert files == ["data/zhao_middle.csv", "manifest.json", "recipes/zhao_middle.toml"]
    again = bundled_datasets() / "data" / "zhao_middle.csv"
    assert (out / "data" / "zhao_middle.csv").read_bytes() == again.read_bytes()


def test_json_and_seed(tmp_path: Path) -> None:
    """stdout is one JSON document with the seed used; the log differs from the bundled one."""
    result = run(RECIPE, "--out", str(tmp_path), "--seed", "5", "--json", "--quiet")
    (log,) = json.loads(result.stdout)["logs"]
    assert (log["seed"], result.stderr) == (5, "")
    again = bundled_datasets() / "data" / "zhao_middle.csv"
    assert (tmp_path / "data" / "zhao_middle.csv").read_bytes() != again.read_bytes()


def test_the_manifest_is_valid_by_its_schema(tmp_path: Path) -> None:
    """The schema is the published format, of what is written and of the bundled folder."""
    assert run(RECIPE, "--out", str(tmp_path), "--quiet").exit_code == 0
    written = json.loads((tmp_path / "manifest.json").read_text())
    bundled = json.loads((bundled_datasets() / "manifest.json").read_text())
    schema = load_schema(written["schema"])
    for manifest in (written, bundled):
        Draft202012Validator(schema).validate(manifest)
    known = set().union(*bundled["logs"])
    assert set(schema["$defs"]["log"]["properties"]) == known


def test_default_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without --out the logs go below softid-out of the working folder."""
    monkeypatch.chdir(tmp_path)
    assert run(RECIPE, "--quiet").exit_code == 0
    assert (tmp_path / "softid-out" / "synthetic" / "manifest.json").is_file()


def test_force(tmp_path: Path) -> None:
    """A second run is refused with exit code 3, unless --force is said."""
    assert run(RECIPE, "--out", str(tmp_path)).exit_code == 0
    refused = run(RECIPE, "--out", str(tmp_path)).exception
    assert isinstance(refused, OutputError)
    assert refused.exit_code == 3
    assert run(RECIPE, "--out", str(tmp_path), "--force").exit_code == 0


def test_check_of_a_folder(tmp_path: Path) -> None:
    """Exit 0 while all is equal, 1 when a byte was changed; nothing is written either way."""
    run(RECIPE, "--out", str(tmp_path))
    fine = run("--check", "--out", str(tmp_path))
    assert (fine.exit_code, "byte for byte" in fine.stdout) == (0, True)
    file = tmp_path / "data" / "zhao_middle.csv"
    file.write_bytes(file.read_bytes().replace(b",", b";", 1))
    changed = file.read_bytes()
    wrong = run("--check", "--out", str(tmp_path), "--json")
    assert wrong.exit_code == 1
    assert json.loads(wrong.stdout)["equal"] is False
    assert file.read_bytes() == changed


def test_check_of_one_bundled_log() -> None:
    """With a recipe named, that log alone is compared with the bundled manifest."""
    result = run("--check", RECIPE)
    assert (result.exit_code, result.stdout.count("byte for byte")) == (0, 1)


def test_check_takes_no_seed() -> None:
    """A check with another seed would always fail: wrong usage, exit code 2."""
    refused = run("--check", "--seed", "1").exception
    assert isinstance(refused, UsageError)
    assert refused.exit_code == 2


def test_a_recipe_that_is_missing(tmp_path: Path) -> None:
    """Exit code 3, the file named, nothing written."""
    refused = run(str(tmp_path / "absent.toml"), "--out", str(tmp_path / "out")).exception
    assert isinstance(refused, InputError)
    assert "absent.toml" in str(refused)
    assert not (tmp_path / "out").exists()
