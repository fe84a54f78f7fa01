"""What stands above a table: names, a row of units, facts in a preamble."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from softid.errors import InputError
from softid.readers.cells import is_missing, is_number, is_timestamp
from softid.readers.columns import is_time_name
from softid.units import lookup_unit

LONGEST_UNIT_CELL = 12
LONGEST_KEY = 60
MOST_MISCOUNTED = 2
"""A line with so many names more or fewer than the rows have cells is a header gone wrong."""

_FACT = re.compile(r"([^:=]+?)\s*[:=]\s*(\S.*)")
_BRACKETS = re.compile(r"[\[(<{]?\s*(.*?)\s*[\])>}]?")
_UNITLESS = frozenset({"", "-", "1", "–", "counts", "raw", "a.u.", "au"})

Line = tuple[int, str, bool]
"""Index of a line, its text without a comment mark, and whether it had one."""


@dataclass(frozen=True)
class Heading:
    """What is said above the numbers.

    Attributes
    ----------
    names
        One per column, or None when the file names none.
    units
        One per column where a row of units says so.
    metadata
        ``key: value`` lines, and free text under ``comment``.
    """

    names: tuple[str, ...] | None
    units: tuple[str | None, ...]
    metadata: Mapping[str, str]


def read_heading(
    above: Sequence[Line],
    *,
    width: int,
    split: Callable[[str], list[str]],
    first_column: Sequence[str],
    where: str,
) -> Heading:
    """Read the lines above the first row of numbers.

    Parameters
    ----------
    above
        Those lines that are not blank, in order.
    width
        Number of columns of the table.
    split
        Cuts a header line into cells.
    first_column
        Cells of the table's first column, to tell an index that has no name.
    where
        File named in the errors.

    Raises
    ------
    InputError
        A line is a header, but names more or fewer columns than the rows have.
    """
    cut = [_fitted(split(text), width, first_column) for _, text, _ in above]
    units: tuple[str | None, ...] = (None,) * width
    chosen: int | None = None
    left = list(range(len(above)))
    if len(above) > 1 and _is_units(cut[-1], width):
        chosen = _choose_header(above[:-1], cut[:-1], width)
        if chosen is not None:
            units = tuple(_unit_of(cell) for cell in cut[-1])
            left.pop()
    if chosen is None:
        chosen = _choose_header(above, cut, width)
    if chosen is None:
        _refuse_misfit(above, cut, width, where)
        return Heading(None, units, _metadata(above))
    left.remove(chosen)
    return Heading(tuple(cut[chosen]), units, _metadata([above[k] for k in left]))


def _choose_header(above: Sequence[Line], cut: Sequence[Sequence[str]], width: int) -> int | None:
    """The line that names the columns: a comment only right above the numbers."""
    last = len(above) - 1
    plain = [k for k, (_, _, comment) in enumerate(above) if not comment][-1:]
    nearest_comment = [last] if above and above[last][2] else []
    sure = [k for k in nearest_comment if any(map(is_time_name, cut[k]))]
    for k in (*sure, *plain, *nearest_comment):
        if _is_names(cut[k], width) and not (above[k][2] and _is_prose(cut[k])):
            return k
    return None


def _refuse_misfit(
    above: Sequence[Line], cut: Sequence[Sequence[str]], width: int, where: str
) -> None:
    for position, ((index, text, comment), cells) in enumerate(zip(above, cut, strict=True)):
        close = len(cells) > 1 and abs(len(cells) - width) <= MOST_MISCOUNTED
        if comment or not close or not any(is_time_name(cell) for cell in cells[:2]):
            continue
        if len(cells) != width:
            raise InputError(
                f"the header names {len(cells)} columns, but the rows have {width}",
                where=f"{where}, row {index + 1}",
                value=text[:80],
                remedy="give every column one name, or quote a name that contains the separator",
            )
        if position + 1 < len(above):
            broken, shown, _ = above[position + 1]
            raise InputError(
                "the line between the header and the numbers is no row of the table",
                where=f"{where}, row {broken + 1}",
                value=shown[:60],
                remedy="delete it, or mark it as a comment with #",
            )


def _fitted(cells: list[str], width: int, first_column: Sequence[str]) -> list[str]:
    """Header cells, without a trailing empty one and with one for an index that has no name."""
    if len(cells) == width + 1 and not cells[-1]:
        return cells[:-1]
    if len(cells) == width - 1 and _counts_up(first_column):
        return ["", *cells]
    return cells


def _counts_up(cells: Sequence[str]) -> bool:
    try:
        values = [int(cell) for cell in cells]
    except ValueError:
        return False
    return len(values) > 1 and values == list(range(values[0], values[0] + len(values)))


def _is_names(cells: Sequence[str], width: int) -> bool:
    return (
        len(cells) == width
        and any(cells)
        and not any(is_number(cell) or is_timestamp(cell) for cell in cells[:1])
        and sum(is_number(cell) for cell in cells) <= width // 2
    )


def _is_prose(cells: Sequence[str]) -> bool:
    """Whether a comment that happens to have the right number of cells is no header."""
    return any(is_number(cell) or cell.endswith((":", "=")) for cell in cells)


def _is_units(cells: Sequence[str], width: int) -> bool:
    if len(cells) != width or any(len(cell) > LONGEST_UNIT_CELL for cell in cells):
        return False
    if any(is_number(cell) and cell != "1" for cell in cells):
        return False
    written = [_BRACKETS.fullmatch(cell)[1] for cell in cells if cell not in _UNITLESS]  # type: ignore[index]
    known = sum(lookup_unit(text) is not None for text in written)
    return known > 0 and 2 * known >= len(written)


def _unit_of(cell: str) -> str | None:
    match = _BRACKETS.fullmatch(cell)
    text = match[1] if match else cell
    return None if text.lower() in _UNITLESS or is_missing(text) else text


def _metadata(lines: Sequence[Line]) -> dict[str, str]:
    facts: dict[str, str] = {}
    free: list[str] = []
    for _, text, _ in lines:
        stripped = text.strip().strip(",;|\t ")
        match = _FACT.fullmatch(stripped)
        if match and len(match[1]) <= LONGEST_KEY:
            facts[match[1].strip()] = match[2].strip()
        elif stripped:
            free.append(stripped)
    if free:
        facts.setdefault("comment", "\n".join(free))
    return facts
