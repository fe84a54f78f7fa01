"""A JSON file of ours read with suspicion: it may be cut, edited or of another version."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any, NoReturn

from softid.errors import InputError
from softid.fingerprint import content_fingerprint

_LARGEST_BYTES = 64 * 1024 * 1024
_LONGEST_VALUE = 60
_EXPECTED = {
    "type": "a value of type {}",
    "enum": "one of {}",
    "const": "{}",
    "minimum": "at least {}",
    "maximum": "at most {}",
    "exclusiveMinimum": "more than {}",
    "minLength": "a text of at least {} characters",
    "minItems": "at least {} entries",
    "maxItems": "at most {} entries",
    "pattern": "a text that matches {}",
}


class NoRecordError(InputError):
    """The file is no record of softid's, or one of another kind than is wanted."""

    def __init__(self, what: str, *, where: str, value: object = None) -> None:
        remedy = "name the params.json that `softid fit` wrote"
        super().__init__(what, where=where, value=value, remedy=remedy)


def read_document(path: Path, *, schema: str) -> dict[str, Any]:
    """Read a JSON file and check it against the schema of its kind.

    Parameters
    ----------
    path
        The file.
    schema
        What it must be: ``"softid.params/1"``.

    Returns
    -------
    dict
        The content, valid by the schema.

    Raises
    ------
    InputError
        The file cannot be read, is not JSON, is of another kind or version, or breaks the schema.
    """
    document = _parse(_read_text(path), kind=schema.split("/")[0], where=str(path))
    if not isinstance(document, dict):
        raise NoRecordError(
            f"this is not a {schema.split('/')[0]} file",
            where=str(path),
            value=f"JSON {_type_name(document)}",
        )
    _check_kind(document, schema, where=str(path))
    _check_schema(document, schema, where=str(path))
    return document


def recorded_plots(path: Path) -> dict[str, str]:
    """The plots that were written beside a record: file name → sha256.

    Empty when there is no such record or it cannot be read: then nothing is known of its plots.

    Parameters
    ----------
    path
        A params.json, validation.json or diagnosis.json.
    """
    plots = known_value(path, "plots")
    if not isinstance(plots, dict):
        return {}
    return {
        name: sha256
        for name, sha256 in plots.items()
        if isinstance(sha256, str) and name.endswith(".png") and Path(name).name == name
    }


def known_value(path: Path, key: str) -> object:
    """What an earlier record says under a key; None when there is no record or it is unreadable."""
    try:
        document = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return None
    return document.get(key) if isinstance(document, dict) else None


def plot_fingerprints(plots: Mapping[str, str | bytes]) -> dict[str, str]:
    """What a record keeps of the plots beside it: file name → sha256."""
    return {name: content_fingerprint(data) for name, data in plots.items()}


def load_schema(schema: str) -> dict[str, Any]:
    """The JSON Schema of a kind of file, such as ``"softid.params/1"``."""
    kind, version = schema.removeprefix("softid.").split("/")
    file = resources.files("softid") / "schemas" / f"v{version}" / f"{kind}.json"
    loaded: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return loaded


def _read_text(path: Path) -> str:
    try:
        size = path.stat().st_size
        if path.is_dir():
            raise InputError(
                "this is a folder", where=str(path), remedy="name the params.json inside it"
            )
        if size > _LARGEST_BYTES:
            raise NoRecordError(
                f"{size / 1e6:.0f} MB is too large for a record of parameters", where=str(path)
            )
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise NoRecordError("there is no such file", where=str(path)) from error
    except UnicodeDecodeError as error:
        raise NoRecordError(
            "this is not a text file", where=f"{path}, byte {error.start}"
        ) from error
    except OSError as error:
        raise InputError(
            f"cannot be read ({(error.strerror or str(error)).lower()})",
            where=str(path),
            remedy="check the path and its permissions",
        ) from error


def _parse(text: str, *, kind: str, where: str) -> object:
    def refuse(constant: str) -> NoReturn:
        raise InputError(
            "JSON has no such number",
            where=where,
            value=constant,
            remedy="write null where nothing is known",
        )

    try:
        return json.loads(text, parse_constant=refuse)
    except json.JSONDecodeError as error:
        if not text.lstrip().startswith(("{", "[")):
            raise NoRecordError(
                f"this is not a {kind} file, for it is no JSON", where=where
            ) from error
        raise InputError(
            f"this is not JSON: {error.msg[:1].lower()}{error.msg[1:]}",
            where=f"{where}, line {error.lineno}, column {error.colno}",
            remedy="restore the file that softid wrote, or fit again",
        ) from error
    except RecursionError as error:
        raise InputError(
            "the JSON is nested too deeply",
            where=where,
            remedy="restore the file that softid wrote, or fit again",
        ) from error


def _check_kind(document: Mapping[str, Any], schema: str, *, where: str) -> None:
    found = document.get("schema")
    kind = schema.split("/")[0]
    if found == schema:
        return
    if not isinstance(found, str) or not found.startswith("softid."):
        raise NoRecordError(
            f"this is not a {kind} file",
            where=f"{where}, $.schema",
            value=found if isinstance(found, str) else None,
        )
    if found.split("/")[0] != kind:
        raise NoRecordError(f"this is a {found.split('/')[0]} file, not a {kind} file", where=where)
    writer = document.get("versions")
    version = writer.get("softid") if isinstance(writer, dict) else None
    by = f" by softid {version}" if isinstance(version, str) else ""
    raise InputError(
        f"the file was written as {found}{by}, but this softid reads {schema}",
        where=where,
        remedy="install the softid that wrote it, or fit the logs again",
    )


def _check_schema(document: Mapping[str, Any], schema: str, *, where: str) -> None:
    from jsonschema import Draft202012Validator  # 0.1 s, and only a file read back needs it
    from jsonschema.exceptions import best_match

    error = best_match(Draft202012Validator(load_schema(schema)).iter_errors(document))
    if error is None:
        return
    remedy = "restore the file that softid wrote, or fit again"
    if error.validator == "required":
        missing = [key for key in error.validator_value if key not in error.instance]
        raise InputError(
            f"the key {missing[0]!r} is missing", where=f"{where}, {error.json_path}", remedy=remedy
        )
    expected = _EXPECTED.get(str(error.validator))
    wanted = expected.format(_listed(error.validator_value)) if expected else error.message
    raise InputError(
        f"expected {wanted}",
        where=f"{where}, {error.json_path}",
        value=_shortened(error.instance),
        remedy=remedy,
    )


def _listed(value: object) -> str:
    return " or ".join(map(str, value)) if isinstance(value, list) else str(value)


def _shortened(value: object) -> object:
    text = json.dumps(value, ensure_ascii=False)
    return value if len(text) <= _LONGEST_VALUE else text[:_LONGEST_VALUE] + "…"


def _type_name(value: object) -> str:
    return {list: "list", str: "text", bool: "truth value"}.get(type(value), "number")
