"""A fit as params.json."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path

from softid.errors import IdentificationError
from softid.fingerprint import data_fingerprint, facts_fingerprint
from softid.records.plain import (
    Plain,
    dump_json,
    record_sha256,
    to_jsonable,
)
from softid.records.writing import write_atomic
from softid.results import FitResult, FitStatistics, ModelSpec, ParameterEstimate, Simulation

PARAMS_SCHEMA = "softid.params/1"

_LIBRARIES = ("softid", "numpy", "scipy", "numba")


def save_fit(result: FitResult, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
    """Write a fit to ``params.json``.

    Parameters
    ----------
    result
        A fit that reached its optimum.
    path
        Target file; its folder must exist.
    overwrite
        Whether a file of that name may be replaced.

    Raises
    ------
    IdentificationError
        The fit did not succeed, so that its values are not parameters of anything.
    OutputError
        The file cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import softid
    >>> from softid.synthesis import bundled_datasets
    >>> log = softid.load(bundled_datasets() / "data" / "oscillator_steps.csv")
    >>> found = softid.fit(log, model="oscillator")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_fit(found, pathlib.Path(folder, "params.json"))
    ...     [file.name for file in pathlib.Path(folder).iterdir()]
    ['params.json']
    """
    write_atomic(Path(path), dump_json(fit_document(result)), overwrite=overwrite)


def fit_document(result: FitResult) -> dict[str, Plain]:
    """The content of params.json as plain values, as `softid/schemas/v1/params.json` says.

    Parameters
    ----------
    result
        A fit that reached its optimum.

    Raises
    ------
    IdentificationError
        The fit did not succeed.
    """
    if not result.success:
        raise IdentificationError(
            f"there are no parameters to write: {result.status.value}",
            remedy="fix or bound a parameter, choose a simpler model, or add a log",
        )
    document: dict[str, Plain] = {
        "schema": PARAMS_SCHEMA,
        "model": model_entry(result.model),
        "input": result.input,
        "outputs": list(result.outputs),
        "channels": channel_entries(result.input, result.simulations, result.statistics),
        "parameters": [parameter_entry(p) for p in result.parameters],
        "derived": {
            k: {
                "value": to_jsonable(v),
                "unit": u,
                "stderr": to_jsonable(result.derived_stderr.get(k)),
            }
            for k, (v, u) in result.derived.items()
        },
        "effects": effect_entries(result.model),
        "scale": scale_entry(result.model),
        "nuisances": to_jsonable(result.nuisances),
        "statistics": to_jsonable(result.statistics),
        "noise": to_jsonable(result.noise),
        "fitted_range": to_jsonable(result.fitted_range),
        "data": data_entries(result.fingerprints, result.statistics, result.simulations),
        "fit": {
            "status": to_jsonable(result.status),
            "message": result.message,
            "choice": result.choice,
            "evaluations": result.evaluations,
            "condition_number": to_jsonable(result.condition_number),
            "aic": to_jsonable(result.aic),
            "bic": to_jsonable(result.bic),
            "free": list(result.free),
            "covariance": to_jsonable(result.covariance),
            "correlation": to_jsonable(result.correlation),
        },
        "versions": versions(),
        "seed": result.seed,
        "options": options_entry(result),
        "issues": to_jsonable(result.issues),
        "content_sha256": model_fingerprint(result.model, result.values),
    }
    return document | {"record_sha256": record_sha256(document)}


def options_entry(result: FitResult) -> dict[str, Plain]:
    """How the fit took its input; the averaging of its noise is told only where it was done."""
    options: dict[str, Plain] = {"intersample": result.intersample}
    return options if result.input_noise is None else {**options, "input_noise": result.input_noise}


def model_entry(spec: ModelSpec) -> Plain:
    """Model name and options."""
    return {"name": spec.name, "options": to_jsonable(dict(spec.options))}


def effect_entries(spec: ModelSpec) -> list[Plain]:
    """The effects in the order in which they act, each with the names of its parameters."""
    if not spec.effects:
        return []
    from softid.effects import Scale  # only an extended model needs the catalogue
    from softid.effects.building import effect_of
    from softid.effects.extension.extended_model import extended_name

    scale = Scale(**spec.scale)  # type: ignore[arg-type]
    return [
        {
            "key": effect.key,
            "name": effect.name,
            "stage": effect.stage,
            "law": effect.law_at(scale),
            "parameters": [extended_name(effect, name) for name in effect.parameters(scale)],
        }
        for effect in map(effect_of, spec.effects)
    ]


def scale_entry(spec: ModelSpec) -> Plain:
    """Sizes that the effects' bounds and knots go by; null without effects."""
    return to_jsonable(dict(spec.scale)) if spec.effects else None


def model_fingerprint(spec: ModelSpec, values: Mapping[str, float]) -> str:
    """Fingerprint of a model, its options, its effects with their scale, and its values.

    It tells a file that was edited by hand from one that softid wrote; it is no protection
    against someone who computes it anew.
    """
    facts: dict[str, Plain] = {
        "model": spec.name,
        "options": to_jsonable(dict(spec.options)),
        "values": {key: repr(float(value)) for key, value in values.items()},
    }
    if spec.effects:
        scale = {name: v if isinstance(v, str) else float(v) for name, v in spec.scale.items()}
        facts |= {"effects": list(spec.effects), "scale": to_jsonable(scale)}
    return facts_fingerprint(facts)


def parameter_entry(estimate: ParameterEstimate) -> Plain:
    """One parameter; its value keeps every digit."""
    return to_jsonable(estimate)


def channel_entries(
    input_name: str,
    simulations: tuple[Simulation, ...],
    statistics: tuple[FitStatistics, ...],
) -> dict[str, Plain]:
    """Channel → unit of its numbers, and the unit of the file in which people know it."""
    entries: dict[str, Plain] = {}
    for simulation in simulations[:1]:
        entries[input_name] = {"unit": simulation.input_unit}
        for name, unit in simulation.units.items():
            entries[name] = {"unit": unit}
    for row in statistics:
        entries[row.channel] = {
            "unit": row.unit,
            "display_unit": row.display_unit,
            "display_factor": row.display_factor,
        }
    return entries


def data_entries(
    fingerprints: Mapping[str, str],
    statistics: tuple[FitStatistics, ...],
    simulations: tuple[Simulation, ...],
) -> list[Plain]:
    """One entry per log: name, fingerprints of file and samples, and whether it was fitted.

    That of the file is null for arrays, that of the samples where they are not kept.
    """
    fitted = {row.log: row.in_sample for row in statistics}
    data = {s.log: data_fingerprint(s.time_s, s.measured) for s in simulations if s.measured}
    return [
        {
            "log": log,
            "sha256": sha256 or None,
            "data_sha256": data.get(log),
            "in_sample": fitted.get(log, True),
        }
        for log, sha256 in fingerprints.items()
    ]


def versions() -> dict[str, Plain]:
    """Versions of softid and of the libraries on which its numbers rest; null if unknown."""
    found: dict[str, Plain] = {"python": platform.python_version()}
    for name in _LIBRARIES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:  # run from a source tree that is not installed
            found[name] = None
    return found
