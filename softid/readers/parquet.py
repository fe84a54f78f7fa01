"""Parquet files, of which only the columns that are asked for are read."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from softid.errors import InputError, MissingExtraError
from softid.readers import files
from softid.readers.base import Array, Head, Table, Timestamps, datetime_seconds, sample_rows

_BYTES_PER_NUMBER = 8
_SIGNATURE = b"PAR1"


@dataclass(frozen=True, eq=False)
class ParquetTable(Table):
    """Columns that are still in the file.

    Attributes
    ----------
    source
        The open ``pyarrow.parquet.ParquetFile``.
    """

    source: Any

    @property
    def only_on_request(self) -> bool:
        """Whether all columns together would be too large to hold."""
        size = len(self.head.names) * self.rows.size * _BYTES_PER_NUMBER
        return size > files.SIZE_LIMIT_BYTES

    def numbers(self, index: int) -> Array:
        """One column as numbers, NaN where it is null."""
        column = self._column(index)
        if column.dtype.kind not in "fiub":
            raise InputError(
                f"the column holds {self._kind(index)}, not numbers",
                where=self.place(index),
                remedy="save it as numbers, or leave it out",
            )
        return column.astype(np.float64)

    def timestamps(self, index: int) -> Timestamps | None:
        """One column as times since its first sample, if it holds dates."""
        if not self._kind(index).startswith(("timestamp", "date", "duration")):
            return None
        return datetime_seconds(self._column(index))

    def _kind(self, index: int) -> str:
        return self._kinds[index]

    @cached_property
    def _kinds(self) -> tuple[str, ...]:
        return tuple(str(field.type) for field in self.source.schema_arrow)

    def _column(self, index: int) -> np.ndarray[Any, np.dtype[Any]]:
        name = self.head.names[index]
        try:
            column = self.source.read(columns=[name]).column(0)
            return np.asarray(column.to_numpy())
        except Exception as error:  # damaged pages raise whatever pyarrow meets
            raise InputError(
                f"the column cannot be read, being damaged or of a kind ({self._kind(index)}) that "
                "has no numbers",
                where=self.place(index),
                remedy="write the file again, with the column as plain numbers",
            ) from error


def read_parquet(path: Path) -> Table:
    """Open a Parquet file; its columns are read when they are asked for.

    Parameters
    ----------
    path
        File with one row per sample.

    Raises
    ------
    MissingExtraError
        pyarrow is not installed.
    InputError
        The file is damaged or empty, or one column alone is too large.
    """
    size = files.require_file(path)
    if size == 0:
        raise InputError("the file is empty", where=str(path), remedy="check how it was written")
    try:
        from pyarrow.parquet import ParquetFile  # type: ignore[import-untyped]  # 0.2 s, and an optional dependency
    except ImportError:
        raise MissingExtraError(
            "reading Parquet needs pyarrow, which is not installed",
            where=str(path),
            remedy="install it with: pip install softid[parquet]",
        ) from None
    try:
        source = ParquetFile(path)
    except Exception as error:  # damaged files raise whatever pyarrow meets
        raise InputError(
            f"this is not a Parquet file that can be read: {_reason(path, size)}",
            where=str(path),
            remedy="check the name's ending, or write the file again",
        ) from error
    count = int(source.metadata.num_rows)
    if count * _BYTES_PER_NUMBER > files.SIZE_LIMIT_BYTES:
        raise files.too_large(path, f"{count} rows")
    fields = list(source.schema_arrow)
    units = tuple(_unit_of(field.metadata) for field in fields)
    head = Head(
        path=str(path),
        sha256=files.file_fingerprint(path),
        file_format="parquet",
        names=tuple(field.name for field in fields),
        units=units,
    )
    return ParquetTable(head, sample_rows(count), "sample", source)


def _unit_of(metadata: dict[bytes, bytes] | None) -> str | None:
    unit = (metadata or {}).get(b"unit")
    return unit.decode("utf-8", errors="replace") if unit else None


def _reason(path: Path, size: int) -> str:
    """What is wrong with a file, in words of the file and not of a library."""
    with path.open("rb") as stream:
        first = stream.read(len(_SIGNATURE))
        stream.seek(max(size - len(_SIGNATURE), 0))
        last = stream.read()
    if first != _SIGNATURE:
        return "its first bytes are not those of the format"
    return "its table of contents is damaged" if last == _SIGNATURE else "it ends too early"
