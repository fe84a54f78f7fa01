"""From a path to bytes: what can be wrong with a file before anybody looks inside."""

from __future__ import annotations

import gzip
import io
import stat
import zlib
from dataclasses import dataclass
from pathlib import Path

from softid.errors import InputError
from softid.fingerprint import content_fingerprint, stream_fingerprint

SIZE_LIMIT_BYTES = 512 * 2**20
"""Largest content that is read at once, after decompression."""

CHUNK_BYTES = 2**20
GZIP_SIGNATURE = b"\x1f\x8b"
MEGABYTE = 2**20

_SIGNATURES: tuple[tuple[bytes, str, str], ...] = (
    (b"PK\x03\x04", "a zip archive (NPZ or a spreadsheet)", ".npz, or export a spreadsheet to CSV"),
    (b"PAR1", "Parquet", ".parquet"),
    (b"MATLAB", "a MAT file", ".mat"),
    (b"#ROSBAG V", "a ROS 1 bag", ".bag"),
    (b"SQLite format 3\x00", "an SQLite file, as ROS 2 bags are", ".db3"),
    (b"\x89MCAP", "MCAP", ".mcap"),
    (b"\x89HDF", "HDF5 (a MAT file of version 7.3)", ".mat"),
)


@dataclass(frozen=True)
class Content:
    """A file's bytes.

    Attributes
    ----------
    data
        Content, decompressed where that was asked for.
    sha256
        Fingerprint of the bytes on disk.
    """

    data: bytes
    sha256: str


def require_file(path: Path) -> int:
    """Size of a regular file in bytes.

    Raises
    ------
    InputError
        There is nothing, a folder or something that is not a file, or it may not be looked at.
    """
    try:
        status = path.stat()
    except FileNotFoundError:
        raise InputError(
            "there is no such file", where=str(path), remedy="check the name and the folder"
        ) from None
    except (OSError, ValueError) as error:
        raise _unreadable(path, error) from error
    if stat.S_ISDIR(status.st_mode):
        is_bag = (path / "metadata.yaml").exists()
        raise InputError(
            "this is a folder, not a log",
            where=str(path),
            remedy="name one of the files of the bag in it" if is_bag else "name the files in it",
        )
    if not stat.S_ISREG(status.st_mode):
        raise InputError(
            "this is not a regular file", where=str(path), remedy="save the log to a file first"
        )
    return status.st_size


def read_content(path: Path, *, compressed: bool | None = False) -> Content:
    """Read a whole file, or refuse it for its size.

    Parameters
    ----------
    path
        File to read.
    compressed
        Whether it must be gzip-compressed; None to look at its first bytes.

    Raises
    ------
    InputError
        The file is missing, empty, unreadable, too large, or damaged as a gzip file.
    """
    size = require_file(path)
    if size == 0:
        raise InputError(
            "the file is empty", where=str(path), remedy="check how it was recorded or copied"
        )
    if size > SIZE_LIMIT_BYTES:
        raise too_large(path, f"{size / MEGABYTE:.0f} MB")
    try:
        data = path.read_bytes()
    except OSError as error:
        raise _unreadable(path, error) from error
    sha256 = content_fingerprint(data)
    if compressed is None:
        compressed = data.startswith(GZIP_SIGNATURE)
    return Content(_decompressed(path, data) if compressed else data, sha256)


def first_bytes(path: Path, count: int) -> bytes:
    """The beginning of a file, by which formats are told.

    Raises
    ------
    InputError
        The file cannot be read.
    """
    try:
        with path.open("rb") as stream:
            return stream.read(count)
    except OSError as error:
        raise _unreadable(path, error) from error


def file_fingerprint(path: Path) -> str:
    """The sha256 of a file that is too large to hold, read piece by piece.

    Raises
    ------
    InputError
        The file cannot be read.
    """
    try:
        with path.open("rb") as stream:
            return stream_fingerprint(stream)
    except OSError as error:
        raise _unreadable(path, error) from error


def refuse_other_format(path: Path, data: bytes) -> None:
    """Say so when a text file's content is that of another format.

    Raises
    ------
    InputError
        The first bytes are another format's signature.
    """
    for signature, name, suffix in _SIGNATURES:
        if data.startswith(signature):
            raise InputError(
                f"the content is {name}, not text",
                where=str(path),
                remedy=f"rename the file to {suffix}",
            )


def too_large(path: Path, size: str) -> InputError:
    """The refusal of a file above the limit."""
    return InputError(
        f"the content is {size}, more than the {SIZE_LIMIT_BYTES / MEGABYTE:.0f} MB that are read "
        "at once",
        where=str(path),
        remedy="cut the log to the part of interest, or convert it to Parquet, of which only the "
        "needed columns are read",
    )


def _decompressed(path: Path, data: bytes) -> bytes:
    pieces: list[bytes] = []
    total = 0
    try:
        with gzip.open(io.BytesIO(data)) as stream:
            while piece := stream.read(CHUNK_BYTES):
                pieces.append(piece)
                total += len(piece)
                if total > SIZE_LIMIT_BYTES:
                    raise too_large(path, f"over {SIZE_LIMIT_BYTES / MEGABYTE:.0f} MB unpacked")
    except EOFError:
        raise InputError(
            f"the gzip file ends too early, after {len(data)} bytes",
            where=str(path),
            remedy="copy it again from where it was recorded, or unpack what is left with zcat",
        ) from None
    except (gzip.BadGzipFile, zlib.error) as error:
        raise InputError(
            "this is not a sound gzip file",
            where=str(path),
            remedy="copy it again, or drop .gz from the name if it was never compressed",
        ) from error
    if total == 0:
        raise InputError(
            "the compressed file is empty", where=str(path), remedy="check how it was recorded"
        )
    return b"".join(pieces)


def _unreadable(path: Path, error: Exception) -> InputError:
    if isinstance(error, PermissionError):
        return InputError(
            "there is no permission to read it", where=str(path), remedy="change its access rights"
        )
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return InputError(
        f"it cannot be read ({reason})", where=str(path), remedy="check the path and the disk"
    )
