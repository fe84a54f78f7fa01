"""Delimited text: CSV, TSV and their kin, plain or gzip-compressed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from softid.errors import InputError, Issue
from softid.readers.base import Array, ArrayTable, Head, IntArray, Table, Timestamps
from softid.readers.cells import (
    count_not_numbers,
    is_grouped,
    is_missing,
    is_number,
    is_other_date,
    is_time_of_day,
    is_timestamp,
    to_numbers,
    to_seconds,
)
from softid.readers.decoding import decode, split_lines, with_plain_minus
from softid.readers.dialect import Layout, find_layout, is_comment
from softid.readers.files import read_content, refuse_other_format

HALF_A_DAY_S = 12 * 3600.0


@dataclass(frozen=True, eq=False)
class TextTable(Table):
    """Columns of cells that are still text.

    Attributes
    ----------
    cells
        One sequence per column, each of length n.
    comma
        Whether a comma may be the decimal sign.
    """

    cells: Sequence[Sequence[str]]
    comma: bool

    def numbers(self, index: int) -> Array:
        """One column as numbers, NaN where a cell says that there is none."""
        values = to_numbers(self.cells[index], comma=self.comma)
        if isinstance(values, int):
            raise self._no_number(index, values)
        return values

    def _no_number(self, index: int, sample: int) -> InputError:
        cell = self.cells[index][sample].strip()
        remedy = "correct it, or leave the cell empty (or NaN) if nothing was recorded"
        if is_other_date(cell):
            return self._other_date(index, sample)
        grouping = self._grouping_point() if is_number(cell) and "," in cell else None
        if grouping is not None:
            return self._two_decimal_signs(cell, *grouping)
        if is_grouped(cell):
            remedy = "write it without marks between the thousands"
        others = count_not_numbers(self.cells[index], comma=self.comma) - 1
        more = f", nor {'are' if others > 1 else 'is'} {others} more in its column" * (others > 0)
        return InputError(
            f"this is not a number{more}",
            where=self.place(index, sample),
            value=cell[:60],
            remedy=remedy,
        )

    def _other_date(self, index: int, sample: int) -> InputError:
        return InputError(
            "this date or time may be read in more than one way",
            where=self.place(index, sample),
            value=self.cells[index][sample].strip()[:60],
            remedy="write ISO 8601 (2026-11-21T12:00:00), or the seconds since the start",
        )

    def _grouping_point(self) -> tuple[int, int] | None:
        """Column and sample of the first point, if every one may set off thousands."""
        first = None
        for index, column in enumerate(self.cells):
            for sample, padded in enumerate(column):
                cell = padded.strip()
                if "." in cell and is_number(cell):
                    if not is_grouped(cell):
                        return None
                    first = first or (index, sample)
        return first

    def _two_decimal_signs(self, comma: str, index: int, sample: int) -> InputError:
        """The cell with a point is to blame, where others have a decimal comma."""
        cell = self.cells[index][sample].strip()
        return InputError(
            f"there is a point, where other numbers have a decimal comma ({comma})",
            where=self.place(index, sample),
            value=cell[:60],
            remedy=f"if it sets off thousands, write {cell.replace('.', '')}, else write all "
            "numbers with the same decimal sign",
        )

    def unclear_date(self, index: int) -> InputError | None:
        """What to say of a column of dates in a notation that leaves room for doubt."""
        first = next((k for k, c in enumerate(self.cells[index]) if not is_missing(c.strip())), 0)
        if not is_other_date(self.cells[index][first].strip()):
            return None
        return self._other_date(index, first)

    def timestamps(self, index: int) -> Timestamps | None:
        """One column of ISO 8601 times or times of day as seconds since the first."""
        first = next((c.strip() for c in self.cells[index] if not is_missing(c.strip())), "")
        if not is_timestamp(first):
            return None
        converted = to_seconds(self.cells[index])
        if isinstance(converted, int):
            raise InputError(
                f"this is not a time like {first}",
                where=self.place(index, converted),
                value=self.cells[index][converted][:60],
                remedy="write all times alike, as ISO 8601, or as seconds",
            )
        if is_time_of_day(first):
            self._require_one_day(index, converted[0])
        return Timestamps(*converted)

    def _require_one_day(self, index: int, seconds: Array) -> None:
        recorded = np.flatnonzero(np.isfinite(seconds))
        back = np.flatnonzero(np.diff(seconds[recorded]) < -HALF_A_DAY_S)
        if back.size:
            before, after = (int(recorded[back[0] + k]) for k in (0, 1))
            raise InputError(
                f"the day changes, after {self.cells[index][before].strip()}, and a time of day "
                "does not say by how much",
                where=self.place(index, after),
                value=self.cells[index][after].strip()[:60],
                remedy="write the date too, as in 2026-11-21T12:00:00, or the seconds since the "
                "start",
            )


def read_csv(path: Path) -> Table:
    """Read delimited text.

    Separator, decimal sign, line ends, encoding, preamble, header and unit row are found from the
    content.

    Parameters
    ----------
    path
        File; it is decompressed when its content is gzip's or its name ends in ``.gz``.

    Raises
    ------
    InputError
        The file cannot be read or holds no table.
    """
    content = read_content(path, compressed=path.suffix.lower() == ".gz" or None)
    refuse_other_format(path, content.data)
    where = str(path)
    lines = split_lines(with_plain_minus(decode(content.data, where=where)))
    layout = find_layout(lines, where=where)
    names = layout.heading.names
    head = Head(
        path=where,
        sha256=content.sha256,
        file_format="csv",
        names=names or tuple(f"col{k}" for k in range(1, layout.width + 1)),
        units=layout.heading.units,
        headed=names is not None,
        metadata=layout.heading.metadata,
    )
    body = lines[layout.start :]
    values = None if layout.timed else _parse_fast(body, layout)
    if values is None:
        return _parse_carefully(body, layout, head)
    return ArrayTable(head, _row_numbers(body, layout.start), "row", tuple(values.T))


def _parse_fast(body: Sequence[str], layout: Layout) -> Array | None:
    """Let numpy's C parser have a table of nothing but numbers; None when it is not such a one."""
    separator = layout.separator
    shape = (sum(1 for line in body if line.strip()), layout.width)
    if separator is not None and separator != "," and any("," in line for line in body):
        if any("." in line for line in body):
            return None
        body = [line.replace(",", ".") for line in body]
    if layout.trailing and separator:
        body = [line.rstrip().removesuffix(separator) for line in body]
    quote = '"' if any('"' in line for line in body) else None
    if separator is not None and quote is None:
        body = _fill_empty(body, separator)
    try:
        values = np.loadtxt(body, delimiter=separator, comments=None, quotechar=quote, ndmin=2)
    except ValueError:
        return None
    return values if values.shape == shape else None


