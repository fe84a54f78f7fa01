"""Folders of synthetic logs: where the bundled one lies, making one, writing it, checking it."""

from __future__ import annotations

import json
import sys
import sysconfig
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from softid.errors import InputError, OutputError, UsageError
from softid.records import write_folder
from softid.synthesis.manifest import (
    DATA,
    MANIFEST,
    RECIPES,
    manifest_entry,
    manifest_text,
    read_entries,
)
from softid.synthesis.recipe import parse_recipe, read_recipe_bytes
from softid.synthesis.synthetic import SyntheticLog, synthesize, to_csv_bytes

FOLDER = "datasets_synthetic"
_SHARED = Path("share", "softid", FOLDER)

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False)
class DataSet:
    """Synthetic logs, ready to be written.

    Attributes
    ----------
    logs
        The logs with their truth.
    recipes, data
        File name → bytes, for the two subfolders.
    entries
        Entries of the manifest, one per log.
    """

    logs: tuple[SyntheticLog, ...]
    recipes: Mapping[str, bytes]
    data: Mapping[str, bytes]
    entries: tuple[Mapping[str, Any], ...]


def bundled_datasets() -> Path:
    """The folder of synthetic logs that comes with softid.

    It lies beside the package in a checkout and under ``share/softid`` of the environment where
    softid is installed.

    Raises
    ------
    InputError
        It is at none of those places.
    """
    beside = Path(__file__).resolve().parents[2]
    roots = [beside, Path(sysconfig.get_path("data")), Path(sys.prefix), Path(sys.base_prefix)]
    user = [name for name in sysconfig.get_scheme_names() if name.endswith("_user")]
    roots += [Path(sysconfig.get_path("data", scheme)) for scheme in user]
    candidates = [beside / FOLDER, *(root / _SHARED for root in dict.fromkeys(roots))]
    for folder in candidates:
        if (folder / RECIPES).is_dir():
            return folder
    raise InputError(
        "the synthetic logs that come with softid are not there",
        where=", ".join(str(folder) for folder in candidates),
        remedy="install softid again, or work in a checkout",
    )


def bundled_recipes() -> tuple[Path, ...]:
    """The recipes of the bundled logs, by name.

    Raises
    ------
    InputError
        softid was installed without them.
    """
    return tuple(sorted((bundled_datasets() / RECIPES).glob("*.toml")))


def make_dataset(
    recipes: Sequence[Path], *, seed: int | None = None, progress: Progress | None = None
) -> DataSet:
    """Make the logs of several recipes; nothing is written.

    Parameters
    ----------
    recipes
        TOML files.
    seed
        Used in place of every recipe's own.
    progress
        Called with the name of each log and the fraction done.

    Raises
    ------
    InputError
        A recipe is wrong.
    UsageError
        Two recipes have one name.
    """
    contents = {path: read_recipe_bytes(path) for path in recipes}
    read = {path: parse_recipe(content, where=path.name) for path, content in contents.items()}
    names = [recipe.name for recipe in read.values()]
    files = [path.name for path in read]
    for found in (names, files):
        twice = sorted({n for n in found if found.count(n) > 1})
        if twice:
            raise UsageError("two recipes have one name", value=twice[0], remedy="rename one")
    logs, data, entries = [], {}, []
    for number, (path, recipe) in enumerate(read.items()):
        if progress is not None:
            progress(recipe.name, number / len(read))
        log = synthesize(recipe, seed=seed)
        csv = to_csv_bytes(log)
        logs.append(log)
        data[f"{recipe.name}.csv"] = csv
        entries.append(manifest_entry(log, recipe_file=path.name, csv=csv))
    return DataSet(
        logs=tuple(logs),
        recipes=MappingProxyType({path.name: content for path, content in contents.items()}),
        data=MappingProxyType(data),
        entries=tuple(entries),
    )


