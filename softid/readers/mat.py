"""MATLAB files of version 5, as ``save`` writes them with ``-v6`` and ``-v7``.

Those of version 7.3 are HDF5 (`mat_hdf5`). The others are parsed here and not by
`scipy.io.loadmat`, because a damaged file makes its compiled code crash the whole process. The
format is a sequence of tagged elements (MathWorks, *MAT-File Format*, chapter 1): an 8-byte tag
with type and length, then the data, padded to 8 bytes.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from softid.errors import InputError
from softid.readers import files
from softid.readers.arrays import table_of_arrays, unique_names
from softid.readers.base import Table
from softid.readers.mat_hdf5 import hdf5_arrays, is_hdf5

_HEADER_BYTES = 128
_NUMBER_TYPES = {
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    9: "f8",
    12: "i8",
    13: "u8",
}
_MATRIX, _COMPRESSED = 14, 15
_STRUCT_CLASS, _CHAR_CLASS = 2, 4
_NUMBER_CLASSES = range(6, 16)
_COMPLEX_FLAG = 0x0800
_TEXT_TYPES = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_DEEPEST_STRUCT = 8

Part = tuple[str, npt.NDArray[Any]]


class _DamagedError(ValueError):
    """The bytes are not those of a MAT file."""


@dataclass(frozen=True)
class _Variable:
    """A named array, or the parts that a struct consists of."""

    name: str
    parts: tuple[Part, ...]


def read_mat(path: Path) -> Table:
    """Read the numeric vectors of a MATLAB file; fields of structs count as variables.

    Parameters
    ----------
    path
        File saved by MATLAB, or by `scipy.io.savemat`.

    Raises
    ------
    MissingExtraError
        It is of version 7.3, and h5py is not installed.
    InputError
        It is damaged, is too large or holds no channels.
    """
    content = files.read_content(path)
    data = content.data
    if is_hdf5(data):
        named = unique_names(iter(hdf5_arrays(path, data)))
        return table_of_arrays(named, path=str(path), sha256=content.sha256, file_format="mat")
    order = {b"IM": "<", b"MI": ">"}.get(data[_HEADER_BYTES - 2 : _HEADER_BYTES])
    try:
        if order is None:
            raise _DamagedError("the header of version 5 is missing")
        named = unique_names(_variables(path, memoryview(data)[_HEADER_BYTES:], order))
    except (_DamagedError, zlib.error, struct.error, UnicodeDecodeError) as error:
        raise InputError(
            f"this is not a MAT file of version 5 that can be read: {_reason(error)}",
            where=str(path),
            remedy="save it again in MATLAB with save(name, '-v7'), or as CSV",
        ) from error
    return table_of_arrays(named, path=str(path), sha256=content.sha256, file_format="mat")


def _reason(error: Exception) -> str:
    """What is wrong with a file, in words of the file and not of a library."""
    return str(error) if isinstance(error, _DamagedError) else "a variable in it is damaged"


def _variables(
    path: Path, buffer: memoryview, order: str
) -> Iterator[tuple[str, str, npt.NDArray[Any]]]:
    left = files.SIZE_LIMIT_BYTES
    for kind, payload in _elements(buffer, order):
        if kind == _COMPRESSED:
            inflater = zlib.decompressobj()
            unpacked = memoryview(inflater.decompress(payload, left))
            if inflater.unconsumed_tail:
                limit = files.SIZE_LIMIT_BYTES / files.MEGABYTE
                raise files.too_large(path, f"over {limit:.0f} MB unpacked")
            left = max(left - len(unpacked), 1)
            inner = list(_elements(unpacked, order))
        else:
            inner = [(kind, payload)]
        for inner_kind, inner_payload in inner:
            if inner_kind == _MATRIX:
                variable = _matrix(inner_payload, order, depth=0)
                for name, array in variable.parts:
                    *above, field = (
                        f"{variable.name}.{name}".split(".") if name else [variable.name]
                    )
                    yield ".".join(above) or variable.name, field, array


def _elements(buffer: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    at = 0
    while at + 8 <= len(buffer):
        kind, size = struct.unpack_from(f"{order}II", buffer, at)
        start = at + 8
        if kind >> 16:  # up to four bytes are packed into the tag itself
            kind, size, start = kind & 0xFFFF, kind >> 16, at + 4
            at += 8
            if size > 4:
                raise _DamagedError(f"a short element of {size} bytes")
        else:
            at = start + size + (0 if kind == _COMPRESSED else -size % 8)
        if start + size > len(buffer):
            raise _DamagedError("it ends in the middle of a variable")
        yield kind, buffer[start : start + size]


def _matrix(payload: memoryview, order: str, *, depth: int) -> _Variable:
    """An array element: flags, dimensions, name, then what its class says."""
    parts = list(_elements(payload, order))
    if len(parts) < 3:
        return _Variable("", ())
    flags = int(_numbers(parts[0], order, 1)[0])
    shape = tuple(int(size) for size in _numbers(parts[1], order, 2))
    name = bytes(parts[2][1]).decode("latin-1")
    kind, body = flags & 0xFF, parts[3:]
    if kind == _STRUCT_CLASS and shape == (1, 1) and depth < _DEEPEST_STRUCT:
        return _Variable(name, tuple(_fields(body, order, depth)))
    if kind == _CHAR_CLASS and body:
        return _Variable(name, (("", np.array(_text(body[0], order))),))
    if kind not in _NUMBER_CLASSES or flags & _COMPLEX_FLAG or not body:
        return _Variable(name, ())
    values = _numbers(body[0], order, 0)
    if min(shape) < 0 or prod(shape) != values.size:
        raise _DamagedError(f"{name} has {values.size} numbers where {shape} are announced")
    return _Variable(name, (("", values.reshape(shape, order="F")),))


def _fields(body: list[tuple[int, memoryview]], order: str, depth: int) -> Iterator[Part]:
    if len(body) < 2:
        raise _DamagedError("a struct without fields")
    width = int(_numbers(body[0], order, 1)[0])
    text = bytes(body[1][1])
    if width < 1:
        raise _DamagedError("a struct with names of no length")
    names = [
        text[k : k + width].split(b"\0")[0].decode("latin-1") for k in range(0, len(text), width)
    ]
    for field, (kind, payload) in zip(names, body[2:], strict=False):
        if kind == _MATRIX:
            for deeper, array in _matrix(payload, order, depth=depth + 1).parts:
                yield (f"{field}.{deeper}" if deeper else field), array


def _numbers(element: tuple[int, memoryview], order: str, least: int) -> npt.NDArray[Any]:
    kind, payload = element
    code = _NUMBER_TYPES.get(kind)
    if code is None or len(payload) % int(code[1]):
        raise _DamagedError(f"{len(payload)} bytes of type {kind} are no numbers")
    values = np.frombuffer(payload, dtype=f"{order}{code}")
    if values.size < least:
        raise _DamagedError(f"{values.size} numbers where {least} are needed")
    return values


def _text(element: tuple[int, memoryview], order: str) -> str:
    kind, payload = element
    encoding = _TEXT_TYPES.get(kind, "latin-1")
    if encoding in ("utf-16", "utf-32"):
        encoding += "-le" if order == "<" else "-be"
    return bytes(payload).decode(encoding)
