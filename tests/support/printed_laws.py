"""Which parameters a printed law or equation does not name."""

from __future__ import annotations

import re
from collections.abc import Iterable

RANGE = re.compile(r"([A-Za-z]+)(\d+) … \1(\d+)")
"""Parameters that are numbered, as k2 … k6."""


def unnamed_in(law: str, names: Iterable[str]) -> set[str]:
    """The names that do not stand in a law as words of their own."""
    named = set(re.findall(r"\w+", law))
    for stem, first, last in RANGE.findall(law):
        named |= {f"{stem}{k}" for k in range(int(first), int(last) + 1)}
    return set(names) - named
