"""What was shared out and done, kept in a file from which an interrupted run goes on.

The same program with the same data comes to the same places, so what it did at each of them is
known by the place's number and by a digest of what could be reached there. Results name what both
runs know instead of copying it, as those do that copies of a process send each other.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import struct
import sys
import time
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import NamedTemporaryFile
from types import TracebackType
from typing import Any, BinaryIO, TypeVar

from softid.errors import UsageError
from softid.interrupts import uninterrupted
from softid.parallel import KnownObjects, NotKnownError

Item = TypeVar("Item")
Result = TypeVar("Result")

BEGINS_AFTER_S = 5.0
"""Time in s before which nothing is kept: who loses less than that does not mind, and what is over
by then writes no file."""

MOST_BYTES = 4 * 2**30
"""Size of a file beyond which nothing is added; what comes after is done anew. A judgement: minutes
of a diagnosis, on a disk that has room for it."""

MOST_OF_FREE = 0.1
"""Share of what is free on the disk beyond which nothing is added, either."""

GOES_ON = "going on from an interrupted run"
"""What the progress of a run that goes on begins with."""

MARK = b"softid checkpoint 1\n"
"""What a file begins with, before the key."""

HEAD = struct.Struct(">IQI")
"""Before each entry: the number of the place, the bytes that follow, and their check sum."""


class Checkpoint:
    """What `softid.parallel.in_parallel` did, for a run that is interrupted and begun again.

    A `Keeper`, and a context manager: the file is removed where the block ends or fails, and stays
    where it is interrupted. Where it cannot be written, or another run uses it, nothing is kept.

    Parameters
    ----------
    path
        The file. What it holds is code to whoever reads it, so it belongs where only the user may
        write.
    key
        Tells data and program from others; a file with another key is begun anew.

    Attributes
    ----------
    goes_on
        Whether the file holds what an earlier run has done.

    Raises
    ------
    UsageError
        The file is there and is no checkpoint.
    """

    def __init__(self, path: Path, key: str) -> None:
        self._path = path
        self._header = MARK + key.encode() + b"\n"
        self._began = time.monotonic()
        self._place = 0
        self._entries: dict[int, tuple[int, int, int]] = {}
        self._end = len(self._header)
        self._most_bytes = 0
        self._file: BinaryIO | None = None
        self._is_given_up = False
        if path.exists():
            _require_own(path)
            self._take()
            self._note_entries()
        self.goes_on = bool(self._entries)

    def __enter__(self) -> Checkpoint:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        was_interrupted = kind is not None and not issubclass(kind, Exception)
        is_empty = self._end == len(self._header)
        if self._file is not None and (is_empty or not was_interrupted):
            with contextlib.suppress(OSError):
                self._path.unlink(missing_ok=True)
        self._give_up()

    def resumed(
        self,
        work: Callable[[Item], Result],
        tasks: Sequence[Item],
        do: Callable[[], list[Result]],
        *,
        is_copy: bool,
    ) -> list[Result]:
        """Results that were kept at this place, else what is done now; see `Keeper.resumed`."""
        self._place += 1
        is_kept = self._place in self._entries
        if not is_kept and (is_copy or self._is_early):
            return do()
        known = KnownObjects(work, tasks)  # as it is before the work changes anything by the way
        if is_kept:
            with contextlib.suppress(OSError, NotKnownError):
                return list(self._recalled(known))
            self._end = self._entries[self._place][0]  # nor does anything behind it belong here
            self._entries = {}
        results = do()
        if not is_copy:
            self._keep(known, results)
        return results

    @property
    def _is_early(self) -> bool:
        """Whether nothing is to be kept yet, or what an earlier run kept is still to come."""
        if self._is_given_up or any(place > self._place for place in self._entries):
            return True
        return not self.goes_on and time.monotonic() - self._began < BEGINS_AFTER_S

    def _take(self) -> None:
        """Make the file if there is none, and let no other run write to it."""
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            if not self._path.exists():
                self._make()
            free = shutil.disk_usage(self._path.parent).free
            file = self._path.open("r+b")
        except OSError:
            self._is_given_up = True
            return
        if not _locked(file):
            file.close()
            self._is_given_up = True
            return
        self._file = file
        size = file.seek(0, os.SEEK_END)
        file.seek(0)
        self._most_bytes = min(MOST_BYTES, int(MOST_OF_FREE * free) + size)

    def _make(self) -> None:
        """Make the file, whole from the first moment on: one without a beginning is not ours."""
        folder = str(self._path.parent)
        with NamedTemporaryFile(dir=folder, prefix=self._path.name, delete=False) as new:
            new.write(self._header)
        Path(new.name).replace(self._path)

    def _note_entries(self) -> None:
        """Note what an earlier run has kept, and where it is."""
        file = self._file
        if file is None or file.read(len(self._header)) != self._header:
            return
        size = self._path.stat().st_size
        while len(head := file.read(HEAD.size)) == HEAD.size:
            place, length, check = HEAD.unpack(head)
            behind = self._end + HEAD.size + length
            if behind > size:  # the run was killed while it wrote
                return
            self._entries[place] = (self._end, length, check)
            self._end = behind
            file.seek(behind)

    def _recalled(self, known: KnownObjects) -> Any:
        """What was kept at this place.

        Raises
        ------
        OSError, NotKnownError
            It cannot be read, or belongs to another way through the program.
        """
        at, length, check = self._entries[self._place]
        with self._path.open("rb") as file:  # copies share the place at which the other one reads
            file.seek(at + HEAD.size)
            data = file.read(length)
        if zlib.crc32(data) != check:
            raise NotKnownError
        return known.unpacked(data)

    def _keep(self, known: KnownObjects, results: object) -> None:
        if self._file is None:
            self._take()
        try:
            data = known.packed(results)
        except Exception:  # noqa: BLE001 (whatever a result of any kind raises when it is pickled)
            return
        if self._file is None or self._end + len(data) > self._most_bytes:
            return
        try:
            with uninterrupted():
                self._file.seek(0)
                self._file.write(self._header)  # in the place of that of another program or data
                self._file.seek(self._end)
                self._file.write(HEAD.pack(self._place, len(data), zlib.crc32(data)) + data)
                self._file.truncate()
                self._file.flush()
                self._end += HEAD.size + len(data)
        except OSError:  # the disk is full, say
            self._give_up()

    def _give_up(self) -> None:
        self._is_given_up = True
        if self._file is not None:
            with contextlib.suppress(OSError):
                self._file.close()
        self._file = None


def is_in_use(path: Path) -> bool:
    """Whether a run keeps what it does in this file."""
    try:
        with path.open("r+b") as file:
            return not _locked(file)
    except OSError:
        return False


def _require_own(path: Path) -> None:
    """Refuse what is not ours to write to, let alone to remove.

    Raises
    ------
    UsageError
        It is no file, or holds something else.
    """
    begin = b""
    if path.is_file():
        with contextlib.suppress(OSError), path.open("rb") as file:
            begin = file.read(len(MARK))
    if begin != MARK:
        raise UsageError(
            "this is no checkpoint of softid",
            where="checkpoint",
            value=str(path),
            remedy="name a file that does not exist yet",
        )


def _locked(file: BinaryIO) -> bool:
    """Whether the file belongs to this run and its copies alone from here on."""
    if sys.platform == "win32":
        return False
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
