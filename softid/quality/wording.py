"""How findings are named in a sentence."""

from __future__ import annotations

from collections.abc import Sequence

NAMED = 4
"""Places or names in a sentence; more make it hard to read."""


def first_names(names: Sequence[str]) -> str:
    """The first names in a sentence.

    Parameters
    ----------
    names
        What is named.
    """
    return ", ".join(names[:NAMED]) + (", …" if len(names) > NAMED else "")


def count(things: Sequence[object], noun: str) -> str:
    """How many there are.

    Examples
    --------
    >>> count("a", "gap"), count("ab", "gap")
    ('1 gap', '2 gaps')
    """
    return f"{len(things)} {noun}" + ("" if len(things) == 1 else "s")


def seconds(time_s: float) -> str:
    """A time in the unit that suits it.

    Examples
    --------
    >>> seconds(0.0119), seconds(20.0), seconds(1e-4)
    ('11.9 ms', '20 s', '0.1 ms')
    """
    if time_s < 1.0:
        return f"{1e3 * time_s:.4g} ms"
    return f"{time_s:.4g} s" if time_s < 1e4 else f"{time_s:.0f} s"
