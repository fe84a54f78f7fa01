"""Work that is shared by the processor's cores.

Compiled kernels release Python's lock, but what lies between their calls does not, so threads of
short kernels wait for one another. Where the system can fork, copies of the process work beside it;
they know all that it knows, so nothing is sent to them, and what they send back names what it knew
already instead of copying it. Elsewhere threads do the work. Meanwhile a matrix product or a
factorisation takes one thread: those of small matrices in several processes at once wait for one
another for longer than the work takes.
"""

from __future__ import annotations

import contextlib
import copyreg
import gc
import io
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache, partial
from multiprocessing.connection import Connection, Pipe
from multiprocessing.process import BaseProcess
from types import FunctionType, MappingProxyType, MethodType, ModuleType
from typing import Any, TypeVar

import numpy as np
from threadpoolctl import ThreadpoolController

Item = TypeVar("Item")
Result = TypeVar("Result")

MAX_WORKERS = 4
"""Workers at most. To fork takes 5 ms a process, one after the other, and the tasks of a diagnosis
are a few dozen of a few milliseconds each."""

NUMBER_BYTES = 2
"""A task is claimed by its number in so many bytes, and a pipe holds 64 KiB of them."""

MOST_FORKED = 20_000
"""Tasks at most whose numbers fit into a pipe."""

PLAIN = (type(None), bool, int, float, complex, str, bytes, np.generic, type, ModuleType)
"""What is sent as it is, or by its name."""

_here = threading.local()
"""Whether the thread at hand works on a part already, so that it shares nothing out itself."""


def in_parallel(
    work: Callable[[Item], Result], items: Iterable[Item], *, workers: int | None = None
) -> list[Result]:
    """Results of ``work`` for every item, in order.

    What ``work`` changes beside its result may be lost. An error reaches the caller.

    Parameters
    ----------
    work
        What to do, which may be a closure.
    items
        What to do it with.
    workers
        How many work; by default as many as there are cores, up to `MAX_WORKERS`.

    Examples
    --------
    >>> in_parallel(lambda number: number**2, range(4))
    [0, 1, 4, 9]
    """
    tasks = list(items)
    if getattr(_here, "has_part", False):
        return [work(task) for task in tasks]
    workers = min(workers or min(MAX_WORKERS, _cores()), len(tasks))
    with matrices_on_one_thread():
        return _shared_out(work, tasks, workers)


@contextlib.contextmanager
def matrices_on_one_thread() -> Iterator[None]:
    """Keep matrix libraries to one thread inside the ``with`` block, or in a decorated function.

    The matrices of a fit are narrow: a second thread hardly helps, and where another program has
    the core, both wait for it, at many times the cost of the product.

    Examples
    --------
    >>> with matrices_on_one_thread():
    ...     float(np.ones(2) @ np.ones(2))
    2.0
    """
    with _matrix_libraries("scipy.linalg" in sys.modules).limit(limits=1, user_api="blas"):
        yield


def _shared_out(
    work: Callable[[Item], Result], tasks: Sequence[Item], workers: int
) -> list[Result]:
    if workers < 2:
        return [work(task) for task in tasks]
    if _can_fork() and len(tasks) <= MOST_FORKED:
        _take_part(True)  # copies begin with what this thread has
        try:
            return _in_processes(work, tasks, workers)
        finally:
            _take_part(False)
    with ThreadPoolExecutor(workers, initializer=_take_part, initargs=(True,)) as pool:
        return list(pool.map(work, tasks))


@cache
def _matrix_libraries(of_scipy: bool) -> ThreadpoolController:
    """Those that are loaded; scipy brings one of its own. To look for them takes 1 ms."""
    del of_scipy
    return ThreadpoolController()


def _take_part(does: bool) -> None:
    _here.has_part = does


