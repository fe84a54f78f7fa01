"""A diagnosis as diagnosis.json, with the fitted models beside it."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

from softid.diagnosis_results import Diagnosis
from softid.errors import Issue
from softid.records.params import (
    channel_entries,
    data_entries,
    fit_document,
    model_entry,
    parameter_entry,
    seed_entry,
    versions,
)
from softid.records.plain import Plain, dump_json, to_jsonable
from softid.records.reading import known_value, recorded_plots
from softid.records.writing import write_folder

DIAGNOSIS_SCHEMA = "softid.diagnosis/1"
RECORD = "diagnosis.json"
BASE_PARAMS = "params.json"
EXTENDED_PARAMS = "extended_params.json"


def save_diagnosis(
    diagnosis: Diagnosis, folder: Path, *, overwrite: bool = False
) -> tuple[Path, ...]:
    """Write a diagnosis and its models into a folder: all files, or none when the folder is new.

    Parameters
    ----------
    diagnosis
        What `softid.diagnose` returned.
    folder
        Target: it gets ``diagnosis.json``, ``params.json`` of the base model and, where causes were
        found, ``extended_params.json``.
    overwrite
        Whether files of those names may be replaced.

    Returns
    -------
    tuple of Path
        The files.

    Raises
    ------
    IdentificationError
        The fit of the base model did not succeed.
    OutputError
        A file exists and may not be replaced, or something cannot be written.
    """
    documents = diagnosis_files(diagnosis)
    files = {name: dump_json(document) for name, document in documents.items()}
    return write_folder(
        Path(folder), files, overwrite=overwrite, superseded=superseded(Path(folder))
    )


def diagnosis_files(diagnosis: Diagnosis) -> dict[str, dict[str, Plain]]:
    """File name within the folder of a diagnosis → content as plain values, the record first.

    An extended model that stopped short of its optimum is not written, and the record says so.

    Parameters
    ----------
    diagnosis
        What `softid.diagnose` returned.

    Raises
    ------
    IdentificationError
        The fit of the base model did not succeed.
    """
    models = {BASE_PARAMS: fit_document(diagnosis.base)}
    extended = diagnosis.extended
    if extended is not None and not extended.success:
        issue = Issue(
            "extended-not-converged",
            "warning",
            f"the extended model has no params.json: {extended.status.value}",
            "record the next experiment, or choose a simpler --model",
        )
        diagnosis = replace(diagnosis, extended=None, issues=(*diagnosis.issues, issue))
    elif extended is not None:
        models[EXTENDED_PARAMS] = fit_document(extended)
    record = diagnosis_document(diagnosis)
    if EXTENDED_PARAMS in models:
        record["extended_sha256"] = _sha256(dump_json(models[EXTENDED_PARAMS]))
    return {RECORD: record, **models}


def superseded(folder: Path) -> dict[str, str]:
    """Files that an earlier diagnosis left in a folder and a later one makes obsolete.

    Parameters
    ----------
    folder
        Folder of the results; there need be none.

    Returns
    -------
    dict
        File name → sha256 with which it was written: the plots and the extended model.
    """
    known = dict(recorded_plots(folder / RECORD))
    old = known_value(folder / RECORD, "extended_sha256")
    return known | {EXTENDED_PARAMS: old} if isinstance(old, str) else known


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def diagnosis_document(
    diagnosis: Diagnosis,
    *,
    base: str | None = BASE_PARAMS,
    extended: str | None = EXTENDED_PARAMS,
) -> dict[str, Plain]:
    """The content of diagnosis.json as plain values, as `softid/schemas/v1/diagnosis.json` says.

    Parameters
    ----------
    diagnosis
        What `softid.diagnose` returned.
    base, extended
        Where the params.json of both models are, relative to the record; None for nowhere.
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
        "extended": extended if diagnosis.extended is not None else None,
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
        "data": data_entries(fitted.fingerprints, fitted.statistics),
        "versions": versions(),
        "seed": seed_entry(fitted),
        "issues": to_jsonable(diagnosis.issues),
    }
