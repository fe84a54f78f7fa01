"""Single cells of a text file: numbers in either decimal notation, missing values, times."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from datetime import datetime, timedelta

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

MISSING = frozenset(
    {"", "nan", "na", "n/a", "#n/a", "null", "none", "-", "\N{MINUS SIGN}", "--", "nil", "missing"}
)
"""Spellings of "nothing was recorded", in lower case."""

_NUMBER = re.compile(r"[+-]?(\d+(\.\d*|,\d+)?|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)
_INFINITE = re.compile(r"[+-]?inf(inity)?", re.IGNORECASE)
_CLOCK = re.compile(r"(\d{1,2}):([0-5]\d):([0-5]\d(?:[.,]\d+)?)", re.ASCII)
_CALENDAR = re.compile(
    r"\d{4}-\d\d-\d\d([T ]\d\d:\d\d(:\d\d([.,]\d+)?)?(Z|[+-]\d\d(:?\d\d)?)?)?"
    r"|\d{8}T\d{4}(\d\d([.,]\d+)?)?(Z|[+-]\d\d(:?\d\d)?)?",  # the basic form
    re.ASCII,
)
_OTHER_DATE = re.compile(
    r"(\d{4}([./-])\d{1,2}\2\d{1,2}|\d{1,2}([./-])\d{1,2}\3(\d{4}|\d\d))([ T,]\s*\d.*)?"
    r"|(.*\s)?\d{1,2}:\d\d.*[ap]\.?m\.?",
    re.ASCII | re.IGNORECASE,
)
_GROUPED = re.compile(r"[+-]?\d{1,3}([.,' ]\d{3})+([.,]\d+)?", re.ASCII)
_MIDNIGHT = datetime(1900, 1, 1)  # of times of day; softid looks at differences only


def is_missing(cell: str) -> bool:
    """Whether a cell says that nothing was recorded."""
    return cell.lower() in MISSING


def is_number(cell: str) -> bool:
    """Whether a cell is a number, with a decimal point or comma."""
    return _NUMBER.fullmatch(cell) is not None or _INFINITE.fullmatch(cell) is not None


def is_timestamp(cell: str) -> bool:
    """Whether a cell is an ISO 8601 date and time, or a time of day."""
    return _CALENDAR.fullmatch(cell) is not None or _CLOCK.fullmatch(cell) is not None


def is_other_date(cell: str) -> bool:
    """Whether a cell is a date or a time of day in a notation that leaves room for doubt.

    Examples
    --------
    >>> [is_other_date(c) for c in ("21.11.2026 12:00", "11/21/2026", "11:59 PM", "1.5", "2.11")]
    [True, True, True, False, False]
    """
    return _OTHER_DATE.fullmatch(cell) is not None


def is_grouped(cell: str) -> bool:
    """Whether a cell may be a number whose thousands are set off: 1.234,5 or 50.039."""
    return _GROUPED.fullmatch(cell) is not None


def is_time_of_day(cell: str) -> bool:
    """Whether a cell is a time without a date."""
    return _CLOCK.fullmatch(cell) is not None


def to_numbers(cells: Sequence[str], *, comma: bool) -> Array | int:
    """Turn cells into numbers.

    Parameters
    ----------
    cells
        One column, shape (n,).
    comma
        Whether a comma may stand for the decimal point.

    Returns
    -------
    ndarray or int
        The numbers, NaN where missing, or the position of the first cell that is none.
    """
    plain = not any("_" in cell for cell in cells)  # float() would take 1_000 for a number
    values = np.empty(len(cells))
    for position, padded in enumerate(cells):
        if plain:
            try:
                values[position] = float(padded)
            except ValueError:
                pass
            else:
                continue
        cell = padded.strip()
        if is_number(cell) and (comma or "," not in cell):
            values[position] = float(cell.replace(",", "."))
        elif is_missing(cell):
            values[position] = np.nan
        else:
            return position
    return values


def count_not_numbers(cells: Sequence[str], *, comma: bool) -> int:
    """How many cells are neither a number nor missing.

    Parameters
    ----------
    cells, comma
        As in `to_numbers`.

    Examples
    --------
    >>> count_not_numbers(["1.5", "ERR", "", "ERR"], comma=False)
    2
    """
    times = Counter(cells)
    return sum(n for cell, n in times.items() if isinstance(to_numbers([cell], comma=comma), int))


def to_seconds(cells: Sequence[str]) -> tuple[Array, str] | int:
    """Turn timestamps into seconds since the first one.

    Parameters
    ----------
    cells
        One column of ISO 8601 times or of times of day, shape (n,).

    Returns
    -------
    tuple or int
        Seconds, NaN where missing, and the first time as text; or the position of the first cell
        that is no time of the same kind.
    """
    first: datetime | None = None
    start = ""
    values = np.empty(len(cells))
    for position, padded in enumerate(cells):
        cell = padded.strip()
        if cell == "" or is_missing(cell):
            values[position] = np.nan
            continue
        try:
            moment = _moment(cell)
            if first is None:
                first, start = moment, cell
            values[position] = (moment - first).total_seconds()
        except (ValueError, TypeError):  # no time, or one with and one without a time zone
            return position
    return values, start


def _moment(cell: str) -> datetime:
    clock = _CLOCK.fullmatch(cell) if ":" in cell[1:3] else None
    if clock is None:
        return datetime.fromisoformat(cell)
    hours, minutes, seconds = clock.groups()
    return _MIDNIGHT + timedelta(
        hours=int(hours), minutes=int(minutes), seconds=float(seconds.replace(",", "."))
    )
