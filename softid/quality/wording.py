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
