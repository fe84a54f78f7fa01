"""Finding the table in a text file: separator, first row, header, unit row and preamble."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from softid.errors import InputError
from softid.readers.base import first_names
from softid.readers.cells import is_missing, is_number, is_timestamp
from softid.readers.columns import is_time_name
from softid.readers.header import Heading, read_heading

SAMPLE_LINES = 200
"""Lines that are neither blank nor comments within which the table must begin."""

TAIL_LINES = 10
"""Lines at the end of the sampled ones that decide the separator."""

DECISIVE_LINES = 3
"""Lines at the end of the sampled ones that decide the number of columns; a broken one is
outvoted."""

SEPARATORS: tuple[str | None, ...] = (";", "\t", "|", ",", None)
"""Separators of cells, tried in this order; None is any white space."""

COMMENT_MARKS = ("#", "%", "//")

_GAP = re.compile(r"\s+(?![\[(])")  # a unit in brackets stays with its name


@dataclass(frozen=True)
class Layout:
    """Where the table is and how its rows are cut.

    Attributes
    ----------
    separator
        Character between cells; None for white space.
    width
        Number of columns.
    start
        Index of the first line with numbers.
    trailing
        Whether every row ends with a separator that opens no further cell.
    timed
        Whether a column holds dates or times of day.
    heading
        Names, units and metadata above the table.
    """

    separator: str | None
    width: int
    start: int
    trailing: bool
    timed: bool
    heading: Heading

    def split(self, line: str) -> list[str]:
        """Cells of a row, stripped, without the one that a trailing separator opens."""
        cells = split_cells(line, self.separator)
        if self.trailing and len(cells) == self.width + 1 and not cells[-1]:
            cells.pop()
        return cells


def split_cells(line: str, separator: str | None) -> list[str]:
    """Cut a line at its separators and strip the cells."""
    if '"' in line:
        try:
            rows = list(csv.reader([line], delimiter=separator or " ", skipinitialspace=True))
        except csv.Error:
            rows = []
        if len(rows) == 1:
            return [cell.strip() for cell in rows[0]]
    if separator is None:
        return line.split()
    return list(map(str.strip, line.split(separator)))


def split_names(line: str, separator: str | None) -> list[str]:
    """Cut a header line; at white space only where no unit in brackets follows."""
    if separator is None and '"' not in line:
        return _GAP.split(line.strip())
    return split_cells(line, separator)


def is_comment(line: str) -> bool:
    """Whether a line is marked as a comment."""
    return line.startswith(COMMENT_MARKS) or line.lstrip().startswith(COMMENT_MARKS)


def without_mark(line: str) -> str:
    """A comment's text."""
    text = line.strip()
    while text.startswith(COMMENT_MARKS):
        text = text.removeprefix("//").removeprefix("#").removeprefix("%").lstrip()
    return text


@dataclass(frozen=True)
class _Candidate:
    """The table as it looks with one separator."""

    separator: str | None
    width: int
    trailing: bool
    rows: Mapping[int, list[str]]
    numeric: tuple[int, ...]
    score: float

    def fits(self, index: int) -> bool:
        """Whether a line is a row with nothing but numbers in the number columns."""
        row = self.rows[index]
        hits = [_numeric(row[k]) for k in self.numeric] if len(row) == self.width else []
        return any(hits) and all(
            hit or is_missing(row[k]) for hit, k in zip(hits, self.numeric, strict=True)
        )

    def nearly_fits(self, index: int) -> bool:
        """Whether a line is a broken row: with text further on, or with cells too few or many."""
        row = self.rows[index]
        if len(row) == self.width:
            return _numeric(row[self.numeric[0]])
        return len(row) > 1 and all(_numeric(cell) or is_missing(cell) for cell in row)


def find_layout(lines: Sequence[str], *, where: str) -> Layout:
    """Find the table in the lines of a file.

    Parameters
    ----------
    lines
        All lines of the file.
    where
        File named in the errors.

    Raises
    ------
    InputError
        There is no table of at least two columns, it has no rows, or the header does not fit.
    """
    sample: list[int] = []
    for index, line in enumerate(lines):
        if line.strip() and not is_comment(line):
            sample.append(index)
            if len(sample) == SAMPLE_LINES:
                break
    candidates = [_candidate(lines, sample, separator) for separator in SEPARATORS]
    best = max(candidates, key=lambda candidate: candidate.score)
    first_fit = next((k for k in sample if best.score > 0 and best.fits(k)), None)
    if first_fit is None:
        raise _no_table(lines, sample, where)
    position = sample.index(first_fit)
    while position and best.nearly_fits(sample[position - 1]):
        position -= 1
    start = sample[position]
    heading = read_heading(
        [
            (k, without_mark(line) if is_comment(line) else line, is_comment(line))
            for k, line in enumerate(lines[:start])
            if line.strip()
        ],
        width=best.width,
        split=lambda line: split_names(line, best.separator),
        first_column=[best.rows[k][0] for k in sample[position:] if best.rows[k]],
        where=where,
    )
    timed = any(is_timestamp(cell) for k in (start, first_fit) for cell in best.rows[k])
    return Layout(best.separator, best.width, start, best.trailing, timed, heading)


def _candidate(lines: Sequence[str], sample: Sequence[int], separator: str | None) -> _Candidate:
    rows = {k: split_cells(lines[k], separator) for k in sample}
    tail = [rows[k] for k in sample[-TAIL_LINES:]]
    counts = Counter(len(row) for row in tail[-DECISIVE_LINES:])
    width = max(counts, key=lambda n: (counts[n], n), default=0)
    full = [row for row in tail if len(row) == width]
    alike = [row for row in rows.values() if len(row) == width]  # a header too, if it is one
    trailing = width > 2 and separator is not None and all(not row[-1] for row in alike)
    if trailing:
        width -= 1
        rows = {k: row[:-1] if row and not row[-1] else row for k, row in rows.items()}
        full = [row[:-1] for row in full]
    numeric = tuple(k for k in range(width) if any(_numeric(row[k]) for row in full))
    cells = [cell for row in full for cell in row if not is_missing(cell)]
    if width < 2 or not numeric or not cells:
        return _Candidate(separator, width, trailing, rows, (), 0.0)
    agreement = max(counts.values()) / sum(counts.values())
    score = agreement * sum(map(_numeric, cells)) / len(cells)
    return _Candidate(separator, width, trailing, rows, numeric, score)


def _numeric(cell: str) -> bool:
    return is_number(cell) or is_timestamp(cell)


def _no_table(lines: Sequence[str], sample: Sequence[int], where: str) -> InputError:
    if not lines:
        return InputError(
            "the file is empty", where=where, remedy="check how it was recorded or copied"
        )
    shown = sample[:1] or [0]
    cuts = [split_names(lines[k], separator) for k in sample[:2] for separator in SEPARATORS]
    words = max(cuts, key=lambda cells: sum(map(is_time_name, cells)) * len(cells), default=[])
    if len(sample) <= 2 and any(map(is_time_name, words)):
        return InputError(
            f"there is a header ({first_names(words)}) but no row of numbers",
            where=where,
            remedy="check that the recording was started",
        )
    return InputError(
        f"no table of at least two columns of numbers begins in its first {SAMPLE_LINES} lines",
        where=f"{where}, row {shown[0] + 1}",
        value=lines[shown[0]][:60],
        remedy="export time and channels as columns, separated by a comma, semicolon, tab or bar",
    )
