"""Scores of a model as validation.json."""

from __future__ import annotations

import os
from pathlib import Path

from softid.records.params import (
    channel_entries,
    data_entries,
    effect_entries,
    model_entry,
    versions,
)
from softid.records.plain import Plain, dump_json, to_jsonable
from softid.records.writing import write_atomic
from softid.results import Validation

VALIDATION_SCHEMA = "softid.validation/1"


def save_validation(
    validation: Validation,
    path: str | os.PathLike[str],
    *,
    params: str | os.PathLike[str] | None = None,
    overwrite: bool = False,
) -> None:
    """Write scores to ``validation.json``.

    Parameters
    ----------
    validation
        What `softid.validate` returned.
    path
        Target file; its folder must exist.
    params
        File of the model that was scored, named in the record.
    overwrite
        Whether a file of that name may be replaced.

    Raises
    ------
    OutputError
        The file cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import softid
    >>> from softid.synthesis import bundled_datasets
    >>> log = softid.load(bundled_datasets() / "data" / "oscillator_steps.csv")
    >>> found = softid.fit(log, model="oscillator")
    >>> scores = softid.validate(found, log, threshold_percent=90.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_validation(scores, pathlib.Path(folder, "validation.json"))
    ...     [file.name for file in pathlib.Path(folder).iterdir()]
    ['validation.json']
    """
    document = validation_document(validation, params=params)
    write_atomic(Path(path), dump_json(document), overwrite=overwrite)


def validation_document(
    validation: Validation, *, params: str | os.PathLike[str] | None = None
) -> dict[str, Plain]:
    """The content of validation.json, as `softid/schemas/v1/validation.json` says.

    Parameters
    ----------
    validation
        What `softid.validate` returned.
    params
        File of the model that was scored.
    """
    return {
        "schema": VALIDATION_SCHEMA,
        "params": None if params is None else os.fspath(params),
        "model": model_entry(validation.model),
        "effects": effect_entries(validation.model),
        "input": validation.input,
        "outputs": list(validation.outputs),
        "channels": channel_entries(
            validation.input, validation.simulations, validation.statistics
        ),
        "threshold_percent": to_jsonable(validation.threshold_percent),
        "passed": validation.passed,
        "statistics": to_jsonable(validation.statistics),
        "nuisances": to_jsonable(validation.nuisances),
        "data": data_entries(
            validation.fingerprints, validation.statistics, validation.simulations
        ),
        "versions": versions(),
        "issues": to_jsonable(validation.issues),
    }
