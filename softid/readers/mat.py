"""MATLAB files, version 5 and its predecessors."""

from __future__ import annotations

import io
from collections.abc import Iterator
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.errors import InputError
from softid.readers import files
from softid.readers.arrays import flattened, table_of_arrays, unique_names
from softid.readers.base import Table

_BYTES_PER_NUMBER = 8
_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def read_mat(path: Path) -> Table:
    """Read the numeric vectors of a MATLAB file; fields of structs count as variables.

    Parameters
    ----------
    path
        File saved by MATLAB with ``-v7``, ``-v6`` or ``-v4``, or by `scipy.io.savemat`.

    Raises
    ------
    InputError
        The file is of version 7.3, is damaged, is too large or holds no channels.
    """
    content = files.read_content(path)
    data = content.data
    if data.startswith(b"MATLAB 7.3") or _HDF5_SIGNATURE in data[:2048]:
        raise InputError(
            "MAT files of version 7.3 are HDF5, which softid does not read",
            where=str(path),
            remedy="save it in MATLAB with save(name, '-v7'), or as CSV",
        )
    named = unique_names(_variables(path, data))
    return table_of_arrays(named, path=str(path), sha256=content.sha256, file_format="mat")


def _variables(path: Path, data: bytes) -> Iterator[tuple[str, str, npt.NDArray[Any]]]:
    from scipy.io import loadmat, whosmat  # 0.2 s, and only MAT files need it

    try:
        shapes = [shape for _, shape, _ in whosmat(io.BytesIO(data))]  # type: ignore[arg-type]
        size = sum(prod(map(int, shape)) for shape in shapes) * _BYTES_PER_NUMBER
        if size > files.SIZE_LIMIT_BYTES:
            raise files.too_large(path, f"{size / files.MEGABYTE:.0f} MB")
        variables = loadmat(io.BytesIO(data))  # type: ignore[arg-type]
    except InputError:
        raise
    except Exception as error:  # damaged files make scipy raise whatever it meets
        raise InputError(
            f"this is not a MAT file that can be read ({type(error).__name__}: {error})",
            where=str(path),
            remedy="save it again in MATLAB with save(name, '-v7'), or as CSV",
        ) from error
    for name, value in variables.items():
        if not name.startswith("__") and isinstance(value, np.ndarray):
            for field, array in flattened(name, value):
                yield name, field, array
