"""The wheel works without the checkout: commands, schemas and bundled logs are in it."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SETUPTOOLS = 77  # the first that knows the licence field of pyproject.toml


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """softid's wheel, built from a copy and unpacked into a folder of its own."""
    try:
        version = metadata.version("setuptools")
    except metadata.PackageNotFoundError:
        pytest.skip("setuptools is not installed, so no wheel can be built without a network")
    if int(version.split(".")[0]) < SETUPTOOLS:
        pytest.skip(f"setuptools {version} is too old to build softid ({SETUPTOOLS} is needed)")
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"
    tracked = ["softid", "cli", "datasets_synthetic", "pyproject.toml", "README.md", "LICENSE"]
    source.mkdir()
    for name in tracked:  # a build writes into its source, and this is not ours to write into
        subprocess.run(["cp", "-r", str(ROOT / name), str(source / name)], check=True, timeout=60)
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
    build = ["wheel", str(source), "--no-deps", "--no-build-isolation", "-w", str(folder)]
    subprocess.run([*pip, *build], check=True, timeout=300)
    (wheel,) = folder.glob("softid-*.whl")
    target = folder / "target"
    unpack = ["install", "--no-deps", "--no-compile", "--target", str(target), str(wheel)]
    subprocess.run([*pip, *unpack], check=True, timeout=300)
    return target


def outside(installed: Path, *arguments: str) -> str:
    """Run Python where neither the checkout nor an installed softid is in reach first."""
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=installed.parent,
        env=os.environ | {"PYTHONPATH": str(installed), "PYTHONSAFEPATH": "1"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_packages_are_exactly_ours(installed: Path) -> None:
    """No top-level `cli`, `tests` or data folder may land in somebody's site-packages."""
    found = {p.name for p in installed.iterdir() if not p.name.endswith(".dist-info")}
    assert found == {"softid", "softid_cli", "share", "bin"}


def test_every_module_is_in_the_wheel(installed: Path) -> None:
    """A subpackage forgotten by the packaging shows only to users; the checkout is the list."""
    for package, folder in (("softid", ROOT / "softid"), ("softid_cli", ROOT / "cli/softid_cli")):
        ours = {
            p.relative_to(folder).as_posix()
            for suffix in ("*.py", "*.json", "py.typed")
            for p in folder.rglob(suffix)
        }
        theirs = {
            p.relative_to(installed / package).as_posix()
            for p in (installed / package).rglob("*")
            if p.is_file() and p.suffix not in (".nbi", ".nbc", ".pyc")
        }
        assert theirs == ours


def test_the_commands_run(installed: Path) -> None:
    """Entry point, catalogue (which imports the kernels) and version of the wheel itself."""
    code = "from softid_cli.main import run; import softid; print(softid.__file__); run({!r})"
    where, version = outside(installed, "-c", code.format(["--version"])).splitlines()
    assert Path(where).is_relative_to(installed)
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert version == f"softid {declared['version']}"
    assert "muscle" in outside(installed, "-c", code.format(["models"]))


def test_the_bundled_logs_and_schemas_are_found(installed: Path) -> None:
    """`softid demo` and the self-check need the logs, `softid validate` the schema."""
    code = (
        "from softid.synthesis import bundled_datasets\n"
        "from softid.records.reading import load_schema\n"
        "print(bundled_datasets())\n"
        "print(load_schema('softid.params/1')['title'])"
    )
    folder, title = outside(installed, "-c", code).splitlines()
    assert Path(folder).is_relative_to(installed)
    assert (Path(folder) / "data" / "demo_step.csv").is_file()
    assert title == "softid.params/1"
