"""params.json read back as a model with values."""

from __future__ import annotations

import math
import typing
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from softid.errors import InputError, Issue, SoftidError, UsageError
from softid.fingerprint import data_fingerprint
from softid.intersample import AVERAGED, InputNoise, Intersample, recorded_intersample
from softid.records.agreement import require_units
from softid.records.params import PARAMS_SCHEMA, model_fingerprint
from softid.records.plain import record_sha256
from softid.records.reading import read_document
from softid.results import FitResult, LogNuisance, ModelSpec, SegmentStart
from softid.tie_expressions import names_in_tie

if TYPE_CHECKING:
    from softid.log import Log
    from softid.models.base import Model


@dataclass(frozen=True, eq=False)
class SavedModel:
    """A fitted model read back from its file.

    Attributes
    ----------
    path
        The file; "this fit" for one that was never written.
    model
        The model, its options and its effects.
    input, outputs
        Roles of the channels in the fit.
    units
        Channel → unit of its numbers in the file.
    display
        Channel → (unit, factor to it) in which the fitted logs recorded it.
    values
        Parameter name → value, in the model's order.
    bounds
        Parameter name → (lower, upper); infinite where there was none.
    nuisances
        Log name → what was estimated for that log alone.
    fitted_range
        Channel → (smallest, largest) value that the fitted logs reached.
    fingerprints
        Log name → sha256 of its file; None for a log that was given as arrays.
    fitted_logs
        Names of the logs that the parameters were fitted to; the others were held out.
    issues
        What was noticed in reading, such as an edit by hand.
    intersample
        What the fit took the input to do between its samples; None for straight.
    input_noise
        ``"averaged"`` where the fit, as that of a diagnosis, averaged the noise of its input.
    data_fingerprints
        Log name → sha256 of its times and measured samples, where the record has it.
    """

    path: str
    model: ModelSpec
    input: str
    outputs: tuple[str, ...]
    units: Mapping[str, str]
    display: Mapping[str, tuple[str, float]]
    values: Mapping[str, float]
    bounds: Mapping[str, tuple[float, float]]
    nuisances: Mapping[str, LogNuisance]
    fitted_range: Mapping[str, tuple[float, float]]
    fingerprints: Mapping[str, str | None]
    fitted_logs: tuple[str, ...]
    issues: tuple[Issue, ...] = ()
    intersample: Intersample | None = None
    input_noise: InputNoise | None = None
    data_fingerprints: Mapping[str, str | None] = field(default_factory=dict)

    @classmethod
    def of(cls, result: FitResult) -> SavedModel:
        """What `save_fit` and `load_params` would make of a fit, without a file.

        Parameters
        ----------
        result
            A fit, whether it reached its optimum or not.
        """
        fitted = {row.log: row.in_sample for row in result.statistics}
        simulated = result.simulations
        units = {name: unit for s in simulated[:1] for name, unit in s.units.items()}
        return cls(
            path="this fit",
            model=result.model,
            input=result.input,
            outputs=result.outputs,
            units={s.input_name: s.input_unit for s in simulated[:1]} | units,
            display={
                row.channel: (row.display_unit, row.display_factor) for row in result.statistics
            },
            values=result.values,
            bounds={
                p.name: (
                    -math.inf if p.lower is None else p.lower,
                    math.inf if p.upper is None else p.upper,
                )
                for p in result.parameters
            },
            nuisances={nuisance.log: nuisance for nuisance in result.nuisances},
            fitted_range=result.fitted_range,
            fingerprints={log: sha256 or None for log, sha256 in result.fingerprints.items()},
            fitted_logs=tuple(log for log in result.fingerprints if fitted.get(log, True)),
            intersample=result.intersample,
            input_noise=result.input_noise,
            data_fingerprints={
                s.log: data_fingerprint(s.time_s, s.measured) for s in simulated if s.measured
            },
        )

    def build_model(self) -> Model:
        """The model with its options, ready for `softid.simulate`.

        Raises
        ------
        InputError
            This softid has no such model, option or effect.
        """
        return _build(self.model, where=self.path)

    def nuisance_for(self, log: Log) -> LogNuisance:
        """Sensor zeros and initial states with which to simulate a log.

        Parameters
        ----------
        log
            A log that was fitted or held out, known by the fingerprint of its file, or of its
            samples where it was given as arrays, gets its own back. Any other starts at rest with
            the mean zero of the fitted logs.
        """
        recorded = self.fingerprints if log.source else self.data_fingerprints
        sought = self._fingerprint(log)
        for name, known in recorded.items():
            if known is not None and known == sought and name in self.nuisances:
                return self.nuisances[name]
        fitted = [self.nuisances[name] for name in self.fitted_logs if name in self.nuisances]
        zero = {
            name: sum(n.zero.get(name, 0.0) for n in fitted) / len(fitted) if fitted else 0.0
            for name in self.outputs
        }
        return LogNuisance(log.name, zero, dict.fromkeys(zero), ())

    def _fingerprint(self, log: Log) -> str | None:
        """Of the file, else of what is recorded of the model's outputs."""
        if log.source:
            return log.source.sha256
        there = {name: log.channels[name].values for name in self.outputs if name in log.channels}
        return data_fingerprint(log.time_s, there)


