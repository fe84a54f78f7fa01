"""Tasks that are shared out among the processor's cores.

Compiled kernels release Python's lock, but what lies between their calls does not, so threads of
short kernels wait for one another. Where the system can fork, copies of the process work beside it;
they know all that it knows, so nothing is sent to them, and what they send back names what it knew
already instead of copying it. Elsewhere threads do the work. Meanwhile a matrix product or a
factorisation takes one thread: those of small matrices in several processes at once wait for one
another for longer than the work takes.
"""

from __future__ import annotations

import contextlib
import contextvars
import multiprocessing
import os
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any, Protocol, TypeVar

from softid.parallel.matrix_threads import matrices_on_one_thread
from softid.parallel.team import MOST_TASKS, Team

Item = TypeVar("Item")
Result = TypeVar("Result")
Other = TypeVar("Other")

MAX_WORKERS = 4
"""Workers at most. The tasks of a diagnosis are a few dozen of a few milliseconds each, and what is
not shared out is done by all."""


class Keeper(Protocol):
    """Has what an earlier run with the same data did, or keeps what this one does."""

    def resumed(
        self,
        work: Callable[[Item], Result],
        tasks: Sequence[Item],
        do: Callable[[], list[Result]],
        *,
        is_copy: bool,
    ) -> list[Result]:
        """Results that were kept at this place, else what is done now.

        Parameters
        ----------
        work, tasks
            What is done with what; everything that results may refer to can be reached from them.
        do
            Does it.
        is_copy
            Whether this process is a copy that goes on in step, which should keep nothing.
        """


class _Here(threading.local):
    """Of the thread at hand.

    Attributes
    ----------
    has_part
        Whether it works on a part already, so that it shares nothing out itself.
    team
        Copies that go on in step with it.
    keeper
        Keeps what is shared out and done.
    """

    has_part: bool = False
    team: Team | None = None
    keeper: Keeper | None = None


_here = _Here()


def in_parallel(
    work: Callable[[Item], Result],
    items: Iterable[Item],
    *,
    workers: int | None = None,
    small: bool = False,
) -> list[Result]:
    """Results of ``work`` for every item, in order.

    What ``work`` changes beside its result may be lost, so it must not return what it was given and
    has changed. An error reaches the caller.

    Parameters
    ----------
    work
        What to do, which may be a closure.
    items
        What to do it with.
    workers
        How many work; by default as many as there are cores, up to `MAX_WORKERS`. Where copies go
        on `in_step` all of them do, whatever number above one is asked for.
    small
        Whether copies are not worth making for it: those that go on `in_step` take part, and where
        there are none threads do.

    Examples
    --------
    >>> in_parallel(lambda number: number**2, range(4))
    [0, 1, 4, 9]
    """
    tasks = list(items)
    if _here.has_part:
        return [work(task) for task in tasks]
    workers = min(workers or _usual_workers(), len(tasks))
    with matrices_on_one_thread():
        if _here.keeper is None:
            return _shared_out(work, tasks, workers, small=small)
        return _here.keeper.resumed(
            work,
            tasks,
            lambda: _shared_out(work, tasks, workers, small=small),
            is_copy=is_copy(),
        )


def both(first: Callable[[], Result], second: Callable[[], Other]) -> tuple[Result, Other]:
    """Results of two small pieces of work, done at the same time.

    Parameters
    ----------
    first, second
        What to do, each on its own: what it changes beside its result may be lost.

    Examples
    --------
    >>> both(lambda: 1, lambda: "one")
    (1, 'one')
    """
    works: tuple[Callable[[], Any], ...] = (first, second)
    one, other = in_parallel(lambda work: work(), works, small=True)
    return one, other


