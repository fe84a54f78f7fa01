"""A process and copies of it that go on in step.

Each does all of the work, and a part of what is shared out. To make a copy takes milliseconds, and
every page of memory that either writes to afterwards is copied first, so a copy that lives on pays
for that only once. Nobody tells it what to do: from the same memory it comes to the same places by
itself, and only results are exchanged. Whether all mean the same is asked each time; a copy that
has gone astray is given up, and the first process does alone what is missing.
"""

from __future__ import annotations

import contextlib
import gc
import os
import signal
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from multiprocessing.connection import Connection, Pipe, wait
from typing import Any, TypeVar

from softid.interrupts import uninterrupted
from softid.parallel.known_objects import KnownObjects, NotKnownError

Item = TypeVar("Item")
Result = TypeVar("Result")

NUMBER_BYTES = 2
"""A task is claimed by its number in so many bytes."""

NO_MORE = (1 << 8 * NUMBER_BYTES) - 1
"""Number that says that no task is left to claim."""

PATIENCE = 20.0
"""The first process waits for a copy so many times as long as its own part took. A copy that takes
longer hangs: where the program has other threads, one may have held a lock when it was copied."""

LEAST_PATIENCE_S = 300.0
"""Shortest time in s that the first process waits for a copy; a judgement, as on a busy machine a
copy may not have a core."""

LOOKS_UP_S = 1.0
"""How often a copy that waits looks whether the first process is still there."""

MOST_TASKS = 20_000
"""Tasks at most whose numbers fit into a pipe, which holds 64 KiB."""


