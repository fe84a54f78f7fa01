"""NumPy archives, without pickled objects."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.errors import InputError
from softid.readers import files
from softid.readers.arrays import flattened, table_of_arrays, unique_names
from softid.readers.base import Table


def read_npz(path: Path) -> Table:
    """Read the arrays of an NPZ archive; fields of structured arrays count as arrays.

    Parameters
    ----------
    path
        File written by `numpy.savez` or `numpy.savez_compressed`.

    Raises
    ------
    InputError
        The file is damaged, is too large unpacked, holds pickled objects or no channels.
    """
    content = files.read_content(path)
    named = unique_names(_arrays(path, content.data))
    return table_of_arrays(named, path=str(path), sha256=content.sha256, file_format="npz")


def _arrays(path: Path, data: bytes) -> Iterator[tuple[str, str, npt.NDArray[Any]]]:
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            size = sum(member.file_size for member in archive.infolist())
        if size > files.SIZE_LIMIT_BYTES:
            raise files.too_large(path, f"{size / files.MEGABYTE:.0f} MB unpacked")
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except InputError:
        raise
    except Exception as error:  # damaged archives raise whatever zip and numpy meet
        what, remedy = _reason(data, error), "write it again with numpy.savez"
        if "allow_pickle" in str(error):
            what, remedy = "it holds pickled objects", "save plain arrays of numbers only"
        raise InputError(
            f"this is not an NPZ archive that can be read: {what}",
            where=str(path),
            remedy=remedy,
        ) from error
    if not arrays:
        raise InputError(
            "the archive holds no arrays",
            where=str(path),
            remedy="save time and channels with numpy.savez(name, time_s=…, pressure_kpa=…)",
        )
    for name, array in arrays.items():
        if isinstance(array, np.ndarray):
            for field, part in flattened(name, array):
                yield name, field, part


def _reason(data: bytes, error: Exception) -> str:
    """What is wrong with an archive, in words of the file and not of a library."""
    if not data.startswith(b"PK"):
        return "its first bytes are not those of an archive"
    if isinstance(error, zipfile.BadZipFile):
        crc = "CRC" in str(error)
        return "an array in it is damaged" if crc else "it is damaged or ends too early"
    if isinstance(error, MemoryError):
        return "an array in it is larger than the memory"
    return "an array in it is damaged"
