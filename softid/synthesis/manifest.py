"""The manifest of a folder of synthetic logs: truth, noise, seed and fingerprint of each log."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from softid.errors import InputError
from softid.fingerprint import content_fingerprint
from softid.synthesis.synthetic import SyntheticLog

MANIFEST = "manifest.json"
SCHEMA = "softid.synthetic/1"
RECIPES = "recipes"
DATA = "data"
_ABOUT = (
    "Logs made by `softid synthesize`. Values with assumed = true are assumptions of softid, "
    "printed in no paper."
)


@dataclass(frozen=True)
class KnownLog:
    """One log of a manifest.

    Attributes
    ----------
    name
        Stem of the CSV.
    file
        The CSV.
    recipe
        The recipe that made it.
    seed
        Seed used.
    sha256
        Fingerprint of the CSV.
    model
        Law behind it.
    x_unit
        Unit of x in that law.
    group, role
        Logs of one group share their truth; role is ``"fit"`` or ``"hold_out"``.
    outputs
        Channels besides the pressures, in the order of the columns.
    truth
        Parameter → true value; for a polynomial ``"angle.p1"``.
    units
        Parameter → unit.
    sigma
        CSV column → standard deviation of what the sensor added.
    zero
        CSV column → sensor zero.
    fixed_length_mm, diameter_mm
        Arc geometry, or None.
    """

    name: str
    file: Path
    recipe: Path
    seed: int
    sha256: str
    model: str
    x_unit: str
    group: str
    role: str
    outputs: tuple[str, ...]
    truth: Mapping[str, float]
    units: Mapping[str, str]
    sigma: Mapping[str, float]
    zero: Mapping[str, float]
    fixed_length_mm: float | None
    diameter_mm: float | None


def manifest_entry(synthetic: SyntheticLog, *, recipe_file: str, csv: bytes) -> dict[str, Any]:
    """The manifest's entry of one log as plain values.

    Parameters
    ----------
    synthetic
        The log.
    recipe_file
        Name of its recipe in the folder of recipes.
    csv
        Bytes of its CSV.
    """
    recipe = synthetic.recipe
    assumed = set(recipe.assumed)
    geometry = None
    if recipe.geometry is not None:
        geometry = {
            name: {"value": value, "unit": "mm", "assumed": name in assumed}
            for name, value in asdict(recipe.geometry).items()
        }
    entry = {
        "name": synthetic.name,
        "title": recipe.title,
        "file": f"{DATA}/{synthetic.name}.csv",
        "sha256": content_fingerprint(csv),
        "recipe": f"{RECIPES}/{recipe_file}",
        "seed": synthetic.seed,
        "rows": int(synthetic.time_s.size),
        "rate_hz": recipe.sampling.rate_hz,
        "group": recipe.group or synthetic.name,
        "role": recipe.role,
        "model": recipe.model,
        "x_unit": recipe.x_unit if recipe.model != "polynomial" else None,
        "outputs": list(recipe.output_channels),
        "truth": {
            name: {
                "value": synthetic.truth[name],
                "unit": unit,
                "assumed": name in assumed,
            }
            for name, unit in synthetic.units.items()
        },
        "geometry": geometry,
        "sensors": {
            column: {**asdict(sensor), "sigma": float(f"{sensor.sigma:.6g}")}
            for column, sensor in recipe.sensors.items()
        },
        "notes": list(recipe.notes),
    }
    if recipe.actuator is not None:
        entry["actuator"] = {
            name: {"value": value, "assumed": name in assumed}
            for name, value in asdict(recipe.actuator).items()
        }
    return entry


def manifest_text(entries: Iterable[Mapping[str, Any]]) -> str:
    """The manifest as JSON, logs in the order of their names."""
    ordered = sorted(entries, key=lambda entry: str(entry["name"]))
    document = {"schema": SCHEMA, "about": _ABOUT, "logs": ordered}
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def read_entries(folder: Path) -> dict[str, dict[str, Any]]:
    """The entries of a folder's manifest by the name of the log.

    Raises
    ------
    InputError
        There is no manifest, it is of another version or damaged.
    """
    path = folder / MANIFEST
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(
            f"the manifest cannot be read: {error.strerror or error}",
            where=str(path),
            remedy="name a folder that `softid synthesize` has written",
        ) from error
    except ValueError as error:
        raise _damaged(path, str(error)) from error
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        found = document.get("schema") if isinstance(document, dict) else None
        raise InputError(
            "this manifest is of another kind or version",
            where=str(path),
            value=found,
            remedy=f"make the folder again for {SCHEMA}",
        )
    try:
        return {entry["name"]: entry for entry in document["logs"]}
    except (KeyError, TypeError) as error:
        raise _damaged(path, f"{error}") from error


def read_manifest(folder: Path) -> tuple[KnownLog, ...]:
    """The logs of a folder with their truth.

    Parameters
    ----------
    folder
        Written by `softid synthesize`, or `softid.synthesis.bundled_datasets()`.

    Raises
    ------
    InputError
        There is no manifest, it is of another version or damaged.

    Examples
    --------
    >>> from softid.synthesis import bundled_datasets
    >>> {log.name: log for log in read_manifest(bundled_datasets())}["muscle_sine_025"].role
    'hold_out'
    """
    entries = read_entries(folder)
    try:
        return tuple(_known_log(folder, entry) for entry in entries.values())
    except (KeyError, TypeError) as error:
        raise _damaged(folder / MANIFEST, f"{error}") from error


def _known_log(folder: Path, entry: Mapping[str, Any]) -> KnownLog:
    geometry = entry["geometry"] or {}
    lengths = {name: item["value"] for name, item in geometry.items()}
    return KnownLog(
        name=entry["name"],
        file=folder / entry["file"],
        recipe=folder / entry["recipe"],
        seed=entry["seed"],
        sha256=entry["sha256"],
        model=entry["model"],
        x_unit=entry["x_unit"] or "",
        group=entry["group"],
        role=entry["role"],
        outputs=tuple(entry["outputs"]),
        truth={name: item["value"] for name, item in entry["truth"].items()},
        units={name: item["unit"] for name, item in entry["truth"].items()},
        sigma={name: item["sigma"] for name, item in entry["sensors"].items()},
        zero={name: item["zero"] for name, item in entry["sensors"].items()},
        fixed_length_mm=lengths.get("fixed_length_mm"),
        diameter_mm=lengths.get("diameter_mm"),
    )


def _damaged(path: Path, detail: str) -> InputError:
    return InputError(
        f"the manifest is damaged: {detail}", where=str(path), remedy="make the folder again"
    )