def _cores() -> int:
    """Cores that this process may use, which a container or a cluster limits."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _can_fork() -> bool:
    """Whether copies of this process can work: on Linux, unless it is one of a pool itself."""
    return sys.platform == "linux" and not multiprocessing.current_process().daemon


def _in_processes(
    work: Callable[[Item], Result], tasks: Sequence[Item], workers: int
) -> list[Result]:
    """Copies of the process and the process itself take tasks as long as there are any."""
    known = _reachable(work, tasks)
    numbers, filling = os.pipe()
    os.write(filling, b"".join(k.to_bytes(NUMBER_BYTES, "big") for k in range(len(tasks))))
    os.close(filling)

    def done_here() -> dict[int, Result]:
        return {k: work(tasks[k]) for k in _claimed(numbers)}

    helpers: list[tuple[BaseProcess, Connection]] = []
    try:
        with contextlib.suppress(OSError):  # the system may have no room for another process
            helpers.extend(_helper(done_here, known) for _ in range(workers - 1))
        done = done_here()
        for _, results in helpers:
            done |= _received(results, known)
    finally:
        os.close(numbers)
        for process, results in helpers:
            results.close()
            process.kill()
            process.join()
    # what a copy could not do or send is done here, and fails here if it must
    return [done[k] if k in done else work(task) for k, task in enumerate(tasks)]


def _claimed(numbers: int) -> Iterator[int]:
    """Numbers of tasks that nobody else takes, from a pipe that all read."""
    while number := os.read(numbers, NUMBER_BYTES):
        yield int.from_bytes(number, "big")


def _helper(
    work: Callable[[], Mapping[int, object]], known: Mapping[int, object]
) -> tuple[BaseProcess, Connection]:
    """A copy of this process that works, and where its results arrive."""
    receiving, sending = Pipe(duplex=False)

    def run() -> None:
        gc.freeze()  # a collection would write to, and so copy, all memory that is shared
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that forked ends its copies
        receiving.close()
        with contextlib.suppress(Exception):  # it finds what is missing, and does it itself
            sending.send_bytes(_packed(work(), known))

    process = multiprocessing.get_context("fork").Process(target=run, daemon=True)
    with warnings.catch_warnings():
        # Python warns of threads that hold locks, which no task takes
        warnings.simplefilter("ignore", DeprecationWarning)
        process.start()
    sending.close()
    return process, receiving


def _received(results: Connection, known: Mapping[int, object]) -> dict[int, Any]:
    try:
        return dict(_Unpickler(io.BytesIO(results.recv_bytes()), known).load())
    except (EOFError, OSError, pickle.UnpicklingError):
        return {}


def _packed(results: Mapping[int, object], known: Mapping[int, object]) -> bytes:
    stream = io.BytesIO()
    _Pickler(stream, known).dump(results)
    return stream.getvalue()


class _Pickler(pickle.Pickler):
    """Sends what was known before by its number."""

    dispatch_table = copyreg.dispatch_table.copy()
    dispatch_table[MappingProxyType] = lambda view: (_read_only, (dict(view),))

    def __init__(self, stream: io.BytesIO, known: Mapping[int, object]) -> None:
        super().__init__(stream, protocol=pickle.HIGHEST_PROTOCOL)
        self._known = known

    def persistent_id(self, thing: object) -> int | None:
        return id(thing) if id(thing) in self._known else None


def _read_only(values: dict[Any, Any]) -> Mapping[Any, Any]:
    return MappingProxyType(values)


class _Unpickler(pickle.Unpickler):
    def __init__(self, stream: io.BytesIO, known: Mapping[int, object]) -> None:
        super().__init__(stream)
        self._known = known

    def persistent_load(self, number: Any) -> object:
        return self._known[number]


def _reachable(*roots: object) -> dict[int, object]:
    """What can be reached from some objects, by its identity."""
    found: dict[int, object] = {}
    waiting = list(roots)
    while waiting:
        thing = waiting.pop()
        if id(thing) in found or isinstance(thing, PLAIN):
            continue
        found[id(thing)] = thing
        waiting.extend(_parts(thing))
    return found


def _parts(thing: object) -> Iterable[object]:
    if isinstance(thing, np.ndarray):
        return ()
    if isinstance(thing, FunctionType):
        return _enclosed(thing)
    if isinstance(thing, partial):
        return (thing.func, thing.args, thing.keywords)
    if isinstance(thing, MethodType):
        return (thing.__self__,)
    if isinstance(thing, Mapping):
        return thing.values()
    if isinstance(thing, tuple | list | set | frozenset):
        return thing
    return vars(thing).values() if hasattr(thing, "__dict__") else ()


def _enclosed(function: FunctionType) -> Iterator[object]:
    """What a closure holds of the function around it."""
    for cell in function.__closure__ or ():
        with contextlib.suppress(ValueError):  # a variable that has no value yet
            yield cell.cell_contents