def _fill_empty(body: Sequence[str], separator: str) -> Sequence[str]:
    """Write nan into empty cells, which numpy's parser does not take."""
    double = separator * 2
    if not any(
        double in line or line.endswith(separator) or line.startswith(separator) for line in body
    ):
        return body
    text = "\n".join(["", *body, ""])
    while double in text:
        text = text.replace(double, f"{separator}nan{separator}")
    text = text.replace(f"{separator}\n", f"{separator}nan\n")
    return text.replace(f"\n{separator}", f"\nnan{separator}").split("\n")[1:-1]


def _row_numbers(body: Sequence[str], start: int) -> IntArray:
    return np.array([k for k, line in enumerate(body, start + 1) if line.strip()], dtype=np.intp)


def _parse_carefully(body: Sequence[str], layout: Layout, head: Head) -> TextTable:
    columns = _split_at_once(body, layout)
    if columns is not None:
        numbers = _row_numbers(body, layout.start)
    else:
        rows, at, issues = _split_row_by_row(body, layout, head.path)
        columns, numbers = list(map(list, zip(*rows, strict=True))), np.array(at, dtype=np.intp)
        head = replace(head, issues=(*head.issues, *issues))
    pointed = any("." in c and is_number(c.strip()) for column in columns for c in column)
    return TextTable(head, numbers, "row", columns, comma=not pointed)


def _split_at_once(body: Sequence[str], layout: Layout) -> list[list[str]] | None:
    """Cut all rows in one go; None when they are not all alike."""
    separator = layout.separator
    if separator is None:
        return None
    if layout.trailing:
        body = [line.rstrip().removesuffix(separator) for line in body]
    inner = layout.width - 1
    if any(
        line.count(separator) != inner or '"' in line or is_comment(line) or not line.strip()
        for line in body
    ):
        return None
    cells = separator.join(body).split(separator)
    return [cells[k :: layout.width] for k in range(layout.width)]


def _split_row_by_row(
    body: Sequence[str], layout: Layout, path: str
) -> tuple[list[list[str]], list[int], list[Issue]]:
    rows: list[list[str]] = []
    numbers: list[int] = []
    issues: list[Issue] = []
    last = layout.start + len(body)
    for number, line in enumerate(body, layout.start + 1):
        if not line.strip() or is_comment(line):
            continue
        cells = layout.split(line)
        if len(cells) == layout.width:
            rows.append(cells)
            numbers.append(number)
        elif number == last and rows and len(cells) < layout.width:
            issues.append(_incomplete(path, number))
        else:
            raise InputError(
                f"the row has {len(cells)} cells where the table has {layout.width} columns",
                where=f"{path}, row {number}",
                value=line[:60],
                remedy="repair or delete the row",
            )
    return rows, numbers, issues


def _incomplete(path: str, number: int) -> Issue:
    return Issue(
        "incomplete-last-row",
        "warning",
        f"{path}, row {number}: the last row is incomplete and was dropped",
        "no action is needed if the recording was stopped in the middle of a row",
    )
