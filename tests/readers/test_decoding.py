"""Bytes to text: what is text in some encoding is read, what is none is refused."""

from __future__ import annotations

import pytest

from softid.errors import InputError
from softid.readers.decoding import decode, split_lines


@pytest.mark.parametrize(
    ("data", "text"),
    [
        ("Winkel °".encode(), "Winkel °"),
        ("Winkel °".encode("latin-1"), "Winkel °"),
        ("Winkel °".encode("utf-16"), "Winkel °"),
        (b"\xef\xbb\xbfa,b", "a,b"),
        (b"1,2\n" + bytes(500), "1,2\n"),  # a logger that lost power
        (b"1,2\r\n\x1a", "1,2\r\n"),  # the end-of-file mark of DOS
        (b"", ""),
    ],
)
def test_text(data: bytes, text: str) -> None:
    assert decode(data, where="log.csv") == text


@pytest.mark.parametrize(
    ("data", "byte"),
    [
        (bytes(range(256)), 1),
        (b"1,2\n\x00\x001,2\n", 5),
        ("a,b".encode("utf-16-le"), 2),  # without its mark
        (b"\x01\x02 some \x03\x04 binary", 1),
    ],
)
def test_no_text(data: bytes, byte: int) -> None:
    with pytest.raises(InputError, match="not text but binary") as caught:
        decode(data, where="log.csv")
    assert caught.value.where == f"log.csv, byte {byte}"


def test_a_broken_promise() -> None:
    with pytest.raises(InputError, match="not the utf-8-sig that its first bytes promise"):
        decode(b"\xef\xbb\xbfa\xff\xff", where="log.csv")


def test_lines() -> None:
    """Unicode line separators and form feeds belong to the text, unlike in str.splitlines."""
    assert split_lines("a\r\nb\rc\nd\u2028e\x0cf\n\n \n") == ["a", "b", "c", "d\u2028e\x0cf"]