def write_dataset(dataset: DataSet, folder: Path, *, overwrite: bool = False) -> tuple[Path, ...]:
    """Write recipes, CSVs and manifest; logs that the folder's manifest already knows stay in it.

    Parameters
    ----------
    dataset
        What to write.
    folder
        Made when missing.
    overwrite
        Whether files of the same names may be replaced.

    Returns
    -------
    tuple of Path
        The CSVs and the manifest.

    Raises
    ------
    OutputError
        A file exists and may not be replaced, or cannot be written; then nothing was written.
    """
    recipes = {
        name: content
        for name, content in dataset.recipes.items()
        if not _holds(folder / RECIPES / name, content)
    }
    if not overwrite:
        for name in (*(f"{RECIPES}/{n}" for n in recipes), *(f"{DATA}/{n}" for n in dataset.data)):
            _refuse_existing(folder / name)
        _refuse_existing(folder / MANIFEST)
    known = read_entries(folder) if (folder / MANIFEST).is_file() else {}
    known.update({entry["name"]: dict(entry) for entry in dataset.entries})
    files: dict[str, str | bytes] = {f"{RECIPES}/{name}": recipes[name] for name in recipes}
    files |= {f"{DATA}/{name}": content for name, content in dataset.data.items()}
    files[MANIFEST] = manifest_text(known.values())
    return write_folder(folder, files, overwrite=overwrite)[len(recipes) :]


def check_dataset(
    folder: Path, *, recipes: Sequence[Path] = (), progress: Progress | None = None
) -> tuple[str, ...]:
    """Make the logs of a folder again and compare them with its manifest and files.

    Parameters
    ----------
    folder
        With manifest.json and data; recipes too unless they are given.
    recipes
        Check these alone; none means all of the folder.
    progress
        As in `make_dataset`.

    Returns
    -------
    tuple of str
        One sentence per difference; empty when all is equal.

    Raises
    ------
    InputError
        The manifest or a recipe cannot be read.
    """
    known = read_entries(folder)
    paths = list(recipes) or sorted((folder / RECIPES).glob("*.toml"))
    found: list[str] = []
    for number, path in enumerate(paths):
        name = parse_recipe(read_recipe_bytes(path), where=path.name).name
        if name not in known:
            found.append(f"{path.name}: the manifest has no log {name}.")
            continue
        if progress is not None:
            progress(name, number / len(paths))
        made = make_dataset([path], seed=known[name].get("seed"))
        found += _differences(folder, name, known[name], made)
    if not recipes:
        used = {entry.get("recipe") for entry in known.values()}
        lost = sorted(str(r) for r in used - {f"{RECIPES}/{path.name}" for path in paths})
        found += [f"{recipe}: the recipe is missing." for recipe in lost]
    return tuple(found)


def _differences(folder: Path, name: str, entry: Mapping[str, Any], made: DataSet) -> list[str]:
    found = []
    fresh = json.loads(json.dumps(made.entries[0]))  # lists for tuples, as the manifest reads back
    (csv,) = made.data.values()
    file = folder / DATA / f"{name}.csv"
    if fresh["sha256"] != entry.get("sha256"):
        found.append(f"{name}: made again, the log has other bytes than the manifest says.")
    keys = [key for key in fresh if key != "sha256" and fresh[key] != entry.get(key)]
    if keys:
        found.append(f"{name}: the manifest says something else about {', '.join(keys)}.")
    if not file.is_file():
        found.append(f"{name}: {file} is missing.")
    elif file.read_bytes() != csv:
        found.append(f"{name}: {file} has other bytes than the log made again.")
    return found


def _holds(path: Path, content: bytes) -> bool:
    return path.is_file() and path.read_bytes() == content


def _refuse_existing(path: Path) -> None:
    if path.exists():
        raise OutputError(
            "the file exists already",
            where=str(path),
            remedy="say --force (overwrite=True in Python) to replace it, or name another folder",
        )