class Team:
    """A process and its copies; who makes one returns from it once in each member.

    Parameters
    ----------
    size
        Members. There are fewer where the system has no room for another process.

    Attributes
    ----------
    is_copy
        Whether this member is one of the copies.
    """

    is_copy: bool = False

    def __init__(self, size: int) -> None:
        self._copies: dict[int, Connection] = {}
        self._first: Connection | None = None
        self._process = os.getpid()
        self._pipe: tuple[int, int] | None = None
        try:
            with contextlib.suppress(OSError), uninterrupted():
                self._pipe = os.pipe()
                self._make_copies(size - 1)
        except BaseException:
            self.end()
            raise

    def _make_copies(self, count: int) -> None:
        for _ in range(count):
            own, theirs = Pipe()
            process = _fork()
            if process == 0:
                self._begin_as_copy(theirs, (own, *self._copies.values()))
                return
            theirs.close()
            self._copies[process] = own

    @property
    def is_alone(self) -> bool:
        """Whether the first process has lost its copies."""
        return not (self.is_copy or self._copies)

    def share(
        self, work: Callable[[Item], Result], tasks: Sequence[Item], *, is_last: bool = False
    ) -> tuple[dict[int, Result], dict[int, Exception]]:
        """Do a part of the tasks, and learn what the others have done.

        Parameters
        ----------
        work, tasks
            The same in every member; at most `MOST_TASKS`.
        is_last
            Whether nothing else is shared, so that copies need not know the results.

        Returns
        -------
        results, failures
            By the number of their task; what another member failed in or kept is in neither.
        """
        if self.is_alone:
            return {}, {}
        try:
            return self._shared(work, tasks, is_last=is_last)
        except BaseException:  # an interrupt, say, which the others know nothing of
            self._go_astray()
            raise

    def end(self) -> None:
        """End the copies; in one of them this never returns."""
        if self.is_copy:
            os._exit(0)
        self._give_up()
        for end in self._pipe or ():
            os.close(end)
        self._pipe = None

    def _shared(
        self, work: Callable[[Item], Result], tasks: Sequence[Item], *, is_last: bool
    ) -> tuple[dict[int, Result], dict[int, Exception]]:
        began = time.monotonic()
        known = KnownObjects(work, tasks)
        if not self.is_copy:
            self._offer(len(tasks))
        done: dict[int, Result] = {}
        failed: dict[int, Exception] = {}
        for k in self._claimed():
            try:
                done[k] = work(tasks[k])
            except Exception as error:  # noqa: BLE001 (the caller raises it in its turn)
                failed[k] = error
        own = _packed(done, known)
        patience_s = max(LEAST_PATIENCE_S, PATIENCE * (time.monotonic() - began))
        for data in self._exchanged(own, patience_s, is_last=is_last):
            done |= self._unpacked(data, known)
        return done, failed

    def _begin_as_copy(self, first: Connection, inherited: Sequence[Connection]) -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process ends its copies
        self.is_copy, self._first, self._copies = True, first, {}
        for connection in inherited:  # or nobody would see that the first process has ended
            connection.close()
        os.close(self._filling)
        gc.freeze()  # a collection would write to, and so copy, all memory that is shared
        _say_nothing()

    @property
    def _numbers(self) -> int:
        """Where numbers of tasks are read."""
        assert self._pipe is not None
        return self._pipe[0]

    @property
    def _filling(self) -> int:
        """Where they are written."""
        assert self._pipe is not None
        return self._pipe[1]

    def _offer(self, count: int) -> None:
        """Numbers of the tasks, each of which one member reads, and for each member the last."""
        numbers = (*range(count), *(NO_MORE for _ in range(1 + len(self._copies))))
        os.write(self._filling, b"".join(k.to_bytes(NUMBER_BYTES, "big") for k in numbers))

    def _claimed(self) -> Iterator[int]:
        """Numbers of tasks that no other member does."""
        while True:
            self._await(self._numbers)
            number = os.read(self._numbers, NUMBER_BYTES)
            k = int.from_bytes(number, "big") if number else NO_MORE
            if k == NO_MORE:
                return
            yield k

    def _await(self, end: int | Connection) -> None:
        """Wait until a pipe can be read; a copy only as long as there is a first process."""
        while self.is_copy:
            if os.getppid() != self._process:
                self._go_astray()
            if wait([end], LOOKS_UP_S):
                return

    def _exchanged(self, own: bytes, patience_s: float, *, is_last: bool) -> list[bytes]:
        """What the others have done; the first member hands on what it receives."""
        received: dict[int, bytes] = {}
        try:
            if self._first is not None:
                self._first.send_bytes(own)
                if not is_last:
                    self._await(self._first)
                return [] if is_last else list(self._first.recv())
            for process, connection in self._copies.items():
                if not connection.poll(patience_s):
                    raise TimeoutError
                received[process] = connection.recv_bytes()
            for process, connection in () if is_last else self._copies.items():
                others = (data for other, data in received.items() if other != process)
                connection.send([own, *others])
        except (EOFError, OSError):
            self._go_astray()
        return list(received.values())

    def _unpacked(self, data: bytes, known: KnownObjects) -> Mapping[int, Any]:
        try:
            return dict(known.unpacked(data))
        except NotKnownError:
            self._go_astray()
            return {}

    def _go_astray(self) -> None:
        """Go on without copies, one of which has ended or means something else."""
        if self.is_copy:
            os._exit(1)
        self._give_up()

    def _give_up(self) -> None:
        for process, connection in self._copies.items():
            connection.close()
            with contextlib.suppress(ChildProcessError, ProcessLookupError):
                if os.waitpid(process, os.WNOHANG) == (0, 0):  # else a program has waited for it
                    os.kill(process, signal.SIGKILL)
                    os.waitpid(process, 0)
        self._copies = {}


def _packed(done: Mapping[int, object], known: KnownObjects) -> bytes:
    """Results to send; none where one of them cannot be sent, so that the others do them, too."""
    try:
        return known.packed(done)
    except Exception:  # noqa: BLE001 (whatever a result of any kind raises when it is pickled)
        return known.packed({})


def _fork() -> int:
    with warnings.catch_warnings():
        # Python warns of threads that hold locks, which no task takes
        warnings.simplefilter("ignore", DeprecationWarning)
        return os.fork()


_unwritten: list[object] = []
"""Streams of the first process, which would write what they hold when nobody knew them any more."""


def _say_nothing() -> None:
    """The first process says everything already, also what waits to be written."""
    _unwritten.extend((sys.stdout, sys.stderr))
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nowhere, stream)
    sys.stdout = sys.stderr = os.fdopen(nowhere, "w")
