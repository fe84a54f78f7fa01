"""Results as plain values that JSON can hold."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping
from enum import Enum
from pathlib import PurePath

import numpy as np

from softid.fingerprint import facts_fingerprint

Plain = None | bool | int | float | str | list["Plain"] | dict[str, "Plain"]


def to_jsonable(obj: object) -> Plain:
    """Turn a result into plain values, with None in place of NaN and infinity.

    Dataclasses and mappings become dictionaries, sequences and arrays lists, an enumeration its
    member's name in lower case.

    Parameters
    ----------
    obj
        A result, or any nest of dataclasses, mappings, sequences, arrays and scalars.

    Raises
    ------
    TypeError
        Something in it has no plain form.

    Examples
    --------
    >>> to_jsonable({"rmse": np.float64("nan"), "levels": np.array([1.0, 2.5])})
    {'rmse': None, 'levels': [1.0, 2.5]}
    """
    if isinstance(obj, Enum):
        return obj.name.lower()
    if obj is None or isinstance(obj, bool | int | str):
        return obj
    if isinstance(obj, float):
        return float(obj) if math.isfinite(obj) else None
    if isinstance(obj, PurePath):
        return str(obj)
    if isinstance(obj, np.ndarray | np.generic):
        return to_jsonable(obj.tolist())
    if dataclasses.is_dataclass(obj) and not isinstance(obj, type):
        return {f.name: to_jsonable(getattr(obj, f.name)) for f in dataclasses.fields(obj)}
    if isinstance(obj, Mapping):
        return {str(key): to_jsonable(value) for key, value in obj.items()}
    if isinstance(obj, list | tuple):
        return [to_jsonable(item) for item in obj]
    raise TypeError(f"{type(obj).__name__} has no JSON form")


def dump_json(document: object) -> str:
    """Write plain values as indented JSON; every number reads back as the same float.

    Parameters
    ----------
    document
        What `to_jsonable` accepts.
    """
    return json.dumps(to_jsonable(document), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def record_sha256(document: Mapping[str, object]) -> str:
    """Fingerprint of a record with its errors, ranges and scores; plots and profiles come later.

    Parameters
    ----------
    document
        The record, with or without its own ``record_sha256``.
    """
    apart = ("record_sha256", "plots", "profiles")
    facts = {key: to_jsonable(v) for key, v in document.items() if key not in apart}
    return facts_fingerprint(facts)
