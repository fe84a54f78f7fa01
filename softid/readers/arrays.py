"""Named arrays, as MAT and NPZ files hold them, made into a table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.errors import InputError, Issue
from softid.readers.base import ArrayTable, Head, first_names, sample_rows

MOST_COLUMNS = 64
"""A matrix with more columns than that is an image or a map, not a set of channels."""

Named = Mapping[str, npt.NDArray[Any]]


def table_of_arrays(named: Named, *, path: str, sha256: str, file_format: str) -> ArrayTable:
    """Line up the arrays of one file as columns.

    Vectors and the columns of matrices become columns; scalars and texts become metadata; arrays
    of another length than most are left out and named in an issue, and are an error where a channel
    needs them.

    Parameters
    ----------
    named
        Name → array.
    path, sha256, file_format
        Origin.

    Raises
    ------
    InputError
        There are no two vectors of equal length.
    """
    columns: dict[str, npt.NDArray[Any]] = {}
    facts: dict[str, str] = {}
    left_out: list[str] = []
    for name, array in named.items():
        if array.size == 1:
            facts[name] = str(array.reshape(-1)[0])
        elif array.dtype.kind in "fiubmM" and array.size:
            columns |= _columns_of(name, array)
        else:
            left_out.append(name)
    lengths = Counter(column.size for column in columns.values())
    length = max(lengths, key=lambda n: (lengths[n], n), default=0)
    if lengths[length] < 2:
        found = ", ".join(f"{name} {array.shape}" for name, array in named.items())
        raise InputError(
            f"there are no two channels of equal length ({found[:200] or 'no arrays'})",
            where=path,
            remedy="save time and channels as vectors of the same length",
        )
    odd = {name: column.size for name, column in columns.items() if column.size != length}
    left_out += [f"{name} ({size} long)" for name, size in odd.items()]
    kept = {name: column for name, column in columns.items() if column.size == length}
    head = Head(
        path=path,
        sha256=sha256,
        file_format=file_format,
        names=tuple(kept),
        units=(None,) * len(kept),
        metadata=facts,
        issues=_left_out(path, left_out, length),
        unaligned={name: _unaligned(path, name, size, kept, length) for name, size in odd.items()},
    )
    return ArrayTable(head, sample_rows(length), "sample", tuple(kept.values()))


def _columns_of(name: str, array: npt.NDArray[Any]) -> dict[str, npt.NDArray[Any]]:
    squeezed = np.squeeze(array)
    if squeezed.ndim == 1:
        return {name: squeezed}
    if squeezed.ndim != 2:
        return {}
    tall = squeezed if squeezed.shape[0] >= squeezed.shape[1] else squeezed.T
    if tall.shape[1] > MOST_COLUMNS:
        return {}
    return {f"{name}_{k + 1}": tall[:, k] for k in range(tall.shape[1])}


def flattened(name: str, array: npt.NDArray[Any]) -> Iterator[tuple[str, npt.NDArray[Any]]]:
    """The fields of a structured array, each as an array; a plain array as it is."""
    if array.dtype.names is None:
        yield name, array
        return
    for field in array.dtype.names:
        for deeper, found in flattened(str(field), array[field]):
            yield (deeper if deeper == field else f"{field}.{deeper}"), found


def unique_names(
    parts: Iterator[tuple[str, str, npt.NDArray[Any]]],
) -> dict[str, npt.NDArray[Any]]:
    """Name every array by its field alone where that is unique, else with its parent before it."""
    found = list(parts)
    times = Counter(field for _, field, _ in found)
    return {
        (field if times[field] == 1 or parent == field else f"{parent}.{field}"): array
        for parent, field, array in found
    }


def _unaligned(path: str, name: str, size: int, kept: Named, length: int) -> InputError:
    return InputError(
        f"the array {name} has {size} values, but {first_names(list(kept))} "
        f"{'have' if len(kept) > 1 else 'has'} {length}",
        where=path,
        remedy="save time and channels with one value per sample, or map a column of the common "
        "length with --channel",
    )


def _left_out(path: str, names: list[str], length: int) -> tuple[Issue, ...]:
    if not names:
        return ()
    return (
        Issue(
            "column-left-out",
            "info",
            f"{path}: left out {first_names(names)}, not being channels of {length} numbers",
            "no action is needed, unless one of them is a channel",
        ),
    )
