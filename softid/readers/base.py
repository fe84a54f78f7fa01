"""What every reader returns: a table of columns, named perhaps, but not yet interpreted."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.errors import InputError, Issue
from softid.given_values import since_first

Array = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

MOST_NAMES_SHOWN = 40


@dataclass(frozen=True)
class Head:
    """What is known of a file before its numbers are looked at.

    Attributes
    ----------
    path
        File as the user named it.
    sha256
        Fingerprint of the bytes on disk.
    file_format
        Name of the reader.
    names
        One per column; ``col1``, ``col2``, … where the file names none.
    units
        One per column from a unit row or the format's own attributes, or None.
    headed
        Whether the names are the file's own.
    metadata
        Facts beside the table.
    issues
        What the reader noticed.
    unaligned
        Name of a channel's array that has not one value per sample → the error to raise when it
        is needed.
    """

    path: str
    sha256: str
    file_format: str
    names: tuple[str, ...]
    units: tuple[str | None, ...]
    headed: bool = True
    metadata: Mapping[str, str] = field(default_factory=dict)
    issues: tuple[Issue, ...] = ()
    unaligned: Mapping[str, InputError] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Timestamps:
    """Calendar or clock times turned into seconds.

    Attributes
    ----------
    seconds
        Seconds since the first sample, shape (n,); NaN where a cell is empty.
    start
        The first sample's time as text.
    """

    seconds: Array
    start: str


@dataclass(frozen=True, eq=False)
class Table(ABC):
    """Columns of one file; cells become numbers when a column is asked for.

    Attributes
    ----------
    head
        Names, units and origin.
    rows
        The file's own row number of every sample, counted from 1, shape (n,).
    row_word
        What such a number counts: ``"row"`` of a text file, ``"sample"`` of an array.
    """

    head: Head
    rows: IntArray
    row_word: str

    @abstractmethod
    def numbers(self, index: int) -> Array:
        """One column as numbers, shape (n,); NaN where nothing was recorded.

        Raises
        ------
        InputError
            A cell holds something else than a number.
        """

    @abstractmethod
    def timestamps(self, index: int) -> Timestamps | None:
        """One column as calendar or clock times; None when it holds none.

        Raises
        ------
        InputError
            The column begins with a time but does not go on so.
        """

    def unclear_date(self, index: int) -> InputError | None:
        """What to say of a column of dates in a notation of which there are several readings."""
        del index
        return None

    def rows_with(self, names: Collection[str]) -> npt.NDArray[np.bool_] | None:
        """Which rows have a cell for one of these columns; None where all rows have all cells."""
        del names
        return None

    @property
    def only_on_request(self) -> bool:
        """Whether columns that nobody asked for stay in the file, because it is large."""
        return False

    @property
    def is_timed_in_s(self) -> bool:
        """Whether the format itself says that times are in s, so that none looks like another."""
        return False

    @property
    def usual_units(self) -> Mapping[str, str]:
        """Channel → unit to propose for it, where the format has its own custom."""
        return {}

    def place(self, index: int, sample: int | None = None) -> str:
        """File, column and row, for messages."""
        name = self.head.names[index]
        column = f"column {name}" if self.head.headed and name else f"column {index + 1}"
        text = f"{self.head.path}, {column}"
        return text if sample is None else f"{text}, {self.row_word} {self.rows[sample]}"


Reader = Callable[[Path], Table]
"""Opens one file format."""


@dataclass(frozen=True, eq=False)
class ArrayTable(Table):
    """Columns that are arrays already, each of shape (n,): numbers or numpy's ``datetime64``."""

    columns: Sequence[npt.NDArray[Any]]

    def numbers(self, index: int) -> Array:
        """One column as numbers."""
        column = self.columns[index]
        if column.dtype.kind not in "fiub":
            raise InputError(
                f"the column holds {column.dtype}, not numbers",
                where=self.place(index),
                remedy="save it as numbers, or leave it out",
            )
        return column.astype(np.float64)

    def timestamps(self, index: int) -> Timestamps | None:
        """One column as times since its first sample, if it holds dates."""
        return datetime_seconds(self.columns[index])


def datetime_seconds(column: npt.NDArray[Any]) -> Timestamps | None:
    """Turn ``datetime64`` or ``timedelta64`` into seconds since the first sample, to 1 µs."""
    if column.dtype.kind not in "mM":
        return None
    valid = np.flatnonzero(~np.isnat(column))
    if not valid.size:
        return None
    return Timestamps(since_first(column), str(column[valid[0]]))


def sample_rows(count: int) -> IntArray:
    """Row numbers of arrays: samples counted from 1."""
    return np.arange(1, count + 1, dtype=np.intp)


def first_names(names: Sequence[str]) -> str:
    """Names for a message, cut where nobody would read on."""
    shown = ", ".join(name or "(no name)" for name in names[:MOST_NAMES_SHOWN])
    return f"{shown}, …" if len(names) > MOST_NAMES_SHOWN else shown
