"""Delimited text: CSV, TSV and their kin, plain or gzip-compressed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from softid.errors import InputError, Issue
from softid.readers.base import Array, ArrayTable, Head, IntArray, Table, Timestamps
from softid.readers.cells import is_missing, is_number, is_timestamp, to_numbers, to_seconds
from softid.readers.decoding import decode, split_lines
from softid.readers.dialect import Layout, find_layout, is_comment
from softid.readers.files import read_content, refuse_other_format


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
            cell = self.cells[index][values]
            raise InputError(
                "this is not a number",
                where=self.place(index, values),
                value=cell[:60],
                remedy="correct it, or leave the cell empty (or NaN) if nothing was recorded",
            )
        return values

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
        return Timestamps(*converted)


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
    lines = split_lines(decode(content.data, where=where))
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
