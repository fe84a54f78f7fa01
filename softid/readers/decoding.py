"""From bytes to lines of text, whatever the encoding and the line ends."""

from __future__ import annotations

import codecs
import re

from softid.errors import InputError

MOST_CONTROL_SHARE = 0.01
"""Above this share of control characters a file is taken for something else than text."""

_MARKS: tuple[tuple[bytes, str], ...] = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_MINUS_BEFORE_NUMBER = re.compile(r"\N{MINUS SIGN}(?=[\d.,])")
_CONTROL = bytes(set(range(32)) - set(b"\t\n\v\f\r"))


def decode(data: bytes, *, where: str) -> str:
    """Decode text by its byte order mark, else as UTF-8, else as Latin-1.

    Parameters
    ----------
    data
        Content of a file.
    where
        File named in the error.

    Raises
    ------
    InputError
        The bytes are no text.
    """
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            try:
                return data.decode(encoding)
            except UnicodeDecodeError as error:
                raise InputError(
                    f"the text is not the {encoding} that its first bytes promise",
                    where=f"{where}, byte {error.start + 1}",
                    remedy="save it as UTF-8",
                ) from error
    size = len(data)
    data = data.rstrip(b"\x00\x1a")  # a logger that lost power, or a DOS end-of-file mark
    if size and not data:
        raise InputError(
            f"the file is {size} bytes of nothing but zeros",
            where=where,
            remedy="copy it again from the logger; one that loses power reserves a file like this",
        )
    controls = len(data) - len(data.translate(None, _CONTROL))
    if b"\x00" in data or controls > MOST_CONTROL_SHARE * len(data):
        first = min(position for position, byte in enumerate(data) if byte in _CONTROL)
        raise InputError(
            "this is not text but binary data",
            where=f"{where}, byte {first + 1}",
            value=data[first : first + 4],
            remedy="export the log as CSV in UTF-8",
        )
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def with_plain_minus(text: str) -> str:
    """The text with a hyphen for the typographic minus of numbers; names keep theirs.

    Examples
    --------
    >>> with_plain_minus("p \N{MINUS SIGN} p0;\N{MINUS SIGN}0.5") == "p \N{MINUS SIGN} p0;-0.5"
    True
    """
    return _MINUS_BEFORE_NUMBER.sub("-", text) if "\N{MINUS SIGN}" in text else text


def split_lines(text: str) -> list[str]:
    """Lines of a text whose ends may be LF, CRLF or bare CR; blank ones at the end are dropped."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    while lines and not lines[-1].strip():
        lines.pop()
    return lines
