"""A diagnosis as diagnosis.json, with the fitted models beside it."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from softid.diagnosis_results import Diagnosis
from softid.errors import Issue
from softid.fingerprint import content_fingerprint
from softid.records.params import (
    channel_entries,
    data_entries,
    fit_document,
    model_entry,
    parameter_entry,
    versions,
)
from softid.records.plain import Plain, dump_json, to_jsonable
from softid.records.reading import known_value, recorded_plots
from softid.records.writing import write_folder

DIAGNOSIS_SCHEMA = "softid.diagnosis/1"
RECORD = "diagnosis.json"
BASE_PARAMS = "params.json"
EXTENDED_PARAMS = "extended_params.json"
FILES = {"base": BASE_PARAMS, "extended": EXTENDED_PARAMS}
"""Model of a diagnosis → its file."""


def save_diagnosis(
    diagnosis: Diagnosis, folder: str | os.PathLike[str], *, overwrite: bool = False
) -> tuple[Path, ...]:
    """Write a diagnosis and its models into a folder: all files, or none when the folder is new.

    Parameters
    ----------
    diagnosis
        What `softid.diagnose` returned.
    folder
        Target: it gets ``diagnosis.json``, ``params.json`` of the base model and, where causes were
        found, ``extended_params.json``; no file of a model that stopped short of its optimum.
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

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import softid
    >>> from softid.synthesis import bundled_datasets
    >>> log = softid.load(bundled_datasets() / "data" / "oscillator_steps.csv")
    >>> found = softid.diagnose(log, model="oscillator", effects=["sensor_drift"])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [file.name for file in save_diagnosis(found, pathlib.Path(folder, "out"))]
    ['diagnosis.json', 'params.json']
    """
    documents = diagnosis_files(diagnosis)
    files = {name: dump_json(document) for name, document in documents.items()}
    return write_folder(
        Path(folder), files, overwrite=overwrite, superseded=superseded(Path(folder))
    )


def diagnosis_files(diagnosis: Diagnosis) -> dict[str, dict[str, Plain]]:
    """File name within the folder of a diagnosis → content as plain values, the record first.

    A model that stopped short of its optimum is not written, and the record says so. What is wrong
    with a base is told all the same: the more it misses, the less of an optimum it has.

    Parameters
    ----------
    diagnosis
        What `softid.diagnose` returned.
    """
    models: dict[str, dict[str, Plain]] = {}
    sums: dict[str, Plain] = {}
    for what, fit in (("base", diagnosis.base), ("extended", diagnosis.extended)):
        if fit is None:
            continue
        if fit.success:
            name = FILES[what]
            models[name] = fit_document(fit)
            sums[f"{what}_sha256"] = content_fingerprint(dump_json(models[name]))
            continue
        issue = Issue(
            f"{what}-not-converged",
            "warning",
            f"the {what} model has no params.json: {fit.status.value}",
            "record the next experiment, or choose a simpler --model",
        )
        diagnosis = replace(diagnosis, issues=(*diagnosis.issues, issue))
        if what == "extended":
            diagnosis = replace(diagnosis, extended=None)
    base = BASE_PARAMS if diagnosis.base.success else None
    return {RECORD: diagnosis_document(diagnosis, base=base) | sums, **models}


def superseded(folder: Path) -> dict[str, str]:
    """Files that an earlier diagnosis left in a folder and a later one makes obsolete.

    Parameters
    ----------
    folder
        Folder of the results; there need be none.

    Returns
    -------
    dict
        File name → sha256 with which it was written: the plots and both models.
    """
    known = dict(recorded_plots(folder / RECORD))
    sums = {name: known_value(folder / RECORD, f"{what}_sha256") for what, name in FILES.items()}
    return known | {name: old for name, old in sums.items() if isinstance(old, str)}


def diagnosis_document(diagnosis: Diagnosis, *, base: str | None) -> dict[str, Plain]:
    """The content of diagnosis.json as plain values, as `softid/schemas/v1/diagnosis.json` says.

    Parameters
    ----------
    diagnosis
        What `softid.diagnose` returned.
    base
        Where the params.json of the base is, relative to the record; None for nowhere.
    """
    fitted = diagnosis.base
    final = diagnosis.extended or fitted
    return {
        "schema": DIAGNOSIS_SCHEMA,
        "verdict": to_jsonable(diagnosis.verdict),
        "summary": diagnosis.summary,
        "causes": to_jsonable(diagnosis.causes),
        "descriptive": to_jsonable(diagnosis.descriptive),
        "alternatives": to_jsonable(diagnosis.alternatives),
        "remainder": to_jsonable(diagnosis.remainder),
        "next_experiment": diagnosis.next_experiment,
        "extended": EXTENDED_PARAMS if diagnosis.extended is not None else None,
        "gains": to_jsonable(diagnosis.gains),
        "gain_ci95": to_jsonable(diagnosis.gain_ci95),
        "evidence": to_jsonable(diagnosis.evidence),
        "base": {
            "params": base,
            "model": model_entry(fitted.model),
            "parameters": [parameter_entry(p) for p in fitted.parameters],
            "statistics": to_jsonable(fitted.statistics),
        },
        "statistics": to_jsonable(final.statistics),
        "input": fitted.input,
        "outputs": list(fitted.outputs),
        "channels": channel_entries(fitted.input, fitted.simulations, fitted.statistics),
        "data": data_entries(fitted.fingerprints, fitted.statistics, fitted.simulations),
        "versions": versions(),
        "seed": fitted.seed,
        "issues": to_jsonable(diagnosis.issues),
    }
