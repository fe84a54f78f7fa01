"""What several copies of a process know alike, so that none of it need be sent.

Copies that do the same work hold equal objects at different addresses. Those that a task can reach
are numbered in the order in which they are met. Only what an object consists of is followed: what
it has worked out and kept by the way may be there in one copy and not in another. A digest of the
names and numbers that are met tells whether two copies mean the same.
"""

from __future__ import annotations

import contextlib
import copyreg
import io
import pickle
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import is_dataclass
from functools import cached_property, partial
from hashlib import blake2b
from types import FunctionType, MappingProxyType, MethodType, ModuleType
from typing import Any

import numpy as np

PLAIN = (type(None), bool, int, float, complex, str, bytes, range, np.generic, type, ModuleType)
"""What is sent as it is, or by its name."""

FEW_NUMBERS = 64
"""Numbers of an array that count in the digest: all of parameters, some of a signal."""

DIGEST_BYTES = 8
"""Length of the digest: two objects that differ are taken for the same once in 10¹⁹."""


class NotKnownError(Exception):
    """What another copy has sent belongs to other tasks, or cannot be read."""


class KnownObjects:
    """What can be reached from some objects, in the same order in every copy of a process.

    Parameters
    ----------
    roots
        Where to begin.
    all_numbers
        Whether every number of a signal counts in the digest, and not only `FEW_NUMBERS`.
    """

    def __init__(self, *roots: object, all_numbers: bool = False) -> None:
        self._objects: list[object] = []
        self._numbers: dict[int, int] = {}
        met: list[object] = []
        waiting: list[object] = list(roots)
        while waiting:
            thing = waiting.pop()
            if isinstance(thing, PLAIN):
                met.append(thing.__name__ if isinstance(thing, type | ModuleType) else thing)
            elif id(thing) in self._numbers:
                met.append(self._numbers[id(thing)])
            else:
                self._numbers[id(thing)] = len(self._objects)
                self._objects.append(thing)
                parts = tuple(_parts(thing))
                met.append((_label(thing, all_numbers=all_numbers), len(parts)))
                waiting.extend(parts)
        self._digest = blake2b(repr(met).encode(), digest_size=DIGEST_BYTES).digest()

    @property
    def digest(self) -> bytes:
        """The same in every copy, and in every run of the same program with the same data."""
        return self._digest

    def packed(self, results: object) -> bytes:
        """The results as bytes, with what is known by its number."""
        stream = io.BytesIO()
        stream.write(self._digest)
        _Pickler(stream, self._numbers).dump(results)
        return stream.getvalue()

    def unpacked(self, data: bytes) -> Any:
        """What another copy has packed.

        Raises
        ------
        NotKnownError
            It belongs to other tasks, or cannot be read.
        """
        if data[:DIGEST_BYTES] != self._digest:
            raise NotKnownError
        try:
            return _Unpickler(io.BytesIO(data[DIGEST_BYTES:]), self._objects).load()
        except Exception as error:
            raise NotKnownError from error


class _Pickler(pickle.Pickler):
    """Sends what is known by its number."""

    dispatch_table = copyreg.dispatch_table.copy()
    dispatch_table[MappingProxyType] = lambda view: (_read_only, (dict(view),))

    def __init__(self, stream: io.BytesIO, numbers: Mapping[int, int]) -> None:
        super().__init__(stream, protocol=pickle.HIGHEST_PROTOCOL)
        self._numbers = numbers

    def persistent_id(self, thing: object) -> int | None:
        return self._numbers.get(id(thing))


def _read_only(values: dict[Any, Any]) -> Mapping[Any, Any]:
    return MappingProxyType(values)


class _Unpickler(pickle.Unpickler):
    def __init__(self, stream: io.BytesIO, objects: Sequence[object]) -> None:
        super().__init__(stream)
        self._objects = objects

    def persistent_load(self, number: Any) -> object:
        return self._objects[number]


def _label(thing: object, *, all_numbers: bool) -> object:
    """What is compared of something beside its parts."""
    if isinstance(thing, np.ndarray):
        some = thing.flat[:: 1 if all_numbers else max(1, thing.size // FEW_NUMBERS)]
        return thing.dtype.str, thing.shape, b"" if thing.dtype.hasobject else some.tobytes()
    if isinstance(thing, FunctionType):
        return thing.__qualname__, thing.__code__.co_firstlineno
    return getattr(thing, "__qualname__", type(thing).__qualname__)


def _parts(thing: object) -> Iterable[object]:
    """What something consists of."""
    if isinstance(thing, np.ndarray):
        return ()
    if isinstance(thing, FunctionType):
        return (thing.__defaults__, thing.__kwdefaults__, *_enclosed(thing))
    if isinstance(thing, partial):
        return (thing.func, thing.args, thing.keywords)
    if isinstance(thing, MethodType):
        return (thing.__func__, thing.__self__)
    if isinstance(thing, Mapping):
        return (*thing.keys(), *thing.values())
    if isinstance(thing, tuple | list | set | frozenset):
        return thing
    if is_dataclass(thing):
        return [getattr(thing, name, None) for name in thing.__dataclass_fields__]
    kept, kind = vars(thing) if hasattr(thing, "__dict__") else {}, type(thing)
    return [kept[k] for k in kept if not isinstance(getattr(kind, k, None), cached_property)]


def _enclosed(function: FunctionType) -> Iterator[object]:
    """What a closure holds of the function around it."""
    for cell in function.__closure__ or ():
        with contextlib.suppress(ValueError):  # a variable that has no value yet
            yield cell.cell_contents