def load_params(path: Path | str) -> SavedModel:
    """Read ``params.json``.

    Parameters
    ----------
    path
        A file that `save_fit` wrote.

    Returns
    -------
    SavedModel
        Model, values and what they were fitted to. Values that were changed by hand but are still
        valid give an issue, for the stated errors and scores are no longer theirs.

    Raises
    ------
    InputError
        The file cannot be read, is of another version, breaks its schema, or names a model,
        option, effect or parameter that does not exist, a value outside its bounds or a unit that
        is not the model's.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import softid
    >>> from softid.synthesis import bundled_datasets
    >>> log = softid.load(bundled_datasets() / "data" / "oscillator_steps.csv")
    >>> found = softid.fit(log, model="oscillator")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     softid.save_fit(found, pathlib.Path(folder, "params.json"))
    ...     saved = load_params(pathlib.Path(folder, "params.json"))
    >>> saved.model.name, saved.values == found.values
    ('oscillator', True)
    """
    path = Path(path)
    document = read_document(path, schema=PARAMS_SCHEMA)
    where = str(path)
    spec = _spec(document)
    model = _build(spec, where=where)
    values, bounds = _parameters(document["parameters"], model.parameters().names, where=where)
    require_units(document, model, where=where)
    data = document["data"]
    return SavedModel(
        path=where,
        model=spec,
        input=document["input"],
        outputs=tuple(document["outputs"]),
        units={name: entry["unit"] for name, entry in document["channels"].items()},
        display={
            name: (entry["display_unit"], float(entry["display_factor"]))
            for name, entry in document["channels"].items()
            if "display_unit" in entry
        },
        values=values,
        bounds=bounds,
        nuisances={entry["log"]: _nuisance(entry) for entry in document["nuisances"]},
        fitted_range={k: (float(a), float(b)) for k, (a, b) in document["fitted_range"].items()},
        fingerprints={entry["log"]: entry["sha256"] for entry in data},
        data_fingerprints={entry["log"]: entry.get("data_sha256") for entry in data},
        fitted_logs=tuple(entry["log"] for entry in data if entry["in_sample"]),
        issues=_edits(document, spec, values, where=where),
        intersample=recorded_intersample(document["options"].get("intersample")),
        input_noise=AVERAGED if document["options"].get("input_noise") == AVERAGED else None,
    )


def _build(spec: ModelSpec, *, where: str) -> Model:
    from softid.effects import model_of
    from softid.models import MODELS  # numba, which a reader of other files does not need

    if spec.name not in MODELS:
        raise InputError(
            "this softid has no such model",
            where=f"{where}, $.model.name",
            value=spec.name,
            remedy=f"choose from {', '.join(MODELS)}, or install the softid that wrote the file",
        )
    _check_options(spec, MODELS[spec.name], where=where)
    _check_effects(spec, where=where)
    try:
        base = model_of(ModelSpec(spec.name, spec.options))
    except (SoftidError, TypeError, ValueError) as error:
        raise InputError(
            f"the options make no {spec.name} model ({str(error).rstrip('.')})",
            where=f"{where}, $.model.options",
            remedy="restore the file that softid wrote, or fit again",
        ) from error
    if not spec.effects:
        return base
    try:
        model = model_of(spec)
        model.parameters()
    except (SoftidError, ValueError, ArithmeticError) as error:
        raise InputError(
            f"the effects make no model ({str(error).rstrip('.')})",
            where=f"{where}, $.effects and $.scale",
            remedy="restore the file that softid wrote, or fit again",
        ) from error
    return model


