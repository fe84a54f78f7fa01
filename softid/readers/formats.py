"""Which reader opens which file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from softid.errors import InputError
from softid.readers.bag import read_bag
from softid.readers.base import Reader
from softid.readers.csv import read_csv
from softid.readers.mat import read_mat
from softid.readers.npz import read_npz
from softid.readers.parquet import read_parquet

_TEXT = (".csv", ".txt", ".tsv", ".dat")

READERS: Mapping[str, Reader] = {
    **dict.fromkeys(_TEXT, read_csv),
    **{f"{suffix}.gz": read_csv for suffix in _TEXT},
    ".mat": read_mat,
    ".npz": read_npz,
    ".parquet": read_parquet,
    **dict.fromkeys((".bag", ".db3", ".mcap"), read_bag),
}
"""Ending of the file's name → reader."""

_PACKED = {
    **dict.fromkeys((".zst", ".zstd"), "unzstd"),
    ".bz2": "bunzip2",
    ".xz": "unxz",
    ".zip": "unzip",
}
"""Ending → what unpacks such a file."""


def split_suffix(path: Path) -> tuple[str, str]:
    """Stem and known ending of a file's name.

    Raises
    ------
    InputError
        No reader knows the ending.
    """
    lower = path.name.lower()
    for suffix in sorted(READERS, key=len, reverse=True):
        if lower.endswith(suffix) and len(lower) > len(suffix):
            return path.name[: -len(suffix)], suffix
    if path.suffix.lower() in _PACKED:
        raise InputError(
            "this file is compressed as a whole",
            where=str(path),
            value=path.suffix,
            remedy=f"unpack it first, with {_PACKED[path.suffix.lower()]}",
        )
    raise InputError(
        "no reader knows this kind of file",
        where=str(path),
        value=path.suffix or path.name,
        remedy=f"the known endings are {', '.join(READERS)}",
    )