def on_two_threads(
    first: Callable[[], Result], second: Callable[[], Other]
) -> tuple[Result, Other]:
    """Results of two calls of compiled functions, at the same time where a core is free for it.

    The other thread stands ready. Where it is busy, or did not come along into a copy of the
    process, the second call is made here after the first; so it is where work is shared out among
    processes already.

    Parameters
    ----------
    first, second
        What to call, each of some tenths of a millisecond and without Python's lock.

    Examples
    --------
    >>> on_two_threads(lambda: 1, lambda: "one")
    (1, 'one')
    """
    is_shared = _here.has_part or _here.team is not None
    if is_shared or multiprocessing.parent_process() is not None or usable_cores() < 2:
        return first(), second()
    context = contextvars.copy_context()  # in which numpy keeps what it warns of
    waiting = _other_thread().submit(context.run, second)
    one = first()
    return one, second() if waiting.cancel() else waiting.result()


@cache
def _other_thread() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, "softid")


@contextlib.contextmanager
def in_step() -> Iterator[None]:
    """Have copies of the process go on beside it inside the ``with`` block or decorated function.

    They do all that it does, and what `in_parallel` shares out in there is divided among them at
    next to no cost. What is done must follow from the memory alone, and not from the clock, say.
    Copies print nothing, see `is_copy`, but would write files as well; they end where the block
    does. Where the system cannot fork nothing changes.

    Examples
    --------
    >>> with in_step():
    ...     squares = in_parallel(lambda number: number**2, range(4))
    ...     roots = in_parallel(lambda number: number**0.5, squares)
    >>> roots
    [0.0, 1.0, 2.0, 3.0]
    """
    if _here.has_part or _here.team is not None or _usual_workers() < 2 or not _can_fork():
        yield
        return
    _here.team = team = Team(_usual_workers())
    try:
        yield
    finally:
        _here.team = None
        team.end()


@contextlib.contextmanager
def kept_in(keeper: Keeper) -> Iterator[None]:
    """Have `in_parallel` ask a keeper, inside the ``with`` block, for all that it is to do.

    What is done must follow from the memory alone, as in `in_step`, which stands inside of it.
    """
    before, _here.keeper = _here.keeper, keeper
    try:
        yield
    finally:
        _here.keeper = before


def is_copy() -> bool:
    """Whether this process is a copy that goes on in step, which should tell nobody anything.

    Examples
    --------
    >>> is_copy()
    False
    """
    return _here.team is not None and _here.team.is_copy


def _shared_out(
    work: Callable[[Item], Result], tasks: Sequence[Item], workers: int, *, small: bool
) -> list[Result]:
    if workers < 2:
        return [work(task) for task in tasks]
    team = _here.team if _here.team is not None and not _here.team.is_alone else None
    if _can_fork() and len(tasks) <= MOST_TASKS and not (small and team is None):
        _here.has_part = True  # copies begin with what this thread has
        try:
            return _in_processes(work, tasks, team, workers)
        finally:
            _here.has_part = False
    with ThreadPoolExecutor(workers, initializer=_take_part) as pool:
        return list(pool.map(work, tasks))


def _in_processes(
    work: Callable[[Item], Result], tasks: Sequence[Item], team: Team | None, workers: int
) -> list[Result]:
    """Copies of the process and the process itself take tasks as long as there are any."""
    if team is not None:
        done, failed = team.share(work, tasks)
    else:
        team = Team(workers)
        try:
            done, failed = team.share(work, tasks, is_last=True)
        finally:
            team.end()

    def result(k: int) -> Result:
        """What a copy could not do or send is done here, and fails here if it must."""
        if k in failed:
            raise failed[k]
        return done[k] if k in done else work(tasks[k])

    return [result(k) for k in range(len(tasks))]


def _take_part() -> None:
    _here.has_part = True


def _usual_workers() -> int:
    return min(MAX_WORKERS, usable_cores())


def usable_cores() -> int:
    """Cores that this process may use, which a container or a cluster limits."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _can_fork() -> bool:
    """Whether copies of this process can work: on Linux, unless it is one of a pool itself."""
    return sys.platform == "linux" and not multiprocessing.current_process().daemon
