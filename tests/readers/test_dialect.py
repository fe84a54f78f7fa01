"""Files whose table is broken or missing: the row, what is in it, and what to do."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from softid.errors import InputError
from softid.readers import load
from softid.readers.dialect import SAMPLE_LINES, find_layout

WriteFile = Callable[..., Path]

HEADER = "time_s,pressure_kpa,angle_deg"
ROWS = ["0,1,2", "0.1,2,3", "0.2,3,4"]


def refused(write_log: WriteFile, *lines: str) -> str:
    with pytest.raises(InputError) as caught:
        load(write_log("\n".join(lines) + "\n"))
    assert caught.value.remedy
    return str(caught.value)


@pytest.mark.parametrize("lines", [(HEADER,), (HEADER, ""), ("# rig 3", HEADER)])
def test_header_only(write_log: WriteFile, lines: tuple[str, ...]) -> None:
    said = refused(write_log, *lines)
    assert "a header (time_s, pressure_kpa, angle_deg) but no row of numbers" in said


def test_header_and_units_only(write_log: WriteFile) -> None:
    assert "no row of numbers" in refused(write_log, "time;pressure;angle", "s;bar;deg")


@pytest.mark.parametrize("line", ["hello", "# only a comment", ";;;", "just some prose here"])
def test_no_table_at_all(write_log: WriteFile, line: str) -> None:
    said = refused(write_log, line)
    assert "no table of at least two columns" in said
    assert "row 1" in said


@pytest.mark.parametrize("line", ["", "  \n\t\n"])
def test_blank_files(write_log: WriteFile, line: str) -> None:
    assert "the file is empty" in refused(write_log, line)


@pytest.mark.parametrize(("at", "row"), [(1, 2), (2, 3), (3, 4)])
@pytest.mark.parametrize("text", ["ERR", "n.a. (?)", "time_s"])
def test_text_in_a_number_column(write_log: WriteFile, at: int, row: int, text: str) -> None:
    """In the first row too, where it could be taken for a header."""
    rows = [HEADER, *ROWS]
    rows[at] = rows[at].replace(",", f",{text},", 1).rsplit(",", 1)[0]
    said = refused(write_log, *rows)
    assert f"column pressure_kpa, row {row}" in said
    assert repr(text) in said


@pytest.mark.parametrize(("broken", "cells"), [("0.05,1", 2), ("0.05,1,2,3", 4), ("0.05,1,2,", 4)])
@pytest.mark.parametrize("at", [1, 2])
def test_a_row_of_another_length(write_log: WriteFile, broken: str, cells: int, at: int) -> None:
    rows = [HEADER, *ROWS]
    rows.insert(at, broken)
    said = refused(write_log, *rows)
    assert f"row {at + 1}: the row has {cells} cells where the table has 3 columns" in said
    assert repr(broken) in said


def test_a_header_of_another_length(write_log: WriteFile) -> None:
    said = refused(write_log, "time_s,pressure_kpa", *ROWS[:1], "0.15,9,9", *ROWS[2:])
    assert "row 1: the header names 2 columns, but the rows have 3" in said


def test_a_line_between_header_and_numbers(write_log: WriteFile) -> None:
    said = refused(write_log, HEADER, "0,ERR", *ROWS)
    assert "row 2: the line between the header and the numbers" in said


def test_a_second_header_inside(write_log: WriteFile) -> None:
    """Two logs in one file must not be joined silently."""
    assert "column time_s, row 5" in refused(write_log, HEADER, *ROWS, HEADER, *ROWS)


def test_a_long_preamble_before_a_short_table(write_log: WriteFile) -> None:
    """The table counts, not the two words on each of many lines."""
    preamble = [f"line {k}" for k in range(SAMPLE_LINES - 10)]
    assert len(load(write_log("\n".join([*preamble, HEADER, *ROWS])))) == 3


def test_rows_of_tabs_alone_are_blank(write_log: WriteFile) -> None:
    """And do not shift the numbers of the rows behind them."""
    lines = [HEADER, *ROWS, ",,", "0.3,4,ERR"]
    assert "column angle_deg, row 6" in refused(write_log, *(s.replace(",", "\t") for s in lines))


@pytest.mark.parametrize(
    ("lines", "separator", "width"),
    [
        (["1,5;2,5", "3,5;4,5"], ";", 2),
        (["1, 2, 3", "4, 5, 6"], ",", 3),
        (["1.0 2.0", "3.0  4.0"], None, 2),
        (["1|2|", "3|4|"], "|", 2),
        (["2024-01-01 10:00:00,5", "2024-01-01 10:00:01,6"], ",", 2),
    ],
)
def test_separators_that_could_be_mistaken(
    lines: list[str], separator: str | None, width: int
) -> None:
    layout = find_layout(lines, where="log.csv")
    assert (layout.separator, layout.width, layout.start) == (separator, width, 0)
