"""Sentences: how a text begins within one, and as one, and how parts are joined in it."""

from __future__ import annotations

from collections.abc import Iterable


def lowered(text: str) -> str:
    """The text with a small first letter."""
    return text[:1].lower() + text[1:]


def sentence(text: str) -> str:
    """The text with a capital letter and a full stop; the name of a log before a colon stays.

    Examples
    --------
    >>> sentence("the zero jumps"), sentence("step_1: the zero jumps")
    ('The zero jumps.', 'step_1: the zero jumps.')
    """
    is_name = text.partition(" ")[0].endswith(":")
    return f"{text}." if is_name else f"{text[:1].upper()}{text[1:]}."


def listed(parts: Iterable[str], *, last: str = " and ") -> str:
    """Parts joined as in a sentence.

    Examples
    --------
    >>> listed(["a"]), listed(["a", "b"]), listed(["a", "b", "c"], last=" or ")
    ('a', 'a and b', 'a, b or c')
    """
    *first, end = list(parts) or [""]
    return f"{', '.join(first)}{last}{end}" if first else end