def _check_options(spec: ModelSpec, model_class: type[Model], *, where: str) -> None:
    hints = typing.get_type_hints(model_class)
    known = [f.name for f in fields(model_class)]
    for name, value in spec.options.items():
        if name not in known:
            raise InputError(
                f"the {spec.name} model has no such option",
                where=f"{where}, $.model.options",
                value=name,
                remedy=f"choose from {', '.join(known)}" if known else "remove it",
            )
        if typing.get_origin(hints[name]) is Literal and value not in typing.get_args(hints[name]):
            raise InputError(
                f"expected {' or '.join(map(str, typing.get_args(hints[name])))}",
                where=f"{where}, $.model.options.{name}",
                value=value,
                remedy="restore the file that softid wrote, or fit again",
            )


def _check_effects(spec: ModelSpec, *, where: str) -> None:
    from softid.effects import EFFECTS

    for k, key in enumerate(spec.effects):
        if key not in EFFECTS:
            raise InputError(
                "this softid has no such effect",
                where=f"{where}, $.effects[{k}].key",
                value=key,
                remedy="an effect of your own must be registered before the file is read, with "
                "softid.register_effect; `softid effects` lists the others",
            )
    if spec.effects and not spec.scale:
        raise InputError(
            "there are effects, but not the sizes that their bounds go by",
            where=f"{where}, $.scale",
            remedy="restore the file that softid wrote, or fit again",
        )


def _spec(document: Mapping[str, Any]) -> ModelSpec:
    keys = tuple(entry["key"] for entry in document["effects"])
    scale = document.get("scale") or {}
    sizes = {name: v if isinstance(v, str) else float(v) for name, v in scale.items()}
    return ModelSpec(
        document["model"]["name"], document["model"]["options"], keys, sizes if keys else {}
    )


def _parameters(
    entries: list[dict[str, Any]], names: tuple[str, ...], *, where: str
) -> tuple[dict[str, float], dict[str, tuple[float, float]]]:
    found: dict[str, float] = {}
    bounds: dict[str, tuple[float, float]] = {}
    for k, entry in enumerate(entries):
        name, at = entry["name"], f"{where}, $.parameters[{k}]"
        if name not in names or name in found:
            raise InputError(
                "the parameter is there twice" if name in found else "unknown parameter",
                where=f"{at}.name",
                value=name,
                remedy=f"the model has {', '.join(names)}, each once",
            )
        value = float(entry["value"])
        lower = -math.inf if entry["lower"] is None else float(entry["lower"])
        upper = math.inf if entry["upper"] is None else float(entry["upper"])
        if not math.isfinite(value) or not lower <= value <= upper:
            raise InputError(
                f"{name} is not within its bounds [{lower:g}, {upper:g}]",
                where=f"{at}.value",
                value=value,
                remedy="give a value inside the bounds, or change the bounds in the file",
            )
        _require_tie(entry.get("tie"), names, where=f"{at}.tie")
        found[name], bounds[name] = value, (lower, upper)
    missing = [name for name in names if name not in found]
    if missing:
        raise InputError(
            f"the parameter {missing[0]} is missing",
            where=f"{where}, $.parameters",
            remedy=f"the model has {', '.join(names)}, each once",
        )
    return {name: found[name] for name in names}, bounds


def _require_tie(tie: str | None, names: tuple[str, ...], *, where: str) -> None:
    """Refuse what a fit would not have written, for whoever computes the tie again."""
    if tie is None:
        return
    try:
        unknown = sorted(names_in_tie(tie, where=where) - {*names})
    except UsageError as error:
        raise InputError(
            error.what, where=where, value=tie, remedy="restore the file that softid wrote"
        ) from error
    if unknown:
        raise InputError(
            f"there is no parameter {unknown[0]}",
            where=where,
            value=tie,
            remedy=f"the model has {', '.join(names)}",
        )


def _nuisance(entry: dict[str, Any]) -> LogNuisance:
    return LogNuisance(
        log=entry["log"],
        zero={name: float(zero) for name, zero in entry["zero"].items()},
        zero_stderr=dict(entry["zero_stderr"]),
        starts=tuple(
            SegmentStart(
                float(start["start_s"]), start["at_rest"], tuple(map(float, start["state"]))
            )
            for start in entry["starts"]
        ),
    )


def _edits(
    document: dict[str, Any], spec: ModelSpec, values: Mapping[str, float], *, where: str
) -> tuple[Issue, ...]:
    if document["content_sha256"] != model_fingerprint(spec, values):
        wrong = "the stated errors and scores no longer belong to its values"
    elif document.get("record_sha256", record_sha256(document)) != record_sha256(document):
        wrong = "its values stayed, but errors, fitted range or scores may not be those of the fit"
    else:
        return ()
    return (
        Issue(
            "edited-by-hand",
            "warning",
            f"{where} was edited by hand: {wrong}",
            "score the values with `softid validate`, or fit again",
        ),
    )
