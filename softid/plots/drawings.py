"""Plots that are drawn when they are asked for, by the names of their files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from matplotlib.figure import Figure

LONGEST_FILE_NAME = 100

Drawing = Callable[[], Figure | None]
"""Draws a plot; None when it does not apply."""


def applying(asked: Iterable[tuple[str, Drawing]]) -> Iterator[tuple[str, Figure]]:
    """Names and figures of the plots that apply, drawn one after the other."""
    for name, draw in asked:
        figure = draw()
        if figure is not None:
            yield name, figure


def file_name(name: str, taken: set[str]) -> str:
    """A name that every file system takes, different from those taken already in any case.

    Examples
    --------
    >>> seen = set()
    >>> file_name("response_a/b", seen), file_name("response_a_b", seen)
    ('response_a_b', 'response_a_b-2')
    """
    plain = "".join(c if c.isalnum() or c in "-_." else "_" for c in name)[:LONGEST_FILE_NAME]
    free, number = plain, 1
    while free.casefold() in taken:
        number += 1
        free = f"{plain}-{number}"
    taken.add(free.casefold())
    return free
