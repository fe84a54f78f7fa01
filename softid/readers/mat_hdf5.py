"""MATLAB files of version 7.3, as ``save`` writes them with ``-v7.3``: HDF5 files.

A struct is a group, so a variable is known by its path. The dimensions are in the opposite order. A
text is an array of the numbers of its letters, and an empty array holds its own dimensions; both
say so in an attribute (MathWorks, *MAT-File Versions*).
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.errors import InputError, MissingExtraError
from softid.readers import files

SIGNATURE = b"\x89HDF\r\n\x1a\n"

SIGNED_WITHIN = 2048
"""Bytes in which the signature stands: MATLAB writes it behind a header of 512 bytes of its own,
and HDF5 looks for it at twice that and twice again."""

_NO_NUMBERS = 2
"""Length of what stands for something without numbers; one value would be a fact of the log."""

_OWN_PARTS = "#"
"""What the names of MATLAB's own parts begin with: cells, objects and function handles."""


def is_hdf5(data: bytes) -> bool:
    """Whether a MAT file is of version 7.3."""
    return data.startswith(b"MATLAB 7.3") or SIGNATURE in data[:SIGNED_WITHIN]


def hdf5_arrays(path: Path, data: bytes) -> list[tuple[str, str, npt.NDArray[Any]]]:
    """The parent's name, the own name and the values of every array.

    What is no channel, such as a cell or a timetable, is there without numbers, so that it can be
    said that it is left out.

    Parameters
    ----------
    path
        The file, for messages.
    data
        What it holds.

    Raises
    ------
    MissingExtraError
        h5py is not installed.
    InputError
        The file is damaged, or too large unpacked.
    """
    try:
        import h5py  # type: ignore[import-untyped]  # an optional dependency of some MB
    except ImportError:
        raise MissingExtraError(
            "reading MAT files of version 7.3 needs h5py, which is not installed",
            where=str(path),
            remedy="install it with: pip install softid[mat73], or save it in MATLAB with "
            "save(name, '-v7')",
        ) from None
    found: list[tuple[str, str, npt.NDArray[Any]]] = []
    left = files.SIZE_LIMIT_BYTES

    def look(name: str, part: Any) -> None:
        nonlocal left
        is_own = name.startswith(_OWN_PARTS) or "/" + _OWN_PARTS in name
        if not isinstance(part, h5py.Dataset) or is_own or part.attrs.get("MATLAB_empty", 0):
            return
        *above, own = name.split("/")
        parent = ".".join(above) or own
        kind = _kind_of(part)
        if kind is not None:
            found.append((parent, f"{own} ({kind})", np.empty(_NO_NUMBERS, object)))
            return
        left -= int(part.nbytes)
        if left < 0:
            limit = files.SIZE_LIMIT_BYTES / files.MEGABYTE
            raise files.too_large(path, f"over {limit:.0f} MB unpacked, with {name},")
        found.append((parent, own, _array_of(part)))

    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            file.visititems(look)
    except InputError:
        raise
    except Exception as error:  # damaged files raise whatever h5py meets
        raise InputError(
            "this is not a MAT file of version 7.3 that can be read: it is damaged or ends too "
            "early",
            where=str(path),
            remedy="copy it again, or save it in MATLAB with save(name, '-v7')",
        ) from error
    return found


def _kind_of(part: Any) -> str | None:
    """What MATLAB calls something that is no array of real numbers; None for one that is."""
    kind = part.attrs.get("MATLAB_class", b"")
    name = kind.decode("latin-1") if isinstance(kind, bytes) else str(kind)
    if "MATLAB_object_decode" in part.attrs:  # the numbers are those of an object elsewhere
        return name or "object"
    if part.dtype.kind in "fiub":
        return None
    return "complex" if part.dtype.names == ("real", "imag") else name or "no numbers"


def _array_of(part: Any) -> npt.NDArray[Any]:
    """A variable as MATLAB shows it."""
    values = np.asarray(part[()]).T
    if part.attrs.get("MATLAB_class") == b"char":
        return np.array("".join(map(chr, values.ravel(order="F"))))
    return values
