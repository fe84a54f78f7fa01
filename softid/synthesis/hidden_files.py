"""Files of a pair of logs with hidden effects: two CSVs and the truth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from softid.fingerprint import content_fingerprint
from softid.records import dump_json, write_folder
from softid.synthesis.hidden import HIDDEN
from softid.synthesis.hidden_log import HiddenLog, HiddenPair
from softid.synthesis.synthetic import csv_bytes

SCHEMA = "softid.hidden/1"
TRUTH = "truth.json"


def hidden_csv(made: HiddenLog) -> bytes:
    """The CSV of one recording: header, decimal points, line feeds, empty cells where blank.

    Parameters
    ----------
    made
        The recording.

    Examples
    --------
    >>> from softid.synthesis.hidden_log import hidden_pair
    >>> hidden_csv(hidden_pair(protocol="step").train).splitlines()[0]
    b'time_s,pressure_kpa,contraction_mm'
    """
    return csv_bytes(made.time_s, made.columns, made.decimals)


def truth_document(pair: HiddenPair) -> dict[str, Any]:
    """What is true of a pair, as plain values.

    Parameters
    ----------
    pair
        The pair.

    Returns
    -------
    dict
        Actuator and effects with parameters and units, the sizes that scaled them, the rig, and
        per log the sensors' noise and zero.
    """
    effects = [
        {
            "effect": name,
            "stage": HIDDEN[name].stage,
            "relation": HIDDEN[name].relation,
            "named_rightly_by": list(HIDDEN[name].names),
            "law": HIDDEN[name].law,
            "parameters": _with_units(values, pair.units[name]),
        }
        for name, values in pair.hidden.items()
    ]
    return {
        "schema": SCHEMA,
        "seed": pair.seed,
        "size": pair.size,
        "protocol": pair.protocol,
        "model": pair.actuator.model,
        "x_unit": pair.actuator.x_unit,
        "parameters": _with_units(pair.actuator.values, pair.actuator.units),
        "hidden": effects,
        "sizes": vars(pair.sizes),
        "rig": vars(pair.rig),
        "logs": [_log_entry(made) for made in (pair.train, pair.hold_out)],
    }


def write_hidden_pair(
    pair: HiddenPair, folder: Path, *, overwrite: bool = False
) -> tuple[Path, ...]:
    """Write ``train.csv``, ``hold_out.csv`` and ``truth.json``, all of them or none.

    Parameters
    ----------
    pair
        The pair.
    folder
        Target; it is made when missing.
    overwrite
        Whether files of those names may be replaced.

    Returns
    -------
    tuple of Path
        The files.

    Raises
    ------
    OutputError
        A file exists and may not be replaced, or something cannot be written.
    """
    files: dict[str, str | bytes] = {
        _file_name(made): hidden_csv(made) for made in (pair.train, pair.hold_out)
    }
    files[TRUTH] = dump_json(truth_document(pair))
    return write_folder(folder, files, overwrite=overwrite)


def _file_name(made: HiddenLog) -> str:
    return f"{made.name}.csv"


def _log_entry(made: HiddenLog) -> dict[str, Any]:
    return {
        "role": made.name,
        "file": _file_name(made),
        "sha256": content_fingerprint(hidden_csv(made)),
        "rows": made.time_s.size,
        "sigma": dict(made.sigma),
        "zero": made.zero,
    }


def _with_units(values: Any, units: Any) -> dict[str, dict[str, Any]]:
    return {name: {"value": value, "unit": units[name]} for name, value in values.items()}
